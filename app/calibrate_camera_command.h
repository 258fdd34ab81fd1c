#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/command.h"
#include "pipelines/camera/camera_job.h"

namespace grainfield::app {

/// `grainfield calibrate-camera`: pictures of a board to a camera file.
class CalibrateCameraCommand : public Command {
 public:
    std::string name() const override { return "calibrate-camera"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    Summary run(Session& session) override;
    std::string default_output(const std::vector<std::filesystem::path>& inputs) const override;

 private:
    Summary work(Session& session) const;

    std::string output_;
    pipelines::CameraJobOptions job_;
};

}  // namespace grainfield::app
