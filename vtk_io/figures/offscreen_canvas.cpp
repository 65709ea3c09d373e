#include "vtk_io/figures/offscreen_canvas.h"

#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkImageData.h>
#include <vtkImageMapper.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>

namespace frana {
namespace {

constexpr int kDpi = 72;  // one point is one pixel

/// DejaVu Sans, which has all the signs of units and comes with nearly every desktop or VTK package; empty
/// when it is not there: then the font built into VTK serves (in Debian that is not Arial and lacks many
/// signs).
std::string font_file(bool bold) {
    const std::string name = bold ? "DejaVuSans-Bold.ttf" : "DejaVuSans.ttf";
    for (const char* folder : {"/usr/share/fonts/truetype/dejavu/", "/usr/share/fonts/dejavu-sans-fonts/",
                               "/usr/share/fonts/TTF/", "/usr/share/fonts/dejavu/"}) {
        std::error_code ignored;
        if (std::filesystem::exists(folder + name, ignored)) return folder + name;
    }
    return "";
}

void apply(const TextStyle& style, vtkTextProperty* property) {
    static const std::array<std::string, 2> fonts{font_file(false), font_file(true)};
    const std::string& font = fonts[style.bold ? 1 : 0];
    if (font.empty()) {
        property->SetFontFamilyToArial();
        property->SetBold(style.bold);
    } else {
        property->SetFontFamily(VTK_FONT_FILE);
        property->SetFontFile(font.c_str());
        property->BoldOff();
    }
    property->SetFontSize(static_cast<int>(std::lround(style.size)));
    property->ItalicOff();
    property->ShadowOff();
    property->SetColor(style.colour.r / 255.0, style.colour.g / 255.0, style.colour.b / 255.0);
    property->SetJustification(static_cast<int>(style.across));
    property->SetVerticalJustification(static_cast<int>(style.upward));
    property->SetOrientation(style.angle);
    if (style.boxed) {
        property->SetBackgroundColor(1.0, 1.0, 1.0);
        property->SetBackgroundOpacity(0.8);
    }
}

/// Points of the two sides of a stroke: mitred, so that neighbouring pieces share an edge and do not overlap.
std::vector<std::array<Vec2, 2>> sides(const std::vector<Vec2>& line, double width) {
    std::vector<std::array<Vec2, 2>> result(line.size());
    const bool closed = line.size() > 2 && (line.front() - line.back()).norm() < 1e-9;
    const auto n = line.size();
    const auto normal = [&](std::size_t from) {
        const Vec2 along = (line[from + 1] - line[from]).normalized();
        return Vec2(-along.y(), along.x());
    };
    for (std::size_t i = 0; i < n; ++i) {
        const Vec2 before = i > 0 ? normal(i - 1) : closed ? normal(n - 2) : normal(0);
        const Vec2 after = i + 1 < n ? normal(i) : closed ? normal(0) : normal(n - 2);
        const Vec2 sum = before + after;
        const double longest = 2.0;  // limit of the mitre, in half widths
        const double reach = std::min(2.0 / std::max(sum.norm(), 1e-3), longest);
        const Vec2 offset = sum.norm() < 1e-3 ? before : Vec2(sum.normalized() * reach);
        result[i] = {line[i] + 0.5 * width * offset, line[i] - 0.5 * width * offset};
    }
    return result;
}

std::vector<Vec2> without_repeats(const std::vector<Vec2>& line) {
    std::vector<Vec2> result;
    for (const Vec2& point : line)
        if (result.empty() || (point - result.back()).norm() > 1e-6) result.push_back(point);
    return result;
}

/// Where a horizontal or vertical stroke has to lie to fill whole pixels.
double snapped(double at, double width) {
    const bool odd = std::lround(width) % 2 == 1;
    return odd ? std::floor(at) + 0.5 : std::round(at);
}

/// The drawn pieces of a dashed line.
std::vector<std::vector<Vec2>> dashes(const std::vector<Vec2>& line, const std::vector<double>& dash) {
    std::vector<std::vector<Vec2>> pieces;
    std::size_t part = 0;
    double left = dash[0];
    std::vector<Vec2> piece{line.front()};
    for (std::size_t i = 1; i < line.size(); ++i) {
        Vec2 from = line[i - 1];
        double length = (line[i] - from).norm();
        while (length > left) {
            from += (line[i] - from) * (left / length);
            length -= left;
            piece.push_back(from);
            if (part % 2 == 0) pieces.push_back(piece);
            piece.assign(1, from);
            part = (part + 1) % dash.size();
            left = dash[part];
        }
        left -= length;
        piece.push_back(line[i]);
    }
    if (part % 2 == 0 && piece.size() > 1) pieces.push_back(piece);
    return pieces;
}

/// Share of the segment a-b inside the window (Liang & Barsky 1984); false when none.
bool inside_part(const Vec2& a, const Vec2& b, const Rectangle& window, double& from, double& to) {
    from = 0.0;
    to = 1.0;
    const Vec2 d = b - a;
    const std::array<double, 4> p{-d.x(), d.x(), -d.y(), d.y()};
    const std::array<double, 4> q{a.x() - window.x0, window.x1 - a.x(), a.y() - window.y0, window.y1 - a.y()};
    for (std::size_t k = 0; k < 4; ++k) {
        if (p[k] == 0.0 && q[k] < 0.0) return false;
        if (p[k] < 0.0) from = std::max(from, q[k] / p[k]);
        if (p[k] > 0.0) to = std::min(to, q[k] / p[k]);
    }
    return from < to;
}

}  // namespace

Vec2 text_size(const std::string& text, const TextStyle& style) {
    if (text.empty()) return {0.0, style.size};
    vtkNew<vtkTextProperty> property;
    TextStyle upright = style;
    upright.angle = 0.0;
    apply(upright, property);
    std::array<int, 4> box{};
    vtkTextRenderer* renderer = vtkTextRenderer::GetInstance();
    renderer->GetBoundingBox(property, text, box.data(), kDpi, vtkTextRenderer::FreeType);
    return {box[1] - box[0] + 1.0, box[3] - box[2] + 1.0};
}

std::string power_of_ten(int exponent) {
    static const std::array<const char*, 10> digits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    const std::string plain = std::to_string(exponent);
    if (font_file(false).empty()) return "1e" + plain;
    std::string text = "10";
    for (const char c : plain) text += c == '-' ? "⁻" : digits[static_cast<std::size_t>(c - '0')];
    return text;
}

std::vector<std::string> wrapped(const std::string& text, const TextStyle& style, double width) {
    std::vector<std::string> lines;
    std::size_t at = 0;
    while (at < text.size()) {
        const std::size_t end = std::min(text.find_first_of(" \n", at), text.size());
        const std::string word = text.substr(at, end - at);
        const bool fits =
            !lines.empty() && text[at - 1] != '\n' && text_size(lines.back() + " " + word, style).x() <= width;
        if (fits)
            lines.back() += " " + word;
        else
            lines.push_back(word);
        at = end + 1;
    }
    return lines;
}

std::vector<std::vector<Vec2>> clipped(const std::vector<Vec2>& line, const Rectangle& window) {
    std::vector<std::vector<Vec2>> pieces;
    bool open = false;
    for (std::size_t i = 1; i < line.size(); ++i) {
        double from = 0.0, to = 1.0;
        if (!inside_part(line[i - 1], line[i], window, from, to)) {
            open = false;
            continue;
        }
        const Vec2 d = line[i] - line[i - 1];
        if (!open || from > 0.0) pieces.push_back({line[i - 1] + from * d});
        pieces.back().push_back(line[i - 1] + to * d);
        open = to >= 1.0;
    }
    return pieces;
}

struct Canvas::Sheet {
    struct Layer {  // an image, or the shapes drawn until the next image
        vtkSmartPointer<vtkActor2D> image;
        vtkNew<vtkPoints> points;
        vtkNew<vtkCellArray> triangles;
        vtkNew<vtkUnsignedCharArray> colours;
    };
    std::vector<std::unique_ptr<Layer>> layers;
    std::vector<vtkSmartPointer<vtkTextActor>> texts;

