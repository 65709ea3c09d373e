#include "vtk_io/figures/offscreen.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <fmt/core.h>
#include <vtkCallbackCommand.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkOutputWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkStringOutputWindow.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVersionMacros.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>
#include <vector>

#include "vtk_io/figures/canvas.h"

// VTK before 9.4 loads OpenGL through GLEW, and Debian builds GLEW for GLX. glewInit() finds all entry points, then
// answers 4, "no GLX display". The entry points serve EGL as well. The dynamic linker finds this definition before
// GLEW's, and it turns that one answer into success. It must be in the module that is opened for pictures, ahead of the
// libraries that it needs. Or it is in an executable that exports it.
extern "C" __attribute__((visibility("default"))) unsigned int glewInit() {  // NOLINT(readability-identifier-naming)
    using Init = unsigned int (*)();
    constexpr unsigned int no_glx_display = 4;
    const auto real = reinterpret_cast<Init>(dlsym(RTLD_NEXT, "glewInit"));
    if (!real) return 1;
    const unsigned int answer = real();
    return answer == no_glx_display ? 0 : answer;
}

namespace frana {
namespace {

/// The EGL context of the process. Made once and never taken down: drivers do not like that at exit.
class EglContext {
public:
    static EglContext& instance() {
        static auto* const only = new EglContext;
        return *only;
    }
    const std::string& problem() const { return problem_; }
    std::mutex& mutex() { return mutex_; }
    bool make_current() { return eglMakeCurrent(display_, surface_, surface_, context_) == EGL_TRUE; }
    /// VTK's own windows set this on start, and its generic window expects to find it. Nearer or EQUAL depth wins, so
    /// that what is drawn later lies on top, and colours blend by alpha.
    void set_defaults() {
        constexpr unsigned int lequal = 0x0203, depth_test = 0x0B71, blend = 0x0BE2;
        constexpr unsigned int source_alpha = 0x0302, one_minus_source_alpha = 0x0303, one = 1;
        const auto enable = entry<void (*)(unsigned int)>("glEnable");
        const auto depth = entry<void (*)(unsigned int)>("glDepthFunc");
        using Blend = void (*)(unsigned int, unsigned int, unsigned int, unsigned int);
        const auto blending = entry<Blend>("glBlendFuncSeparate");
        if (!enable || !depth || !blending) return;
        enable(depth_test);
        depth(lequal);
        enable(blend);
        blending(source_alpha, one_minus_source_alpha, one, one_minus_source_alpha);
    }
    void release() { eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }
    bool is_current() const { return eglGetCurrentContext() == context_ && context_ != EGL_NO_CONTEXT; }

private:
    EglContext() {
        if (!shim_is_first()) {
            problem_ = "the program does not export its glewInit (link it with -rdynamic)";
            return;
        }
        problem_ = "EGL offers no display without a screen (on Debian: apt-get install libegl1 libgl1-mesa-dri)";
        if (open_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY) && make_context()) return;
        const auto query = entry<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
        std::array<EGLDeviceEXT, 16> devices{};
        EGLint count = 0;
        if (!query || !query(static_cast<EGLint>(devices.size()), devices.data(), &count)) return;
        for (EGLint i = 0; i < count; ++i)
            if (open_display(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)]) && make_context()) return;
    }

    template <class Function>
    static Function entry(const char* name) {
        return reinterpret_cast<Function>(eglGetProcAddress(name));
    }

    static bool shim_is_first() {
        const bool uses_glew = VTK_MAJOR_VERSION < 9 || (VTK_MAJOR_VERSION == 9 && VTK_MINOR_VERSION < 4);
        return !uses_glew || dlsym(RTLD_DEFAULT, "glewInit") == reinterpret_cast<void*>(&glewInit);
    }

    bool open_display(EGLenum platform, void* native) {
        const auto get = entry<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
        display_ = get ? get(platform, native, nullptr) : EGL_NO_DISPLAY;
        return display_ != EGL_NO_DISPLAY && eglInitialize(display_, nullptr, nullptr) == EGL_TRUE;
    }

    using Attributes = std::vector<std::pair<EGLint, EGLint>>;
    static std::vector<EGLint> flat(const Attributes& attributes) {
        std::vector<EGLint> list;
        for (const auto& [name, value] : attributes) list.insert(list.end(), {name, value});
        list.push_back(EGL_NONE);
        return list;
    }

    /// VTK draws into framebuffers of its own: the surface only has to exist.
    bool make_context() {
        const auto wanted = flat({{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT},
                                  {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT},
                                  {EGL_RED_SIZE, 8},
                                  {EGL_GREEN_SIZE, 8},
                                  {EGL_BLUE_SIZE, 8},
                                  {EGL_ALPHA_SIZE, 8},
                                  {EGL_DEPTH_SIZE, 24}});
        const auto version = flat({{EGL_CONTEXT_MAJOR_VERSION, 3},
                                   {EGL_CONTEXT_MINOR_VERSION, 2},
                                   {EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT}});
        const auto size = flat({{EGL_WIDTH, 16}, {EGL_HEIGHT, 16}});
        EGLConfig config = nullptr;
        EGLint count = 0;
        problem_ = "EGL gives no OpenGL 3.2 context";
        if (!eglBindAPI(EGL_OPENGL_API)) return false;
        if (!eglChooseConfig(display_, wanted.data(), &config, 1, &count) || count < 1) return false;
        context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, version.data());
        if (context_ == EGL_NO_CONTEXT) return false;
        surface_ = eglCreatePbufferSurface(display_, config, size.data());
        if (surface_ == EGL_NO_SURFACE || !make_current()) return false;
        release();
        problem_.clear();
        return true;
    }

    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
    EGLSurface surface_ = EGL_NO_SURFACE;
    std::mutex mutex_;
    std::string problem_;
};

