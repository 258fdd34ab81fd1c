#include "tracking/synthesis/film_synthesis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

constexpr double kSameSphere = 0.3;      // [a]
constexpr double kRadius = 0.5;          // [a]
constexpr double kDoubtfulShare = 0.01;  // of the spheres of a frame

/// Height of each disc in the frame before; that of no sphere: the middle of the cell [a].
std::vector<double> earlier_heights(const std::vector<Vec2>& discs, const SynthesisedFrame& earlier,
                                    double diameter, double middle) {
    const double range = kSameSphere * diameter;
    std::vector<double> heights(discs.size(), middle);
    if (earlier.position.empty()) return heights;
    const PointGrid grid(earlier.position, range);
    for (std::size_t i = 0; i < discs.size(); ++i) {
        double nearest = range * range;
        grid.near(discs[i], range, [&](std::uint32_t j, Vec2 p) {
            const double squared = squared_norm(p - discs[i]);
            if (squared >= nearest) return;
            nearest = squared;
            heights[i] = earlier.z[j];
        });
    }
    return heights;
}

Layer layer_of(double z, double error, double middle) {
    if (error > kMostHeightError || !(std::abs(z - middle) > error)) return Layer::unknown;
    return z > middle ? Layer::top : Layer::bottom;
}

}  // namespace

FilmSynthesis::FilmSynthesis(const ImageModel& model, double diameter, double camera_distance,
                             const SynthesisOptions& options)
    : model_(model), diameter_(diameter), camera_distance_(camera_distance), options_(options) {
    if (model.polarity != Polarity::dark) {
        throw OptionError({.problem = "synthesis cannot render these spheres",
                           .actual = "bright spheres on a dark background",
                           .expected = "mirror-like spheres before a bright panel: dark discs",
                           .suggestion = "set calibrate.polarity to dark if they are, or leave "
                                         "track.synthesis out"});
    }
}

SynthesisedFrame FilmSynthesis::next(const Image& counts, const std::vector<Vec2>& discs,
                                     const SynthesisedFrame* earlier, int threads) const {
    const bool has_optics = earlier != nullptr && earlier->residual_rms > 0;
    if (discs.empty()) return has_optics ? leaving(optics_of(*earlier)) : SynthesisedFrame{};
    SynthesisStart start{.position = discs, .z = {}, .optics = {}, .are_optics_known = false};
    start.optics.distance = camera_distance_;
    if (has_optics) {
        start.optics = earlier->optics;
        start.optics_error = earlier->optics_error;
        start.are_optics_known = true;
        start.error_scale = earlier->error_scale;
        start.z = earlier_heights(discs, *earlier, diameter_, 0.5 * (options_.height - 1));
    }
    Synthesis result = synthesise(counts, model_, diameter_, start, options_, threads);
    return {.position = std::move(result.position),
            .error = std::move(result.error),
            .z = std::move(result.z),
            .z_error = std::move(result.z_error),
            .residual = std::move(result.residual),
            .optics = result.optics,
            .optics_error = result.optics_error,
            .error_scale = result.error_scale,
            .residual_before = result.residual_before,
            .residual_rms = result.residual_rms,
            .unexplained = result.unexplained,
            .added = result.added,
            .removed = result.removed,
            .lifted = result.lifted,
            .doubtful = result.doubtful};
}

FilmOptics FilmSynthesis::optics_of(const SynthesisedFrame& found) const {
    return {diameter_, options_.height, found.optics, found.optics_error, found.error_scale};
}

SynthesisedFrame FilmSynthesis::leaving(const FilmOptics& film) {
    SynthesisedFrame frame;
    frame.optics = film.optics;
    frame.optics_error = film.error;
    frame.error_scale = film.error_scale;
    frame.residual_rms = 1;  // it has been found
    return frame;
}

