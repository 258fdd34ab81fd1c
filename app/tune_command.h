#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/command.h"
#include "pipelines/film/film.h"
#include "report/report.h"
#include "tracking/survey.h"

namespace grainfield::app {

/// `grainfield tune`: what the tracker makes of some frames with the options given, to choose
/// better ones by: a page with overlay, residual, distributions and suggested settings.
class TuneCommand : public Command {
 public:
    std::string name() const override { return "tune"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    Summary run(Session& session) override;

 private:
    Summary work(Session& session);
    std::vector<tracking::Survey> look(Session& session, pipelines::WatchedFrames& frames,
                                       const tracking::Tracker& tracker,
                                       std::vector<Preview>& previews) const;

    std::string output_;
    std::int64_t samples_ = 3;
    pipelines::FilmOptions film_;
    tracking::TrackOptions tracking_;
    report::ReportOptions report_;
};

}  // namespace grainfield::app
