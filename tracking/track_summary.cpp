#include "tracking/track_summary.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/fit_quality.h"

namespace grainfield::tracking {
namespace {

/// A change of the contrast that is said [1].
constexpr double kNotableLight = 0.05;

}  // namespace

void judge(const Located& found, const Frame& frame, TrackSummary& summary,
           RepeatedWarnings& repeated, RunPlan& plan) {
    summary.residual_rms += found.residual_rms;
    summary.noise += found.noise;
    summary.unsettled += found.unsettled;
    summary.rejected += found.rejected;
    summary.strict_frames += found.doubtful_are_false ? 1 : 0;
    summary.mended += found.mended;
    if (!found.settled_detection) {
        plan.warn("some frames still gained or lost spheres when the search was ended");
    }
    if (static_cast<double>(found.unsettled) > 1e-3 * static_cast<double>(found.position.size())) {
        plan.warn(
            "in some frames more than 0.1 % of the spheres still moved after the last "
            "sweep (refine.max-sweeps)");
    }
    if (found.position.empty()) {
        repeated.add(frame.index, "no spheres found");
    } else if (fit_quality(found.residual_rms, found.noise) == FitQuality::poor) {
        ++summary.poor_frames;
        if (found.residual_rms > summary.worst_residual) {
            summary.worst_residual = found.residual_rms;
            summary.worst_frame = frame.index;
        }
    }
}

void add(const Located& found, FrameWork& work) {
    ++work.frames;
    work.discs += static_cast<double>(found.fitted.size());
    work.disc_updates += static_cast<double>(found.steps + found.coarse_steps);
    work.joint_steps += found.joint_steps;
    work.gain_maps += found.passes - found.maps_skipped;
    work.trials += static_cast<double>(found.trials);
    work.trials_kept += static_cast<double>(found.trials_kept);
}

void average(TrackSummary& summary, double particles, const LinkSummary& links) {
    const double n = std::max<double>(1, static_cast<double>(summary.frames));
    summary.particles_mean = particles / n;
    summary.residual_rms /= n;
    summary.noise /= n;
    for (double* t :
         {&summary.ms_per_frame.read, &summary.ms_per_frame.detect, &summary.ms_per_frame.refine,
          &summary.ms_per_frame.synthesis, &summary.ms_per_frame.link, &summary.ms_per_frame.write,
          &summary.ms_per_frame.wall}) {
        *t /= n;
    }
    FrameWork& work = summary.work_per_frame;
    for (double* sum : {&work.discs, &work.disc_updates, &work.joint_steps, &work.gain_maps,
                        &work.trials, &work.trials_kept}) {
        *sum /= std::max(1.0, work.frames);
    }
    if (links.consecutive > 0) {
        summary.step_rms = std::sqrt(links.squared_steps / static_cast<double>(links.consecutive));
    }
}

void warn_of(const TrackSummary& summary, RunPlan& plan) {
    if (summary.rejected > 0) {
        plan.warn(
            fmt::format("{} positions left out in {} frames: they had not settled to within "
                        "their own error",
                        summary.rejected, summary.frames));
    }
    if (summary.poor_frames > 0) {
        plan.warn(fmt::format(
            "the image model explains {} of {} frames badly, worst frame {}: RMS residual {:.2f} "
            "of the contrast (0.02 to 0.08 is usual); look at the overlay in the report. Walls, "
            "liquid "
            "levels and dust in one place: leave them out with option 'region' or option 'mask'. "
            "Circles that do not fit: calibrate.polarity, calibrate.disc-diameter and "
            "calibrate.edge-width",
            summary.poor_frames, summary.frames, summary.worst_frame, summary.worst_residual));
    }
    const Bilayer::Summary& layers = summary.layers;
    if (const std::int64_t n = layers.rejected_pairs + layers.rejected_triples; n > 0) {
        plan.warn(fmt::format(
            "{} detections left out: no room for them between the plates ({} in pairs, {} in "
            "triples){}",
            n, layers.rejected_pairs, layers.rejected_triples,
            layers.is_exact ? "" : "; perhaps not the fewest possible"));
    }
    if (layers.contradictory > 0) {
        plan.warn(fmt::format(
            "overlaps of {} positions contradict each other: their layers are unknown. Of all, {} "
            "of {} are unknown. Is layers.height or track.sphere-diameter wrong, or a sphere "
            "false?",
            layers.contradictory, layers.spheres - layers.labelled, layers.spheres));
    }
    warn_of(summary.synthesis, plan);
    if (summary.repeated > 0) {
        plan.warn(fmt::format("{} frames repeat the one before", summary.repeated));
    }
    if (summary.dimmest < 1 - kNotableLight || summary.brightest > 1 + kNotableLight) {
        plan.warn(fmt::format(
            "the contrast varies between {:.2f} and {:.2f} of the first frame's; it was followed",
            summary.dimmest, summary.brightest));
    }
}

}  // namespace grainfield::tracking
