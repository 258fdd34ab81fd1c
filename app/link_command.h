#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/command.h"
#include "pipelines/link/link_job.h"

namespace grainfield::app {

/// `grainfield link`: parts of a film that were tracked apart to one trajectory.
class LinkCommand : public Command {
 public:
    std::string name() const override { return "link"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    std::vector<std::string> usual() const override;
    Summary run(Session& session) override;
    std::string default_output(const std::vector<std::filesystem::path>& inputs) const override;

 private:
    std::string output_;
    pipelines::LinkJobOptions job_;
};

}  // namespace grainfield::app
