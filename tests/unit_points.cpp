// Points that split, merge and touch nodes: what each must keep.
#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include "analytic_scene.h"
#include "catch.h"
#include "mpm/domain.h"
#include "mpm/halving.h"
#include "mpm/stencil.h"
#include "shallow/merge.h"
#include "shallow/split.h"

using namespace frana;

namespace {

struct Sums {
    double mass = 0, px = 0, py = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    explicit Sums(const Particles& c) {
        for (Index p = 0; p < c.count(); ++p) {
            const Moments m = Moments::of(edges_of(c, p));
            mass += c.mass[p], px += c.mass[p] * c.vx[p], py += c.mass[p] * c.vy[p];
            x += c.mass[p] * c.x[p], y += c.mass[p] * c.y[p];
            xx += c.mass[p] * (m.xx + c.x[p] * c.x[p]);
            xy += c.mass[p] * (m.xy + c.x[p] * c.y[p]);
            yy += c.mass[p] * (m.yy + c.y[p] * c.y[p]);
        }
    }
    void check_equal(const Sums& o) const {  // round-off of sums over some tens of points
        for (const auto& [a, b] :
             {std::pair{mass, o.mass}, {px, o.px}, {py, o.py}, {x, o.x}, {y, o.y}, {xx, o.xx}, {xy, o.xy}, {yy, o.yy}})
            CHECK(std::abs(a - b) <= 1e-12 * (1.0 + std::abs(a)));
    }
};

/// A flow without points on 20 x 20 nodes a metre apart, and a place to add them.
struct Pool {
    Scene scene = test::scene_on(20, 20, 1.0, [](double, double) { return 0.0; });
    Flow flow{scene};
    TileSorter sorter;
    void add(double x, double y, double mass, double size) {
        Particles& c = flow.particles;
        const Index p = c.count();
        c.resize(p + 1);
        c.x[p] = x, c.y[p] = y, c.mass[p] = mass, c.r1x[p] = c.r2y[p] = size, c.id[p] = p;
        c.vx[p] = 0.3 * x, c.vy[p] = -0.1 * y;
    }
    /// Points lie where they belong.
    std::vector<std::int32_t> as_sorted() const {
        std::vector<std::int32_t> points(static_cast<std::size_t>(flow.particles.count()));
        std::iota(points.begin(), points.end(), 0);
        return points;
    }
    void sort(const std::vector<std::uint8_t>& gone = {}) { sorter.sort(flow.particles, flow.grid, gone, flow.active); }
};

template <class S>
void check_partition(int degree) {
    for (double u = 5.0; u < 7.0; u += 0.0625) {
        const S s(u);
        double one = 0, place = 0, slope = 0, slope_of_place = 0;
        for (int n = 0; n < S::kNodes; ++n) {
            one += s.w[n], place += s.w[n] * static_cast<double>(s.base + n);
            slope += s.slope(n), slope_of_place += s.slope(n) * static_cast<double>(s.base + n);
        }
        CAPTURE(degree, u);
        CHECK(std::abs(one - 1) <= 1e-14);
        CHECK(std::abs(place - u) <= 1e-13);
        CHECK(std::abs(slope) <= 1e-14);
        CHECK(std::abs(slope_of_place - 1) <= 1e-13);
    }
}

}  // namespace

TEST_CASE("Shape functions sum to one and carry places and slopes exactly", "[points]") {
    check_partition<Linear>(1);
    check_partition<Quadratic>(2);
    check_partition<Cubic>(3);
}

