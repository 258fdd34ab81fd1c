#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/command.h"
#include "pipelines/analyze/analyze_job.h"

namespace grainfield::app {

/// `grainfield analyze`: a trajectory or table of points to a results file.
class AnalyzeCommand : public Command {
 public:
    std::string name() const override { return "analyze"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    std::vector<std::string> usual() const override;
    std::string advice_on(std::string_view unknown_option) const override;
    Summary run(Session& session) override;
    std::string default_output(const std::vector<std::filesystem::path>& inputs) const override;

 private:
    enum class BoundaryChoice { as_in_file, periodic, walls };

    pipelines::AnalyzeJobOptions job() const;
    void require_inputs(const Session& session) const;

    std::string output_;
    std::vector<double> box_;
    std::string wavevectors_;
    BoundaryChoice boundary_ = BoundaryChoice::as_in_file;
    bool from_fields_ = false;
    bool is_partial_ = false;
    bool is_merge_ = false;
    pipelines::AnalyzeJobOptions job_;
};

}  // namespace grainfield::app
