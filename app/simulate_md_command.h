#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/command.h"
#include "pipelines/md/md_job.h"

namespace grainfield::app {

/// `grainfield simulate md`: a vibrated layer to a trajectory file.
class SimulateMdCommand : public Command {
 public:
    std::string name() const override { return "simulate md"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    std::vector<std::string> usual() const override;
    void make_room_for(const GivenText& given) override;
    Summary run(Session& session) override;
    std::string default_output(const std::vector<std::filesystem::path>& inputs) const override;

 private:
    std::string output_;
    double checkpoint_every_ = 10;  ///< [min]
    pipelines::MdJobOptions job_;
};

}  // namespace grainfield::app
