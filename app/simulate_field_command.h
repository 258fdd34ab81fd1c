#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/command.h"
#include "pipelines/field/field_job.h"

namespace grainfield::app {

/// `grainfield simulate field`: the coupled order and density fields to a field file.
class SimulateFieldCommand : public Command {
 public:
    std::string name() const override { return "simulate field"; }
    std::string purpose() const override;
    Inputs inputs() const override {
        return {.placeholder = "", .meaning = "", .count = Count::none};
    }
    std::vector<OptionTable> options() override;
    std::vector<std::string> usual() const override;
    Summary run(Session& session) override;
    std::string default_output(const std::vector<std::filesystem::path>& inputs) const override;

 private:
    /// One for each value of nu.
    std::vector<pipelines::FieldJobOptions> jobs() const;

    std::string output_;
    double checkpoint_every_ = 60;  ///< [s]
    std::vector<double> nu_list_;
    pipelines::FieldJobOptions job_;
};

}  // namespace grainfield::app
