#include "pipelines/tune/tune_alternatives.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/support/interrupt.h"
#include "core/support/progress.h"
#include "io/frame_region.h"
#include "pipelines/tune/tune_settings.h"
#include "tracking/survey.h"

namespace grainfield::pipelines {

namespace {

using tracking::Polarity;
using tracking::PolarityChoice;
using tracking::TrackOptions;

constexpr double part_width = 24;  // [D]
constexpr std::array diameter_factors{0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.45};
constexpr std::array threshold_factors{0.5, 1.0, 2.0, 4.0};
constexpr std::size_t own_diameter = 3;
constexpr std::size_t own_threshold = 1;

/// One picture as a film.
class OneFrame : public FrameSource {
 public:
    explicit OneFrame(Image image) {
        frame_.image = std::move(image);
        frame_.status = FrameStatus::ok;
    }
    std::int64_t count() const override { return 1; }
    int width() const override { return frame_.image.width(); }
    int height() const override { return frame_.image.height(); }
    int bit_depth() const override { return 16; }
    std::optional<double> frame_rate() const override { return std::nullopt; }
    Frame read(std::int64_t /*index*/) override { return frame_; }
    std::string name() const override { return "part of the frame"; }
    const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
    Frame frame_;
    std::vector<std::string> warnings_;
};

io::FrameRegion part_of(const Image& image, double diameter) {
    const int wanted = static_cast<int>(std::ceil(part_width * diameter));
    io::FrameRegion part;
    part.width = std::min(wanted, image.width());
    part.height = std::min(wanted, image.height());
    part.x = (image.width() - part.width) / 2;
    part.y = (image.height() - part.height) / 2;
    return part;
}

/// What belongs to the whole frame, or to what comes after the search, is left out.
TrackOptions options_of_part(const TrackOptions& given, const io::FrameRegion& part) {
    TrackOptions options = given;
    options.detection = tracking::detection_of(given);  // which spheres have room
    options.visible = given.visible.part(part.x, part.y, part.width, part.height);
    options.kept.reset();
    options.camera.reset();
    options.part.reset();
    options.synthesis = false;
    options.correct_bias = false;  // it moves what is found little
    options.layers = {};
    options.keeps = false;
    return options;
}

const char* name_of(Polarity polarity) {
    return polarity == Polarity::dark ? "dark" : "bright";
}

}  // namespace

report::Alternatives tuned_alternatives(const Frame& frame, Polarity own_polarity, double own,
                                        double evidence, const TrackOptions& options,
                                        const FilmOptions& film, const Job& job) {
    const io::FrameRegion part = part_of(frame.image, own);
    report::Alternatives all;
    all.title = "Other settings, tried on a part of the frame";
    all.picture = io::cropped(frame.image, part);
    OneFrame source(all.picture);
    TrackOptions tried = options_of_part(options, part);
    tried.threads = job.threads;

    const Polarity other = own_polarity == Polarity::dark ? Polarity::bright : Polarity::dark;
    all.axes = {{"Polarity", {name_of(own_polarity), name_of(other)}, 0},
                {"Apparent diameter D", {}, own_diameter},
                {"Threshold (evidence)", {}, own_threshold}};
    for (const double factor : diameter_factors) {
        all.axes[1].values.push_back(fmt::format("{:.2f} px", factor * own));
    }
    const auto threshold = [&](double factor) { return std::min(0.9, factor * evidence); };
    for (const double factor : threshold_factors) {
        all.axes[2].values.push_back(fmt::format("{:.3f}", threshold(factor)));
    }
    constexpr auto number =
        static_cast<std::int64_t>(2 * std::size(diameter_factors) * std::size(threshold_factors));
    Progress progress("trying", number, "settings", job.verbosity);
    for (const Polarity polarity : {own_polarity, other}) {
        for (const double size : diameter_factors) {
            throw_if_interrupted("tuning");
            const double diameter = size * own;
            tried.calibration.polarity =
                polarity == Polarity::dark ? PolarityChoice::dark : PolarityChoice::bright;
            tried.calibration.diameter = diameter;
            RunPlan quiet;  // what is wrong with a poor alternative is for its picture to say
            const tracking::Tracker tracker(source, tried, quiet);
            for (const double factor : threshold_factors) {
                report::Alternative found{
                    {},
                    diameter,
                    "",
                    toml_of(settings_with(options, film, {polarity, diameter, threshold(factor)}))};
                if (tracker.is_calibrated()) {
                    TrackOptions searched = tried;
                    searched.detection.evidence = threshold(factor);
                    tracking::Surveyor surveyor(tracker.model(), searched, source.width(),
                                                source.height());
                    const tracking::Survey survey = surveyor.look(source.read(0));
                    found.position = survey.found.position;
                    found.words = fmt::format(
                        "{}; RMS residual {:.4f} of the contrast",
                        counted(static_cast<std::int64_t>(found.position.size()), "sphere"),
                        survey.found.residual_rms);
                } else {
                    found.words = "no spheres: nothing in this part looks like that";
                }
                all.tried.push_back(std::move(found));
                progress.advance();
            }
        }
    }
    return all;
}

}  // namespace grainfield::pipelines
