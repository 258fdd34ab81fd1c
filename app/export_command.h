#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/command.h"
#include "io/text/export_files.h"
#include "pipelines/overlay/overlay_job.h"

namespace grainfield::app {

/// How particles are written: as the name of the output says, or as asked for.
enum class Printed { as_named, csv, xyz };

/// `grainfield export`: trajectories and results to plain text files, or to a video.
class ExportCommand : public Command {
 public:
    std::string name() const override { return "export"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    Summary run(Session& session) override;
    std::string default_output(const std::vector<std::filesystem::path>& inputs) const override;

 private:
    Summary work(Session& session) const;
    Summary print(Session& session) const;
    Summary run_overlay(Session& session) const;

    std::string output_;
    io::PointsForm form_;
    Printed printed_ = Printed::as_named;
    std::string overlay_output_;
    std::string film_;
    pipelines::OverlayJobOptions overlay_;
};

}  // namespace grainfield::app
