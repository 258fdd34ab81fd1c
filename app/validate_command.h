#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/command.h"
#include "pipelines/validate/validate_job.h"

namespace grainfield::app {

/// `grainfield validate`: frames whose truth is known, tracked, and how well that meets the truth.
///
/// The frames are rendered from a run of molecular dynamics that the scene file describes, or from
/// a trajectory that exists; or they are given together with their truth; or each is a scene of its
/// own by a camera that is drawn at random.
class ValidateCommand : public Command {
 public:
    std::string name() const override { return "validate"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    std::vector<std::string> usual() const override;
    Summary run(Session& session) override;
    std::string default_output(const std::vector<std::filesystem::path>& inputs) const override;

 private:
    Summary run_random(Session& session);
    Summary run_one_camera(Session& session);

    std::string output_;
    pipelines::ValidateJobOptions job_;
};

}  // namespace grainfield::app