TEST_CASE("The rectangle of given second moments has them, and a square lies along the grid", "[points]") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> edge(-1, 1);
    for (int k = 0; k < 200; ++k) {
        const Moments m = Moments::of({edge(random), edge(random), edge(random), edge(random)});
        const Edges e = rectangle_of(m);
        const Moments again = Moments::of(e);
        CHECK(std::abs(again.xx - m.xx) + std::abs(again.xy - m.xy) + std::abs(again.yy - m.yy) <= 1e-15);
        CHECK(std::abs(e.r1x * e.r2x + e.r1y * e.r2y) <= 1e-14);
        CHECK(e.r1x * e.r1x + e.r1y * e.r1y >= e.r2x * e.r2x + e.r2y * e.r2y);
    }
    const double turned = std::sqrt(0.5);
    const Edges square = rectangle_of(Moments::of({turned, turned, -turned, turned}));
    CHECK(square.r1y == 0.0);
    CHECK(square.r1x == Approx(1.0).epsilon(1e-14));
}

TEST_CASE("A domain narrower than a sixteenth of a cell spans that much less of a gradient", "[points]") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-1, 1), angle(0, 3.1);
    for (const double length : {0.0, 0.01, 0.05, 1.0 / 16.0, 0.3, 1.0})
        for (const double share : {0.0, 1e-9, 0.1, 0.7, 1.0}) {
            const double width = share * length, at = angle(random), shear = any(random);
            const double cosine = std::cos(at), sine = std::sin(at), turn = std::cos(shear), back = std::sin(shear);
            // Edges of the rectangle, mixed by a rotation of their pair, which keeps the moments.
            const Vec2 a(length * cosine, length * sine), b(-width * sine, width * cosine);
            const Vec2 r1 = turn * a + back * b, r2 = turn * b - back * a;
            const Gradient c{any(random), any(random), any(random), any(random)};
            const Gradient g = spanned(c, r1.x(), r1.y(), r2.x(), r2.y());
            const double along = std::min(1.0, 16.0 * length), across = std::min(1.0, 16.0 * width);
            const double pxx = along * cosine * cosine + across * sine * sine,
                         pyy = along * sine * sine + across * cosine * cosine, pxy = (along - across) * cosine * sine;
            CAPTURE(length, width);
            // The width is a difference of products of edges: good to round-off of the longer one, in sixteenths.
            CHECK(std::abs(g.xx - (c.xx * pxx + c.xy * pxy)) < 1e-14);
            CHECK(std::abs(g.xy - (c.xx * pxy + c.xy * pyy)) < 1e-14);
            CHECK(std::abs(g.yx - (c.yx * pxx + c.yy * pxy)) < 1e-14);
            CHECK(std::abs(g.yy - (c.yx * pxy + c.yy * pyy)) < 1e-14);
            Double4 cxx = all(c.xx), cxy = all(c.xy), cyx = all(c.yx), cyy = all(c.yy);
            leave_spanned(all(r1.x()), all(r1.y()), all(r2.x()), all(r2.y()), cxx, cxy, cyx, cyy);
            CHECK((cxx[2] == g.xx && cxy[2] == g.xy && cyx[2] == g.yx && cyy[2] == g.yy));
        }
}

