#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/command.h"
#include "pipelines/critical/critical_job.h"

namespace grainfield::app {

/// `grainfield critical`: S0/S1 of many results against a control parameter, and where it vanishes.
class CriticalCommand : public Command {
 public:
    std::string name() const override { return "critical"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    Summary run(Session& session) override;
    std::string default_output(const std::vector<std::filesystem::path>& inputs) const override;

 private:
    Summary work(Session& session) const;

    std::string output_;
    std::vector<double> values_;
    pipelines::CriticalJobOptions job_;
};

}  // namespace grainfield::app
