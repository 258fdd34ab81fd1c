#pragma once

#include <string>
#include <vector>

#include "analysis/statistics/critical.h"
#include "app/command.h"

namespace grainfield::app {

/// `grainfield critical`: S0/S1 of many results against a control parameter, and where it vanishes.
class CriticalCommand : public Command {
 public:
    std::string name() const override { return "critical"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    Summary run(Session& session) override;

 private:
    enum class Exponent { as_fitted, shared };

    Summary work(Session& session) const;
    std::vector<double> control_values(const Session& session,
                                       const std::vector<Results>& results) const;
    std::string parameter_text(const std::vector<Results>& results) const;

    std::string output_;
    std::string values_;
    std::string parameter_;
    std::string label_ = "critical point";
    analysis::CriticalLine line_ = analysis::CriticalLine::free;
    Exponent exponent_ = Exponent::as_fitted;
};

}  // namespace grainfield::app
