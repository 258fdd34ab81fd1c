#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/command.h"
#include "pipelines/run/run_job.h"

namespace grainfield::app {

/// `grainfield run`: a film to tracks, results, report and overlay in one folder, beside the
/// options of all stages for the next time.
class RunCommand : public Command {
 public:
    std::string name() const override { return "run"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    void make_room_for(const GivenText& given) override;
    std::vector<std::string> usual() const override;
    Summary run(Session& session) override;

 private:
    std::string folder_;
    double checkpoint_every_ = 1;  ///< [min]
    pipelines::RunJobOptions job_;
    std::vector<OptionTable> tables_;  ///< all of them, to be written down
};

}  // namespace grainfield::app