TEMPLATE_TEST_CASE("Four points that stay whole are cut as each of them is", "[points]", double, float) {
    struct Masses {
        std::vector<double> mass{1.0, 2.0, 3.0, 4.0};
    } points;
    struct Edges4 {
        std::vector<TestType> r1x = std::vector<TestType>(4), r1y = r1x, r2x = r1x, r2y = r1x;
        std::vector<TestType> cxx = r1x, cxy = r1x, cyx = r1x, cyy = r1x;
    };
    const auto alone = [](Index p) { return p % 2 == 1; };
    std::mt19937 random(8);
    std::uniform_real_distribution<double> any(-1, 1);
    const double longest = 1.0;
    int cut = 0, left = 0, whole = 0;
    for (int k = 0; k < 4000; ++k) {
        Edges4 held;
        const double size = std::pow(10.0, any(random));
        for (std::size_t n = 0; n < 4; ++n) {
            held.r1x[n] = static_cast<TestType>(size * any(random)),
            held.r1y[n] = static_cast<TestType>(0.3 * any(random));
            held.r2x[n] = static_cast<TestType>(0.3 * any(random)),
            held.r2y[n] = static_cast<TestType>(size * any(random));
            for (auto* c : {&held.cxx, &held.cxy, &held.cyx, &held.cyy}) (*c)[n] = static_cast<TestType>(any(random));
        }
        const HalvingRules rules{1.0, 2.5 + 2.0 * any(random), k % 5 != 0, k % 2 == 0, 0.0};
        Edges4 before = held, one = held;
        bool changed = false, one_changed = false, simple = true;
        for (Index n = 0; n < 4; ++n) {
            one_changed |= clamp_edges(one, n, 2.0 * longest);
            if (rules.straighten && straighten(one, n)) simple = false;
            if (rules.split && parts_of(one, n, points.mass[static_cast<std::size_t>(n)], rules) > 1) simple = false;
            const bool here = clamp_edges(one, n, longest);
            if (here && alone(n)) stop_where_cut(one, n, longest);
            one_changed |= here;
        }
        const bool done = four_cut(points, held, 0, rules, longest, alone, changed);
        if (!simple) CHECK_FALSE(done);  // it may leave more alone than it must
        if (!done) {
            ++left;
            CHECK((held.r1x == before.r1x && held.r2y == before.r2y && !changed));
            continue;
        }
        ++(changed ? cut : whole);
        CHECK(changed == one_changed);
        for (std::size_t n = 0; n < 4; ++n) {  // cut at once, or to twice the length first: two roundings more
            const double slack = 4.0 * std::numeric_limits<TestType>::epsilon();
            CHECK(std::abs(held.r1x[n] - one.r1x[n]) <= slack);
            CHECK(std::abs(held.r1y[n] - one.r1y[n]) <= slack);
            CHECK(std::abs(held.r2x[n] - one.r2x[n]) <= slack);
            CHECK(std::abs(held.r2y[n] - one.r2y[n]) <= slack);
            for (const auto c : {&Edges4::cxx, &Edges4::cxy, &Edges4::cyx, &Edges4::cyy}) {
                CHECK(std::abs((held.*c)[n] - (one.*c)[n]) <= 100.0 * slack);  // over a tenth, at least
                if (!alone(static_cast<Index>(n))) CHECK((held.*c)[n] == (before.*c)[n]);
            }
        }
    }
    CHECK(cut > 100);
    CHECK(left > 100);
    CHECK(whole > 100);
}

TEST_CASE("A point that is alone stretches no more along edges that are cut", "[points]") {
    struct One {
        std::vector<double> r1x{1.0}, r1y{0.0}, r2x{0.3}, r2y{0.4}, cxx{2.0}, cxy{0.3}, cyx{-0.7}, cyy{1.0};
        double along(double x, double y) const {
            return (x * (cxx[0] * x + cxy[0] * y) + y * (cyx[0] * x + cyy[0] * y)) / (x * x + y * y);
        }
    };
    One one;  // its second edge is shorter than a cell: it may grow
    stop_where_cut(one, 0, 1.0);
    CHECK(std::abs(one.along(1.0, 0.0)) < 1e-15);
    CHECK((one.cxy[0] == 0.3 && one.cyx[0] == -0.7 && one.cyy[0] == 1.0));

    One both;
    both.r2x[0] = 0.6, both.r2y[0] = 0.8;
    One turned = both;
    std::swap(turned.r1x, turned.r2x), std::swap(turned.r1y, turned.r2y);
    stop_where_cut(both, 0, 1.0), stop_where_cut(turned, 0, 1.0);
    CHECK(std::abs(both.along(1.0, 0.0)) < 1e-15);
    CHECK(std::abs(both.along(0.6, 0.8)) < 1e-15);
    CHECK(both.cxy[0] - both.cyx[0] == Approx(1.0).epsilon(1e-14));  // it turns on
    CHECK(both.cxx == turned.cxx);
    CHECK(both.cyx == turned.cyx);

    One squeezed;
    squeezed.cxx[0] = -2.0;
    stop_where_cut(squeezed, 0, 1.0);
    CHECK(squeezed.cxx[0] == -2.0);
}

