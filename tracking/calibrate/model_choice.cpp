#include "tracking/calibrate/model_choice.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "tracking/calibrate/learned_profile.h"
#include "tracking/model/known_models.h"

namespace grainfield::tracking {
namespace {

/// Where no edges meet, and edges are tanh, all models are the same, and the simplest is fastest.
constexpr double kBetter = 0.99;
/// Where spheres of two layers overlap as opaque discs with a rim do, a learned profile leaves 8 %
/// less residual and worse positions.
constexpr double kMuchBetter = 0.85;

/// A frame fitted with one model.
struct FrameFit {
    std::vector<Vec2> position;
    double rms = 0;  ///< of the residual [contrast]
    Image residual;
};

/// RMS of the residual over pixels where P > 0.01 of two discs or more; zero without such pixels.
double overlap_rms(const FrameFit& fit, const DiscProfile& disc, const VisiblePixels& visible) {
    const double influence = disc.radius() + 2.3 * disc.edge_width;
    Image owners(fit.residual.width(), fit.residual.height());
    for (const Vec2 c : fit.position) {
        const int y1 = std::min(owners.height() - 1, static_cast<int>(c.y + influence));
        const int x1 = std::min(owners.width() - 1, static_cast<int>(c.x + influence));
        for (int y = std::max(0, static_cast<int>(std::ceil(c.y - influence))); y <= y1; ++y) {
            for (int x = std::max(0, static_cast<int>(std::ceil(c.x - influence))); x <= x1; ++x) {
                const Vec2 d{x - c.x, y - c.y};
                if (squared_norm(d) < influence * influence) owners(x, y) += 1;
            }
        }
    }
    double squares = 0;
    double pixels = 0;
    for (int y = 0; y < owners.height(); ++y) {
        for (int x = 0; x < owners.width(); ++x) {
            if (owners(x, y) < 2 || !visible(x, y)) continue;
            const auto left = static_cast<double>(fit.residual(x, y));
            squares += left * left;
            pixels += 1;
        }
    }
    return pixels > 0 ? std::sqrt(squares / pixels) : 0;
}

class Chooser {
 public:
    Chooser(const Image& counts, const std::vector<Vec2>& positions,
            const DetectionOptions& detection, const RefinementOptions& refinement, int threads,
            const VisiblePixels& visible, ImageModel& model, RunPlan& plan)
        : counts_(counts),
          darkness_(model.darkness(counts)),
          start_(positions),
          detection_(detection),
          refinement_(refinement),
          threads_(threads),
          visible_(visible),
          model_(model),
          plan_(plan) {
        detection_.goal = SearchGoal::most_spheres;
    }

    void choose_meeting(const OverlapRule* given) {
        if (given != nullptr) {
            plan_.skip("meeting edges", "given", "two fits of one frame");
            model_.overlap = given;
            return;
        }
        // The first one is the simplest.
        double least = 0;
        std::string residuals;
        for (const OverlapRule* rule : overlap_rules()) {
            FrameFit tried = fit(*rule);
            residuals +=
                fmt::format("{}{:.4f} {}{}", residuals.empty() ? "" : ", ", tried.rms,
                            residuals.empty() ? "of the contrast " : "", rule->condition());
            if (fitted_ && !(tried.rms < kBetter * least)) continue;
            least = tried.rms;
            model_.overlap = rule;
            fitted_ = std::move(tried);
        }
        plan_.run("meeting edges",
                  fmt::format("{}: RMS residual {}", model_.overlap->words(), residuals));
    }

    void choose_profile(const ProfileChoice& choice) {
        if (choice.learning == Learning::never) {
            plan_.skip("profile", fmt::format("{} edges", choice.shape->name()),
                       "one or two fits of one frame");
            return;
        }
        if (!fitted_) fitted_ = fit(*model_.overlap);
        const std::string_view edge = model_.disc.shape->name();
        LearnedProfile learned =
            learn_profile(fitted_->residual, fitted_->position, model_.disc, visible_);
        if (!learned.is_sampled()) {
            const std::string reason = fmt::format(
                "{}: too few pixels near one sphere only: {:.0f} per w/4 of edge, {:.0f} wanted",
                edge, learned.fewest, LearnedProfile::kFewest);
            plan_.skip("profile", reason, "one fit of one frame");
            if (choice.learning == Learning::always)
                plan_.warn("no profile was learned, " + reason);
            return;
        }
        if (learned.correction.is_zero()) {
            plan_.skip("profile",
                       fmt::format("{}: spheres that stand alone show nothing else", edge),
                       "one fit of one frame");
            return;
        }
        if (choice.learning == Learning::automatic &&
            learned.rms_left > kMuchBetter * learned.rms) {
            plan_.skip("profile",
                       fmt::format("{}: near one sphere only, any other profile leaves {:.4f} of "
                                   "{:.4f} of the contrast",
                                   edge, learned.rms_left, learned.rms),
                       "one fit of one frame");
            return;
        }
        const std::string source = fmt::format(
            "up to {:.3f} of the contrast off {}, ± {:.3f}, from {} pixels near one sphere only",
            learned.correction.largest(), edge, learned.error, learned.pixels);
        // Darkness 0 is where no sphere is.
        const BackgroundSurface clear = model_.background.towards(model_.dark_level, learned.veil);
        if (choice.learning == Learning::automatic) {
            ImageModel other = model_;
            other.background = clear;
            darkness_ = other.darkness(counts_);
            const double plain = overlap_rms(*fitted_, model_.disc, visible_);
            const double rms =
                overlap_rms(fit(*model_.overlap, learned.correction), model_.disc, visible_) *
                (1 - learned.veil);
            const bool is_learned = rms < kMuchBetter * plain;
            plan_.run("profile",
                      fmt::format("{}: RMS residual where spheres overlap {:.4f} of the contrast "
                                  "with {} edges, {:.4f} with a learned profile, {}",
                                  is_learned ? "learned" : edge, plain, edge, rms, source));
            if (!is_learned) return;
        } else {
            plan_.run("profile", "learned, as asked for: " + source);
        }
        model_.background = clear;
        model_.correction = std::move(learned.correction);
    }

 private:
    FrameFit fit(const OverlapRule& rule, const RadialCorrection& correction = {}) {
        Locator locator(darkness_.width(), darkness_.height(), {model_.disc, rule, correction},
                        threads_);
        locator.set_visible(visible_);
        Located found = locator.locate(darkness_, detection_, refinement_, start_);
        return {std::move(found.fitted), found.residual_rms, locator.residual()};
    }

    const Image& counts_;
    Image darkness_;
    const std::vector<Vec2>& start_;
    DetectionOptions detection_;
    const RefinementOptions& refinement_;
    int threads_;
    const VisiblePixels& visible_;
    ImageModel& model_;
    RunPlan& plan_;
    std::optional<FrameFit> fitted_;  ///< with the rule chosen, nothing learned
};

}  // namespace

void choose_model(const Image& counts, const std::vector<Vec2>& positions,
                  const CalibrationOptions& options, const DetectionOptions& detection,
                  const RefinementOptions& refinement, int threads, const VisiblePixels& visible,
                  ImageModel& model, RunPlan& plan) {
    Chooser chooser(counts, positions, detection, refinement, threads, visible, model, plan);
    chooser.choose_meeting(options.meeting_edges);
    chooser.choose_profile(options.profile);
}

}  // namespace grainfield::tracking
