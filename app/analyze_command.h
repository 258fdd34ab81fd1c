#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "analysis/analysis.h"
#include "app/command.h"
#include "pipelines/analyze/adjusted_snapshots.h"

namespace grainfield::app {

/// `grainfield analyze`: a trajectory or table of points to a results file.
class AnalyzeCommand : public Command {
 public:
    std::string name() const override { return "analyze"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    Summary run(Session& session) override;

 private:
    Summary work(Session& session) const;
    Summary run_fields(Session& session) const;
    enum class BoundaryChoice { as_in_file, periodic, walls };

    pipelines::Adjustment adjustment() const;
    std::string label_of(const Results& results, const std::filesystem::path& input) const;

    std::string output_;
    std::string label_;
    std::string box_;
    std::string wavevectors_;
    BoundaryChoice boundary_ = BoundaryChoice::as_in_file;
    std::optional<double> fps_;
    std::optional<double> particle_diameter_;
    std::optional<double> gamma_;
    bool from_fields_ = false;
    analysis::AnalysisOptions analysis_;
};

}  // namespace grainfield::app
