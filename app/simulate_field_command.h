#pragma once

#include <string>

#include "analysis/spectra/structure_factor.h"
#include "app/command.h"
#include "simulate/field/field_options.h"

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
    Summary run(Session& session) override;

 private:
    std::string output_;
    bool resume_ = false;
    double checkpoint_every_ = 60;
    std::string nu_list_;
    simulate::FieldOptions field_;
    analysis::StructureFactorOptions sk_;
};

}  // namespace grainfield::app