std::string FilmSynthesis::mismatch(const FilmOptics& kept) const {
    const auto differs = [](const char* option, double theirs, double ours) {
        return theirs == ours
                   ? std::string()
                   : fmt::format("{} is {:.6g} there and {:.6g} here", option, theirs, ours);
    };
    for (const std::string& words :
         {differs("track.sphere-diameter", kept.diameter, diameter_),
          differs("layers.height", kept.height, options_.height),
          differs("layers.camera-distance", kept.optics.distance, camera_distance_)}) {
        if (!words.empty()) return words;
    }
    return "";
}

void FilmSynthesis::report(const SynthesisedFrame& found, double border, Snapshot& snapshot) const {
    const Vec2 low = snapshot.box.origin + Vec2{0.5, 0.5};
    const Vec2 high = snapshot.box.origin + snapshot.box.length - Vec2{0.5, 0.5};
    const double middle = 0.5 * (options_.height - 1);
    for (std::size_t i = 0; i < found.position.size(); ++i) {
        const Vec2 p = found.position[i];
        const double inside = std::min({p.x - low.x, p.y - low.y, high.x - p.x, high.y - p.y});
        if (!(inside >= border)) continue;
        snapshot.position.push_back(p);
        snapshot.position_error.push_back(found.error[i]);
        snapshot.z.push_back((found.z[i] + kRadius) * diameter_);
        snapshot.z_error.push_back(found.z_error[i] * diameter_);
        snapshot.layer.push_back(layer_of(found.z[i], found.z_error[i], middle));
        snapshot.quality.push_back(found.residual[i]);
    }
}

void add(const SynthesisedFrame& found, std::int64_t frame, SynthesisSummary& summary) {
    const auto spheres = static_cast<std::int64_t>(found.position.size());
    if (spheres == 0) return;
    ++summary.frames;
    summary.spheres += spheres;
    summary.doubtful += found.doubtful;
    summary.heights_known += std::count_if(found.z_error.begin(), found.z_error.end(),
                                           [](double error) { return error <= kMostHeightError; });
    summary.added += found.added;
    summary.removed += found.removed;
    summary.lifted += found.lifted;
    summary.residual_before += found.residual_before;
    summary.residual_rms += found.residual_rms;
    summary.optics = found.optics;
    summary.optics_error = found.optics_error;
    summary.risen_frames += found.residual_rms < found.residual_before ? 0 : 1;
    summary.unexplained_frames += found.unexplained > kMostUnexplained ? 1 : 0;
    summary.most_unexplained = std::max(summary.most_unexplained, found.unexplained);
    summary.unscaled_frames += found.error_scale.spheres == 0 ? 1 : 0;
    const double share = static_cast<double>(found.doubtful) / static_cast<double>(spheres);
    summary.doubtful_frames += share > kDoubtfulShare ? 1 : 0;
    if (share > summary.worst_share) {
        summary.worst_share = share;
        summary.worst_frame = frame;
    }
}

std::string in_words(const MirrorOptics& optics, const OpticsErrors& error) {
    const auto with_error = [](const char* name, double value, double std, int digits) {
        std::string words = fmt::format("{} {:.{}f}", name, value, digits);
        if (std > 0) words += fmt::format(" ± {:.{}f}", std, digits);
        return words;
    };
    return fmt::format("{}, {} a, {}, {}",
                       with_error("reflectivity F0", optics.reflectivity, error.reflectivity, 3),
                       with_error("blur", optics.blur, error.blur, 4),
                       with_error("ambient", optics.ambient, error.ambient, 3),
                       with_error("grazing", optics.grazing, error.grazing, 3));
}