    Layer& shapes() {
        if (layers.empty() || layers.back()->image) {
            layers.push_back(std::make_unique<Layer>());
            layers.back()->colours->SetNumberOfComponents(4);
        }
        return *layers.back();
    }
    void triangle(const Vec2& a, const Vec2& b, const Vec2& c, const Colour& colour) {
        Layer& layer = shapes();
        std::array<vtkIdType, 3> corners{};
        const std::array<const Vec2*, 3> given{&a, &b, &c};
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = layer.points->InsertNextPoint(given[k]->x(), given[k]->y(), 0.0);
            const std::array<unsigned char, 4> rgba{colour.r, colour.g, colour.b, colour.a};
            layer.colours->InsertNextTypedTuple(rgba.data());
        }
        layer.triangles->InsertNextCell(3, corners.data());
    }
};

Canvas::Canvas() : sheet_(std::make_unique<Sheet>()) {}
Canvas::~Canvas() = default;

void Canvas::image(const Pixels& pixels, int x, int y) {
    vtkNew<vtkImageData> data;
    data->SetDimensions(pixels.width, pixels.height, 1);
    data->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    std::memcpy(data->GetScalarPointer(), pixels.rgb.data(), pixels.rgb.size());
    vtkNew<vtkImageMapper> mapper;
    mapper->SetInputData(data);
    mapper->SetColorWindow(255.0);
    mapper->SetColorLevel(127.5);
    auto layer = std::make_unique<Sheet::Layer>();
    layer->image = vtkSmartPointer<vtkActor2D>::New();
    layer->image->SetMapper(mapper);
    layer->image->SetPosition(x, y);
    sheet_->layers.push_back(std::move(layer));
}