TEST_CASE("Merging thins a crowd and conserves mass, momentum, centre and second moments", "[points]") {
    Pool pool;
    pool.sort();
    Merger merger(pool.flow);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(5.01, 5.49), mass(1, 2);
    for (int k = 0; k < 9; ++k) pool.add(place(random), place(random), mass(random), 0.2);
    pool.add(12.3, 12.3, 1.0, 0.2);  // alone in its square
    pool.sort();
    const Sums before(pool.flow.particles);
    Index gone = 0;
    std::vector<std::uint8_t> gone_points;
    for (int pass = 0; pass < 20; ++pass) {
        gone += merger.merge(pool.flow, pool.as_sorted(), gone_points);
        pool.sort(gone_points);
        before.check_equal(Sums(pool.flow.particles));
    }
    CHECK(gone == 7);  // two may stay
    CHECK(pool.flow.particles.count() == 3);
}

TEST_CASE("Two points that merge have the number of the heavier one", "[points]") {
    const bool heavy_first = GENERATE(true, false);
    Pool pool;
    pool.sort();
    Merger merger(pool.flow);
    pool.add(5.10, 5.1, heavy_first ? 2.0 : 1.0, 0.2);
    pool.add(5.12, 5.1, heavy_first ? 1.0 : 2.0, 0.2);
    pool.add(5.45, 5.45, 4.0, 0.2);
    pool.sort();
    const Particles& c = pool.flow.particles;
    const auto number_of = [&](double mass) {
        return c.id[std::find(c.mass.begin(), c.mass.end(), mass) - c.mass.begin()];
    };
    const std::int64_t heavy = number_of(2.0);
    std::vector<std::uint8_t> gone;
    REQUIRE(merger.merge(pool.flow, pool.as_sorted(), gone) == 1);
    pool.sort(gone);
    REQUIRE(c.count() == 2);
    CHECK(number_of(3.0) == heavy);
}

TEST_CASE("A heavy point does not take in the light ones around it: they merge with one another", "[points]") {
    Pool pool;
    pool.sort();
    Merger merger(pool.flow);
    pool.add(5.10, 5.1, 10.0, 0.2);
    pool.add(5.12, 5.1, 1.0, 0.2);  // by place alone, the first union would be of these two
    pool.add(5.30, 5.3, 1.0, 0.2);
    pool.sort();
    std::vector<std::uint8_t> gone;
    REQUIRE(merger.merge(pool.flow, pool.as_sorted(), gone) == 1);
    pool.sort(gone);
    std::vector<double> masses(pool.flow.particles.mass.begin(), pool.flow.particles.mass.end());
    std::sort(masses.begin(), masses.end());
    CHECK(masses == std::vector<double>{2.0, 10.0});
}

TEST_CASE("Equal points at the corners of a square are not merged: nothing but round-off would choose", "[points]") {
    Pool pool;
    pool.sort();
    Merger merger(pool.flow);
    for (const double x : {5.125, 5.375})
        for (const double y : {5.125, 5.375}) pool.add(x, y, 1.0, 0.25);
    pool.sort();
    std::vector<std::uint8_t> gone;
    CHECK(merger.merge(pool.flow, pool.as_sorted(), gone) == 0);
}