void warn_of(const SynthesisSummary& summary, RunPlan& plan) {
    if (summary.doubtful_frames > 0) {
        plan.warn(WarningCode::doubtful_heights,
                  fmt::format("in {} of {} frames synthesis leaves more than {:.0f} % of the "
                              "spheres doubtful, worst frame {}: {:.1f} %; image and rendering "
                              "still differ there (column quality). Are track.sphere-diameter and "
                              "the height of the cell right, and the spheres mirrors?",
                              summary.doubtful_frames, summary.frames, 100 * kDoubtfulShare,
                              summary.worst_frame, 100 * summary.worst_share));
    }
    if (summary.risen_frames > 0) {
        plan.warn(WarningCode::doubtful_heights,
                  fmt::format("synthesis did not converge in {} of {} frames: image and rendering "
                              "differ no less at its end than at its start",
                              summary.risen_frames, summary.frames));
    }
    if (summary.unexplained_frames > 0) {
        plan.warn(WarningCode::doubtful_heights,
                  fmt::format("in {} of {} frames the rendering leaves more than {:.0f} % of the "
                              "contrast, white noise apart ({:.1f} % at most): errors may not "
                              "hold. Unless the camera smooths its noise: are "
                              "track.sphere-diameter, the height of the cell and the distance of "
                              "the camera right, kept optics those of this film, and the spheres "
                              "mirrors above a bright panel?",
                              summary.unexplained_frames, summary.frames, 100 * kMostUnexplained,
                              100 * summary.most_unexplained));
    }
    if (2 * summary.heights_known < summary.spheres) {
        plan.warn(WarningCode::doubtful_heights,
                  fmt::format("only {} of {} heights are known to {:.1f} a: crystals, and few "
                              "pixels a sphere, tell less. x and y have errors of their own",
                              summary.heights_known, summary.spheres, kMostHeightError));
    }
    if (summary.unscaled_frames > 0) {
        plan.warn(
            WarningCode::unscaled_errors,
            fmt::format("errors in {} of {} frames are those of the fit alone, and may be two "
                        "to three times too small: fewer than {} spheres of the first frame "
                        "stand where the errors of this film can be learned. Show more "
                        "spheres in it, or begin with another frame (frames)",
                        summary.unscaled_frames, summary.frames, ErrorScale::kLeast));
    }
}

void transfer(NumberArchive& archive, MirrorOptics& optics) {
    auto& [reflectivity, blur, ambient, grazing, distance, middle_x, middle_y, reflections] =
        optics;
    archive.members<MirrorOptics>(reflectivity, blur, ambient, grazing, distance, middle_x,
                                  middle_y, reflections);
}

void transfer(NumberArchive& archive, OpticsErrors& error) {
    auto& [reflectivity, blur, ambient, grazing] = error;
    archive.members<OpticsErrors>(reflectivity, blur, ambient, grazing);
}

void transfer(NumberArchive& archive, FilmOptics& film) {
    auto& [diameter, height, optics, error, error_scale] = film;
    archive.members<FilmOptics>(diameter, height, optics, error, error_scale);
}

void transfer(NumberArchive& archive, SynthesisedFrame& found) {
    auto& [position, error, z, z_error, residual, optics, optics_error, error_scale,
           residual_before, residual_rms, unexplained, added, removed, lifted, doubtful] = found;
    archive.members<SynthesisedFrame>(position, error, z, z_error, residual, optics, optics_error,
                                      error_scale, residual_before, residual_rms, unexplained,
                                      added, removed, lifted, doubtful);
}

void transfer(NumberArchive& archive, SynthesisSummary& summary) {
    auto& [frames, spheres, doubtful, heights_known, added, removed, lifted, residual_before,
           residual_rms, doubtful_frames, risen_frames, unexplained_frames, most_unexplained,
           unscaled_frames, worst_frame, worst_share, optics, optics_error] = summary;
    archive.members<SynthesisSummary>(
        frames, spheres, doubtful, heights_known, added, removed, lifted, residual_before,
        residual_rms, doubtful_frames, risen_frames, unexplained_frames, most_unexplained,
        unscaled_frames, worst_frame, worst_share, optics, optics_error);
}

}  // namespace grainfield::tracking