void Canvas::fill(const std::vector<Vec2>& convex, const Colour& colour) {
    for (std::size_t i = 2; i < convex.size(); ++i) sheet_->triangle(convex[0], convex[i - 1], convex[i], colour);
}

void Canvas::fill(const Rectangle& r, const Colour& colour) {
    fill({{r.x0, r.y0}, {r.x1, r.y0}, {r.x1, r.y1}, {r.x0, r.y1}}, colour);
}

void Canvas::stroke(const std::vector<Vec2>& line, const Pen& pen) {
    const std::vector<Vec2> points = without_repeats(line);
    if (points.size() < 2) return;
    if (!pen.dash.empty()) {
        for (const auto& piece : dashes(points, pen.dash)) stroke(piece, {pen.colour, pen.width, {}});
        return;
    }
    auto edge = sides(points, pen.width);
    if (points.size() == 2) {
        const Vec2 d = (points[1] - points[0]).cwiseAbs();
        const double width = std::max(1.0, std::round(pen.width));
        if (d.y() == 0.0)
            edge =
                sides({{points[0].x(), snapped(points[0].y(), width)}, {points[1].x(), snapped(points[1].y(), width)}},
                      width);
        if (d.x() == 0.0)
            edge =
                sides({{snapped(points[0].x(), width), points[0].y()}, {snapped(points[1].x(), width), points[1].y()}},
                      width);
    }
    for (std::size_t i = 1; i < edge.size(); ++i) {
        sheet_->triangle(edge[i - 1][0], edge[i - 1][1], edge[i][1], pen.colour);
        sheet_->triangle(edge[i - 1][0], edge[i][1], edge[i][0], pen.colour);
    }
}

void Canvas::frame(const Rectangle& r, const Pen& pen) {
    Pen whole = pen;
    whole.width = std::max(1.0, std::round(pen.width));
    const double x0 = snapped(r.x0, whole.width), x1 = snapped(r.x1, whole.width);
    const double y0 = snapped(r.y0, whole.width), y1 = snapped(r.y1, whole.width);
    stroke({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}}, whole);
}

void Canvas::text(const std::string& text, const Vec2& at, const TextStyle& style) {
    if (text.empty()) return;
    auto actor = vtkSmartPointer<vtkTextActor>::New();
    actor->SetInput(text.c_str());
    actor->SetTextScaleModeToNone();
    apply(style, actor->GetTextProperty());
    actor->SetPosition(std::round(at.x()), std::round(at.y()));
    sheet_->texts.push_back(actor);
}

void Canvas::show(vtkRenderer* renderer) const {
    vtkTextRenderer::GetInstance()->SetDefaultBackend(vtkTextRenderer::FreeType);  // "$" is a plain sign
    int number = 0;
    for (const auto& layer : sheet_->layers) {
        vtkSmartPointer<vtkActor2D> actor = layer->image;
        if (!actor) {
            vtkNew<vtkPolyData> shapes;
            shapes->SetPoints(layer->points);
            shapes->SetPolys(layer->triangles);
            shapes->GetPointData()->SetScalars(layer->colours);
            vtkNew<vtkPolyDataMapper2D> mapper;
            mapper->SetInputData(shapes);
            actor = vtkSmartPointer<vtkActor2D>::New();
            actor->SetMapper(mapper);
        }
        actor->SetLayerNumber(number++);
        renderer->AddActor2D(actor);
    }
    for (const auto& text : sheet_->texts) {
        text->SetLayerNumber(number);
        renderer->AddActor2D(text);
    }
}

}  // namespace frana
