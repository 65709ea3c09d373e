// Runs: frames as views, progress, Ctrl-C.
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "bindings.h"
#include "run/simulation.h"
#include "session.h"
#include "waiting.h"

namespace frana {
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// In a process that was forked from the one which started a run, its thread is not there. The run is left alone.
struct EndSession {
    pid_t process = ::getpid();
    void operator()(Session* session) const {
        if (::getpid() != process || Waiting::outlived()) return;
        if (!PyGILState_Check()) {
            delete session;
            return;
        }
        const py::gil_scoped_release release;
        delete session;
    }
};

class Run;

/// A state at an output time: what it says of itself stays, its fields go with the next step.
class FrameOfRun {
public:
    FrameOfRun(const std::shared_ptr<Session>& session, pid_t process)
        : session_(session),
          process_(process),
          serial_(session->frames()),
          number(session->frame()->number),
          status(session->frame()->status),
          grid(session->frame()->grid) {}

    std::vector<std::string> names(bool of_grid) const {
        std::vector<std::string> all;
        for (const Field& field : fields(*held(), of_grid)) all.push_back(field.name);
        return all;
    }
    std::string unit(bool of_grid, const std::string& name) const { return field(held(), of_grid, name).unit; }
    /// Reads the simulation's memory.
    py::array view(bool of_grid, const std::string& name) const {
        const std::shared_ptr<Session> session = held();
        const Field& of = field(session, of_grid, name);
        std::vector<py::ssize_t> shape;
        if (of_grid)
            shape = {grid.ny, grid.nx};
        else
            shape = {of.count};
        if (of.components > 1) shape.push_back(of.components);
        using Memory = std::shared_ptr<FrameMemory>;
        const py::capsule owner(new Memory(session->memory()), [](void* held) { delete static_cast<Memory*>(held); });
        py::array_t<double> array(shape, of.data, owner);
        py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
        return std::move(array);
    }
    bool stands() const {
        const std::shared_ptr<Session> session = session_.lock();
        return session && ::getpid() == process_ && session->state() == Session::State::at_frame &&
               session->frames() == serial_;
    }

private:
    std::weak_ptr<Session> session_;
    pid_t process_;
    Index serial_;

    std::shared_ptr<Session> held() const {
        if (!stands())
            throw py::value_error(
                "the frame is over, since its run has gone on or ended; take what is needed of a frame before the "
                "next one, or keep an array of it, which stays as it is");
        return session_.lock();
    }
    static const std::vector<Field>& fields(const Session& session, bool of_grid) {
        return of_grid ? session.frame()->nodes : session.frame()->particles;
    }
    static const Field& field(const std::shared_ptr<Session>& session, bool of_grid, const std::string& name) {
        std::string all;
        for (const Field& field : fields(*session, of_grid)) {
            if (field.name == name) return field;
            all += (all.empty() ? "" : ", ") + field.name;
        }
        throw py::key_error(name + ": no such field; there are " + all);
    }

public:
    const Index number;
    const Status status;
    const GridGeometry grid;
};

class Run {
public:
    Run(const CaseFile& file, Session::Wishes wishes, py::object progress)
        : session_(new Session(file, std::move(wishes)), EndSession()), progress_(std::move(progress)) {
        settle();
    }

    py::object next() {
        mine();
        alone();
        if (over()) return py::none();
        if (unseen_) return shown();
        session_->go_to_output();
        return stand();
    }
    py::object advance(double until) {
        mine();
        alone();
        if (over()) return py::none();
        session_->go_to(until);
        return stand();
    }
    /// Squares of the map with their masses; arrays of the same length.
    void add_mass(const Numbers& x, const Numbers& y, const Numbers& mass, const Numbers& vx, const Numbers& vy,
                  const Numbers& size) {
        alone();
        const Simulation* const simulation = standing().simulation();
        if (!simulation || session_->status().time >= session_->planned_end())
            throw std::runtime_error("the run is at its end; add mass before, or give a later time.end");
        Seeds particles;
        for (py::ssize_t n = 0; n < x.size(); ++n) {
            if (!(size.at(n) <= kMostCells * session_->cell()))
                throw py::value_error(
                    fmt::format("size: found {:g} m; expected at most {:g} cells of {:g} m; give several masses",
                                size.at(n), kMostCells, session_->cell()));
        }
        for (py::ssize_t n = 0; n < x.size(); ++n)
            add_square(particles, {x.at(n), y.at(n)}, {vx.at(n), vy.at(n)}, mass.at(n) / session_->density(),
                       size.at(n));
        const std::string why_not = simulation->why_not_add(particles);
        if (!why_not.empty()) throw UserError("add_mass: " + why_not);
        session_->add(particles);
    }
    /// As it is now, north row first, read-only.
    py::tuple bed() {
        return of_present_frame([this](const Frame& frame) { return bed_of(frame); });
    }
    /// Likewise, the elevation model's heights.
    py::tuple ground() {
        return of_present_frame([this](const Frame& frame) {
            const std::optional<Raster> ground = session_->ground_of(frame);
            if (!ground) throw std::runtime_error("the frames of this case are on other nodes than its terrain");
            return north_up(*ground);
        });
    }
    /// Ends the run where it is, unless it is over. What went wrong meanwhile comes through, once.
    void close() {
        if (!session_ || ::getpid() != process_ || over()) return;
        session_->end();
        wait_out();
        if (!busy_) tell_failure();  // else the thread that steps it does
    }
    bool over() const { return session_->state() == Session::State::over; }
    Session& session() const {
        mine();
        return *session_;
    }
    /// Only while it stands: another thread may have told it to go on.
    const Session& standing() const {
        mine();
        if (session_->state() == Session::State::runs)
            throw std::runtime_error("the run is stepping in another thread; look at it there");
        return *session_;
    }

private:
    static constexpr double kMostCells = 200.0;  ///< across a square that is added: 160 000 particles