TEST_CASE("A crowd is thinned by where its points lie, not by the order they are stored in", "[points]") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(5.01, 5.49);
    std::vector<Vec2> places(100);  // more than are compared at a time
    for (Vec2& at : places) at = Vec2(place(random), place(random));
    const auto left_of = [&] {
        Pool pool;
        for (const Vec2& at : places) pool.add(at.x(), at.y(), 1.0 + at.x() * at.y(), 0.01);
        pool.sort();
        std::vector<std::uint8_t> gone;
        CHECK(Merger(2).merge(pool.flow, pool.as_sorted(), gone) > 1);  // each part for itself
        pool.sort(gone);
        std::vector<double> left(pool.flow.particles.x.begin(), pool.flow.particles.x.end());
        std::sort(left.begin(), left.end());
        return left;
    };
    const std::vector<double> left = left_of();
    std::reverse(places.begin(), places.end());
    const std::vector<double> again = left_of();
    REQUIRE(left.size() == again.size());
    for (std::size_t k = 0; k < left.size(); ++k) CHECK(std::abs(left[k] - again[k]) <= 1e-15 * 5.5);  // a union's mean
}

TEST_CASE("Parts that splitting holds at the sides lie in the outermost cells of linear shapes", "[points]") {
    for (const Shape shape : {Shape::linear, Shape::quadratic}) {
        Pool pool;
        pool.flow.scheme.shape = shape;
        pool.add(0.05, 10.0, 1.0, 1.0);
        pool.add(18.95, 10.0, 1.0, 1.0);
        pool.sort();
        Splitter splitter(0.0);
        splitter.set_next_id(2);
        CHECK(splitter.split(pool.flow) == 6);
        const auto [least, most] = std::minmax_element(pool.flow.particles.x.begin(), pool.flow.particles.x.end());
        const double off = shape == Shape::linear ? 1e-9 : 0.0;  // as far from the last node as from the first
        CHECK(*least == off);
        CHECK(*most == 19.0 - off);
    }
}

TEST_CASE("Splitting conserves mass, momentum and centre: two parts along the longer edge, four of a square",
          "[points]") {
    for (const double longer : {0.85, 0.9}) {
        Pool pool;
        pool.add(6.2, 6.3, 2.0, 0.85);
        pool.flow.particles.r1x[0] = longer;
        pool.flow.particles.cxx[0] = 0.3;  // the children's velocities differ, their sum does not
        pool.sort();
        const Sums before(pool.flow.particles);
        Splitter splitter(0.0);
        splitter.set_next_id(1);
        const Index born = splitter.split(pool.flow);
        CHECK(born == (longer == 0.85 ? 3 : 1));
        const Sums after(pool.flow.particles);
        CHECK(after.mass == before.mass);
        CHECK(std::abs(after.px - before.px) <= 1e-15 * before.mass);
        CHECK(std::abs(after.x - before.x) <= 1e-14 * before.x);
        CHECK(std::abs(after.y - before.y) <= 1e-14 * before.y);
    }
}

TEST_CASE("A point that splits is not drawn in first, one that may not is", "[points]") {
    for (const double least_mass : {0.0, 10.0}) {
        Pool pool;
        pool.add(6.0, 6.0, 2.0, 1.6);
        pool.sort();
        Splitter splitter(least_mass);
        splitter.set_next_id(1);
        const Particles& c = pool.flow.particles;
        if (least_mass == 0.0) {
            REQUIRE(splitter.split(pool.flow) == 3);
            for (Index p = 0; p < 4; ++p) {  // quarters of the square, where its quarters were
                CHECK(std::abs(std::abs(c.x[p] - 6.0) - 0.4) <= 1e-15);
                CHECK(std::abs(std::abs(c.y[p] - 6.0) - 0.4) <= 1e-15);
                CHECK(c.r1x[p] == 0.8);
                CHECK(c.r2y[p] == 0.8);
            }
        } else {
            REQUIRE(splitter.split(pool.flow) == 0);
            CHECK(std::abs(c.r1x[0] - 1.0) <= 1e-15);
            CHECK(std::abs(c.r2y[0] - 1.0) <= 1e-15);
        }
    }
    Pool pool;  // what is still too long when it is halved is drawn in then
    pool.add(6.0, 6.0, 2.0, 3.0);
    pool.sort();
    Splitter splitter(0.0);
    splitter.set_next_id(1);
    REQUIRE(splitter.split(pool.flow) == 3);
    for (const double edge : pool.flow.particles.r1x) CHECK(std::abs(edge - 1.0) <= 1e-15);
}

