#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/command.h"
#include "pipelines/render/render_job.h"

namespace grainfield::app {

/// `grainfield render`: camera frames of a trajectory.
class RenderCommand : public Command {
 public:
    std::string name() const override { return "render"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    std::vector<std::string> usual() const override;
    Summary run(Session& session) override;
    std::string default_output(const std::vector<std::filesystem::path>& inputs) const override;

 private:
    pipelines::RenderJobOptions job_;
    double checkpoint_every_ = 1;  ///< [min]
};

}  // namespace grainfield::app