    /// A square of material [m3] as particles of at most half a cell each, as releases have them.
    void add_square(Seeds& particles, const Vec2& middle, const Vec2& velocity, double volume,
                    double given_size) const {
        const double half_cell = 0.5 * session_->cell(), size = given_size > 0.0 ? given_size : half_cell;
        const auto count = std::max(Index{1}, static_cast<Index>(std::ceil(size / half_cell - 1e-9)));
        const double edge = size / static_cast<double>(count);
        for (Index j = 0; j < count; ++j)
            for (Index i = 0; i < count; ++i) {
                particles.x.push_back(middle.x() - 0.5 * size + (static_cast<double>(i) + 0.5) * edge);
                particles.y.push_back(middle.y() - 0.5 * size + (static_cast<double>(j) + 0.5) * edge);
                particles.vx.push_back(velocity.x()), particles.vy.push_back(velocity.y());
                particles.volume.push_back(volume / static_cast<double>(count * count));
                particles.depth.push_back(volume / (size * size));
                particles.size.push_back(edge);
            }
    }

    template <class Make>
    py::tuple of_present_frame(const Make& make) {
        const Session& session = standing();
        Simulation* const simulation = session.simulation();
        if (!simulation)
            throw std::runtime_error("the run is over; its last bed is in a frame of its folder, or in result.rasters");
        if (const Frame* const frame = session.frame()) return make(*frame);
        alone();  // a frame is made of what a step works on
        const Busy busy(busy_);
        return make(aside([&] { return simulation->frame(); }));
    }

    py::tuple bed_of(const Frame& frame) const {
        const Field* const elevation = frame.node("elevation");
        if (!elevation) throw std::runtime_error("the model of this case tells no bed in its frames");
        Raster raster;
        raster.geometry = frame.grid;
        raster.crs_wkt = session_->crs();
        raster.values.assign(elevation->data, elevation->data + frame.grid.size());
        return north_up(raster);
    }

    void mine() const {
        if (::getpid() != process_)
            throw std::runtime_error(
                "the run belongs to the process that started it; start another one after the fork");
    }

    void alone() const {
        if (busy_)
            throw std::runtime_error(
                "the run is stepping, in another thread or around this callback; a run belongs to one at a time");
    }

    py::object stand() {
        try {
            unseen_ = false;
            settle();
        } catch (...) {
            unseen_ = session_->state() == Session::State::at_frame;
            throw;
        }
        return shown();
    }

    py::object shown() {
        unseen_ = false;
        if (session_->state() == Session::State::at_frame) return py::cast(FrameOfRun(session_, process_));
        return py::none();
    }

    /// Waits until it stands at a frame, is ready or over. Ctrl-C is answered after the present step; the run then stands and
    /// may go on.
    void settle() {
        const Waiting waiting;
        const Busy busy(busy_);
        for (;;) {
            if (Waiting::outlived()) session_->end();
            if (!waited(std::chrono::milliseconds(50))) {
                if (PyErr_CheckSignals() == 0) continue;
                session_->pause();
                while (!waited(std::chrono::milliseconds(1000))) {
                }
                throw py::error_already_set();
            }
            const Session::State state = session_->state();
            if (state == Session::State::at_frame || state == Session::State::tick) tell();
            if (state != Session::State::tick && state != Session::State::paused) break;
            session_->go_on();
        }
        tell_failure();
    }

    void tell_failure() {
        if (!over() || !session_->failure() || told_failure_) return;
        told_failure_ = true;
        std::rethrow_exception(session_->failure());
    }

