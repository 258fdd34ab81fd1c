#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/command.h"
#include "report/report.h"

namespace grainfield::app {

/// `grainfield compare`: one or more results files to one report.
class CompareCommand : public Command {
 public:
    std::string name() const override { return "compare"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    Summary run(Session& session) override;
    std::string default_output(const std::vector<std::filesystem::path>& inputs) const override;

 private:
    Summary work(Session& session) const;
    Summary draw_figure(Session& session) const;
    report::ReportOptions drawn_options() const;

    std::string output_;
    std::string figure_;
    std::string committed_;
    report::ReportOptions report_;
};

}  // namespace grainfield::app