TEST_CASE("A point that has grown far too heavy for its domain becomes as wide as its mass is, and splits",
          "[points]") {
    const auto split = [](Pool& pool, double mass, double depth) {
        pool.add(6.0, 6.0, mass, 0.5);
        pool.flow.particles.depth[0] = depth;
        pool.sort();
        Splitter splitter(0.0, 2.0 * pool.flow.density * pool.flow.area);
        splitter.set_next_id(1);
        return splitter.split(pool.flow);
    };
    Pool probe;
    const double filled = probe.flow.density * probe.flow.area;  // of a cell, a metre deep [kg]
    const auto edge_after = [&](double mass, double depth, Index born) {
        Pool pool;
        CHECK(split(pool, mass, depth) == born);
        CHECK(Sums(pool.flow.particles).mass == mass);
        for (const double edge : pool.flow.particles.r1x) CHECK(edge == pool.flow.particles.r1x[0]);
        return pool.flow.particles.r1x[0];
    };
    // Three cells a metre deep in a quarter of one: its edge becomes sqrt(3) cells, and each part's half of it.
    CHECK(edge_after(3.0 * filled, 1.0, 3) == Approx(0.5 * std::sqrt(3.0)).epsilon(1e-15));
    CHECK(edge_after(64.0 * filled, 1.0, 3) == Approx(1.0).epsilon(1e-15));  // two cells at most
    CHECK(edge_after(3.0 * filled, 3.5, 0) == 0.5);                          // no more than margins have
    CHECK(edge_after(1.9 * filled, 0.5, 0) == 0.5);                          // it has not grown
}

TEST_CASE("Points in a row split and are straightened as each alone", "[points]") {
    struct Edge {
        double r1x, r1y, r2x, r2y;
    };
    const std::vector<Edge> odd{{0.9, 0.1, 0.0, 0.4},  {0.4, 0.0, 0.1, 0.9},  {0.0, 0.85, -0.85, 0.0},
                                {0.7, 0.1, 0.7, 0.2},  {0.1, 0.7, -0.2, 0.7}, {1.3, 0.0, 0.0, 0.05},
                                {0.05, 0.0, 0.0, 1.3}, {0.5, 0.0, 0.0, 0.5}};
    const auto put = [](Pool& pool, const Edge& e) {
        pool.add(6.2, 6.3, 2.0, 0.5);
        set_edges(pool.flow.particles, pool.flow.particles.count() - 1, Edges{e.r1x, e.r1y, e.r2x, e.r2y});
    };
    const auto split = [](Pool& pool) {
        pool.sort();
        Splitter splitter(0.0);
        splitter.set_next_id(pool.flow.particles.count());
        return splitter.split(pool.flow);
    };
    for (const Edge& e : odd)
        for (Index place = 0; place < 6; ++place) {  // four in a row, and two more
            Pool alone, row;
            put(alone, e);
            for (Index p = 0; p < 6; ++p) put(row, p == place ? e : Edge{0.5, 0.0, 0.0, 0.5});
            CAPTURE(e.r1x, e.r1y, e.r2x, e.r2y, place);
            const Index born = split(alone);
            REQUIRE(split(row) == born);
            for (Index part = 0; part <= born; ++part) {
                const Edges a = edges_of(alone.flow.particles, part);
                const Edges b = edges_of(row.flow.particles, part == 0 ? place : 5 + part);
                CHECK((a.r1x == b.r1x && a.r1y == b.r1y && a.r2x == b.r2x && a.r2y == b.r2y));
            }
            for (Index p = 0; p < 6; ++p)
                if (p != place) CHECK(row.flow.particles.r1x[p] == 0.5);
        }
}
