// The Catalyst that ships with Debian's paraview-dev (ParaView 5.11): a coprocessor with a Python pipeline.
#include "vtk_io/catalyst.h"

#include <fmt/core.h>
#include <vtkCPDataDescription.h>
#include <vtkCPInputDataDescription.h>
#include <vtkCPProcessor.h>
#include <vtkCPPythonPipeline.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <cstdlib>
#include <fstream>

#include "base/error.h"
#include "vtk_io/writers_xml.h"

namespace frana {
namespace {

class Catalyst final : public InsituWork {
public:
    explicit Catalyst(std::filesystem::path script) : script_(std::move(script)) {}
    ~Catalyst() override {
        if (started_) processor_->Finalize();
    }

    void sample(const Frame& frame, Index number) override {
        if (!started_) start();
        vtkNew<vtkCPDataDescription> description;
        description->SetTimeData(frame.status.time, static_cast<vtkIdType>(number));
        description->AddInput("grid");
        description->AddInput("particles");
        if (processor_->RequestDataDescription(description) == 0) {
            if (failed_) throw trouble("failed before and is not called any more");
            return;  // it needs nothing now
        }
        const auto grid = image_of(frame);
        grid->GetPointData()->SetActiveScalars("depth");
        description->GetInputDescriptionByName("grid")->SetGrid(grid);
        description->GetInputDescriptionByName("particles")->SetGrid(cloud_of(frame));
        failed_ = processor_->CoProcess(description) == 0;
        if (failed_) throw trouble("failed");
    }

private:
    UserError trouble(const char* what) const {
        return UserError(
            fmt::format("{}: the script {}; expected one that reads the channels grid and particles; "
                        "Python's "
                        "own message is above",
                        script_.string(), what));
    }

    void start() {
        const auto pipeline = vtkCPPythonPipeline::CreateAndInitializePipeline(script_.string().c_str());
        if (!pipeline) throw trouble("cannot be loaded");
        processor_->Initialize();
        started_ = true;
        processor_->AddPipeline(pipeline);
    }

    std::filesystem::path script_;
    vtkNew<vtkCPProcessor> processor_;
    bool started_ = false, failed_ = false;
};

/// Whether a script makes views. Its words tell, which is all that can be had without running it.
bool draws(const std::filesystem::path& script) {
    std::ifstream stream(script);
    for (std::string line; std::getline(stream, line);)
        for (const char* word : {"View(", "CreateView", "Screenshot", "'PNG'", "\"PNG\"", "'JPG'", "\"JPG\""})
            if (line.find(word) != std::string::npos) return true;
    return false;
}

}  // namespace

void check_catalyst(const std::filesystem::path& script, const std::string& place) {
    if (vtkCPPythonPipeline::DetectScriptVersion(script.string().c_str()) != 2)
        throw UserError(
            fmt::format("{}.script: found {}, which is not a Catalyst script of version 2.0; expected "
                        "one that "
                        "begins with \"# script-version: 2.0\"; add that line, or export it anew from "
                        "ParaView",
                        place, script.string()));
    const char* display = std::getenv("DISPLAY");
    if ((display == nullptr || *display == '\0') && draws(script))
        throw UserError(
            fmt::format("{}.script: found {}, which draws, and no display; expected one in DISPLAY, since "
                        "ParaView ends the process without; run under `xvfb-run -a`",
                        place, script.string()));
}

std::unique_ptr<InsituWork> make_catalyst(const std::filesystem::path& script) {
    return std::make_unique<Catalyst>(script);
}

}  // namespace frana