    /// Until it is over; a Ctrl-C meanwhile is told afterwards.
    void wait_out() {
        const Waiting waiting;
        bool asked = false;
        py::object type, value, trace;
        for (;;) {
            if (waited(std::chrono::milliseconds(50)) && over()) break;
            if (!asked && PyErr_CheckSignals() != 0) {
                asked = true;
                PyErr_Fetch(&type.ptr(), &value.ptr(), &trace.ptr());
            }
        }
        if (!asked) return;
        PyErr_Restore(type.release().ptr(), value.release().ptr(), trace.release().ptr());
        throw py::error_already_set();
    }

    bool waited(std::chrono::milliseconds time) {
        const py::gil_scoped_release release;
        return session_->wait(time);
    }

    void tell() const {
        if (!progress_.is_none()) progress_(session_->status(), session_->planned_end());
    }

    struct Busy {
        explicit Busy(bool& flag) : flag_(flag) { flag_ = true; }
        ~Busy() { flag_ = false; }
        bool& flag_;
    };

    pid_t process_ = ::getpid();
    std::shared_ptr<Session> session_;
    py::object progress_;
    bool busy_ = false, told_failure_ = false;
    bool unseen_ = false;  ///< it stands at a frame that an exception came before
};

py::list rasters_of(const Run& run) {
    py::list all;
    const std::vector<ProductRaster>& rasters = run.standing().rasters();
    for (const ProductRaster& product : rasters)
        all.append(
            py::make_tuple(product.name, product.unit, product.description, north_up(as_in_file(product, rasters))));
    return all;
}

}  // namespace

void bind_run(py::module_& module) {
    py::class_<Status>(module, "Status")
        .def_readonly("step", &Status::step)
        .def_readonly("time", &Status::time)
        .def_readonly("dt", &Status::dt)
        .def_readonly("particles", &Status::particles)
        .def_readonly("mass", &Status::mass)
        .def_readonly("mass_left", &Status::mass_left)
        .def_readonly("mass_in", &Status::mass_in)
        .def_readonly("momentum", &Status::momentum)
        .def_readonly("kinetic", &Status::kinetic)
        .def_readonly("potential", &Status::potential)
        .def_readonly("dissipated", &Status::dissipated)
        .def_readonly("max_depth", &Status::max_depth)
        .def_readonly("max_speed", &Status::max_speed)
        .def_readonly("mean_speed", &Status::mean_speed)
        .def_readonly("covered_area", &Status::covered_area)
        .def_readonly("front", &Status::front);

    py::class_<FrameOfRun>(module, "Frame")
        .def_readonly("number", &FrameOfRun::number)
        .def_readonly("status", &FrameOfRun::status)
        .def_property_readonly("grid_geometry",
                               [](const FrameOfRun& frame) {
                                   const GridGeometry& g = frame.grid;
                                   return py::make_tuple(g.nx, g.ny, g.x0, g.y0, g.cell);
                               })
        .def_property_readonly("stands", &FrameOfRun::stands)
        .def("names", &FrameOfRun::names)
        .def("unit", &FrameOfRun::unit)
        .def("view", &FrameOfRun::view);

    module.def("end_all", &end_all_waiting);
    py::class_<Run>(module, "Run")
        .def(py::init([](const CaseFile& file, const std::optional<std::string>& out,
                         const std::vector<std::string>& sets, int threads, std::optional<double> until, bool overwrite,
                         bool resume, py::object progress) {
            Session::Wishes wishes;
            if (out) wishes.run.out = *out;
            wishes.run.sets = sets, wishes.run.until = until, wishes.run.overwrite = overwrite;
            wishes.run.resume = resume;
            wishes.in_folder = out.has_value(), wishes.threads = threads;
            wishes.tick = progress.is_none() ? 0.0 : 0.2;
            return std::make_unique<Run>(file, std::move(wishes), std::move(progress));
        }))
        .def("next", &Run::next)
        .def("advance", &Run::advance)
        .def("close", &Run::close)
        .def("add_mass", &Run::add_mass)
        .def("bed", &Run::bed)
        .def("ground", &Run::ground)
        .def_property_readonly("cell", [](const Run& run) { return run.session().cell(); })
        .def_property_readonly("crs", [](const Run& run) { return run.session().crs(); })
        .def_property_readonly("over", &Run::over)
        .def_property_readonly("status", [](const Run& run) { return run.standing().status(); })
        .def_property_readonly("end", [](const Run& run) { return run.session().planned_end(); })
        .def_property_readonly("remarks", [](const Run& run) { return run.standing().remarks(); })
        .def("record", [](const Run& run) { return run_json(run.standing().record()); })
        .def("rasters", &rasters_of);
}

}  // namespace frana
