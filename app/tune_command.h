#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/command.h"
#include "pipelines/tune/tune_job.h"

namespace grainfield::app {

/// `grainfield tune`: what the tracker makes of some frames with the options given, to choose
/// better ones by: a page with overlay, residual, distributions and suggested settings.
class TuneCommand : public Command {
 public:
    std::string name() const override { return "tune"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    std::vector<std::string> usual() const override;
    Summary run(Session& session) override;
    std::string default_output(const std::vector<std::filesystem::path>& inputs) const override;

 private:
    Summary work(Session& session);

    std::string output_;
    pipelines::TuneJobOptions job_;
};

/// The command line that tracks `inputs` with the settings, for a POSIX shell. More than three
/// inputs that are all that their folder holds are named by it.
std::string track_command_line(const std::vector<pipelines::Setting>& settings,
                               const std::vector<std::filesystem::path>& inputs);

}  // namespace grainfield::app