void answer(vtkObject*, unsigned long event, void*, void* data) {
    EglContext& egl = EglContext::instance();
    if (event == vtkCommand::WindowMakeCurrentEvent) egl.make_current();
    if (event == vtkCommand::WindowIsCurrentEvent) *static_cast<bool*>(data) = egl.is_current();
    if (event == vtkCommand::WindowSupportsOpenGLEvent) *static_cast<int*>(data) = 1;
    if (event == vtkCommand::WindowIsDirectEvent) *static_cast<int*>(data) = 1;
}

}  // namespace

/// VTK's window and what has to be put back when it goes; the context stays current until then.
struct Offscreen::Window {
    Window(int width, int height) : messages_before(vtkOutputWindow::GetInstance()) {
        vtkOutputWindow::SetInstance(messages);
        vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
        vtkNew<vtkCallbackCommand> callback;
        callback->SetCallback(answer);
        for (const unsigned long event : {vtkCommand::WindowMakeCurrentEvent, vtkCommand::WindowIsCurrentEvent,
                                          vtkCommand::WindowSupportsOpenGLEvent, vtkCommand::WindowIsDirectEvent})
            vtk->AddObserver(event, callback);
        vtk->SetMultiSamples(0);
        vtk->SetSize(width, height);
        vtk->SetReadyForRendering(true);
        vtk->SetOwnContext(1);
    }
    ~Window() {
        vtk->Finalize();
        vtk = nullptr;
        vtkOutputWindow::SetInstance(messages_before);
        vtkLogger::SetStderrVerbosity(verbosity_before);
        EglContext::instance().release();
    }
    /// The first error VTK reported, on one line; empty when none.
    std::string errors() const {
        const std::string text = messages->GetOutput();
        const auto start = text.find("ERROR:");
        if (start == std::string::npos) return "";
        std::string first = text.substr(start, text.find("\n\n", start) - start);
        std::replace(first.begin(), first.end(), '\n', ' ');
        return first;
    }

    std::unique_lock<std::mutex> lock;
    vtkSmartPointer<vtkOutputWindow> messages_before;
    vtkLogger::Verbosity verbosity_before = vtkLogger::GetCurrentVerbosityCutoff();
    vtkNew<vtkStringOutputWindow> messages;
    vtkSmartPointer<vtkGenericOpenGLRenderWindow> vtk = vtkSmartPointer<vtkGenericOpenGLRenderWindow>::New();
};

std::string no_renderer_reason() {
    const std::string off = no_picture_reason();
    return off.empty() ? EglContext::instance().problem() : off;
}

std::unique_ptr<Offscreen> Offscreen::open(int width, int height, std::string& why_not) {
    why_not = no_renderer_reason();
    if (!why_not.empty()) return nullptr;
    std::unique_lock<std::mutex> lock(EglContext::instance().mutex());
    if (!EglContext::instance().make_current()) {
        why_not = "the EGL context cannot be made current in this thread";
        return nullptr;
    }
    EglContext::instance().set_defaults();
    auto made = std::make_unique<Window>(width, height);
    made->lock = std::move(lock);
    return std::unique_ptr<Offscreen>(new Offscreen(std::move(made)));
}

Offscreen::Offscreen(std::unique_ptr<Window> window) : window_(std::move(window)) {}

Offscreen::~Offscreen() = default;

void Offscreen::add(vtkRenderer* renderer, int layer) {
    renderer->SetBackground(1.0, 1.0, 1.0);
    renderer->SetLayer(layer);
    window_->vtk->SetNumberOfLayers(std::max(window_->vtk->GetNumberOfLayers(), layer + 1));
    window_->vtk->AddRenderer(renderer);
}

bool Offscreen::grab(Pixels& picture, std::string& why_not) {
    window_->vtk->Render();
    why_not = window_->errors();
    if (!why_not.empty()) return false;
    const int* size = window_->vtk->GetSize();
    picture = Pixels(size[0], size[1]);
    vtkNew<vtkUnsignedCharArray> bytes;
    window_->vtk->GetPixelData(0, 0, size[0] - 1, size[1] - 1, 0, bytes, 0);
    why_not = window_->errors();
    if (why_not.empty() && bytes->GetNumberOfValues() != static_cast<vtkIdType>(picture.rgb.size()))
        why_not = "VTK gave no picture of the size that was asked for";
    if (!why_not.empty()) return false;
    std::copy_n(bytes->GetPointer(0), picture.rgb.size(), picture.rgb.begin());
    return true;
}

}  // namespace frana
