#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/frame.h"
#include "core/run_plan.h"
#include "core/trajectory.h"
#include "simulate/render/motion/grain_motion.h"
#include "simulate/render/optics/optics.h"
#include "simulate/render/projection.h"
#include "simulate/render/render_options.h"
#include "simulate/render/sensor/camera.h"

namespace grainfield::simulate {

/// A frame and what is in it.
struct RenderedFrame {
    Frame frame;  ///< status `missing` and no image where the camera lost it
    /// Every sphere whose centre lies in the frame: mean position over the exposure [px], id, z and
    /// velocity (where known) [px, px/s], layer (by the mid height). Copies of a grain across a
    /// periodic boundary have id + k · (largest id + 1), k = 1 … 8. Empty `id` if the trajectory
    /// has none.
    Snapshot truth;
    int sub_frames = 1;
};

/// Renders the snapshots of one trajectory: scene → optics → camera.
///
/// During an exposure T centred on the snapshot spheres fly as grain_motion says: on parabolas,
/// through a collision between two snapshots, where velocities are known; else along the chords
/// between snapshots; on the parabola of the one snapshot if no others are given. The image is the
/// mean over n sub-frames at the midpoints of n equal parts, n as large as needed for steps below a
/// quarter pixel (three rms speeds), at most `sub_frames`.
///
/// The plates stand still: a plane-parallel plate displaces a ray by the same wherever it is, so
/// that only what the plates mirror would move (docs/render.md: by how much).
///
/// Heights come from z, else from the layer (either plate touched), else the low plate. Where the
/// time unit is "frame" and no frame rate is known, or a is not known in millimetres per unit,
/// exposures have no length.
///
/// Same options, seed and snapshot → same bytes for any number of threads. Not thread-safe.
class Renderer {
 public:
    /// `box`: of the first snapshot. Says in the plan what is skipped. Throws OptionError.
    Renderer(const RenderOptions& options, const TrajectoryInfo& info, const Box& box,
             std::uint64_t seed, int threads, RunPlan& plan);

    /// Frame number `index` of the rendered series. Throws OptionError if the frame shows more than
    /// three periods of a periodic box.
    RenderedFrame render(const SnapshotSeries& series, std::int64_t index);
    RenderedFrame render(const Snapshot& snapshot, std::int64_t index) {
        return render(SnapshotSeries{{&snapshot, 1}, 0}, index);
    }
    /// RenderedFrame::truth alone, in a thousandth of the time.
    Snapshot truth(const SnapshotSeries& series, std::int64_t index) const;

    /// How far on either side of a snapshot its exposure reaches [time unit of the trajectory].
    double half_exposure() const;
    /// A step of more than half of this between two frames is a periodic boundary crossed: the
    /// frame or the period, whichever is shorter [px].
    Vec2 crossing_span(const Box& box) const;
    /// Flights in all exposures so far.
    const FlightTally& flights() const { return flights_; }

    /// Whether render(…, index) will return a lost frame.
    bool loses(std::int64_t index) const;
    /// Pixels, seconds (frames where no clock is known), origin `rendered`.
    TrajectoryInfo truth_info() const;
    /// Seconds per time unit of the trajectory; 0 if unknown.
    double seconds_per_unit() const { return seconds_per_unit_; }

    const View& view() const { return view_; }
    const Camera& camera() const { return camera_; }
    OpticsCost cost() const { return optics_->cost(); }

 private:
    std::vector<SphereScene> scenes_at(const GrainMotion& motion, const Box& box,
                                       const std::vector<double>& instants) const;
    struct Exposure {
        GrainMotion motion;
        std::vector<double> instants;
        View view;
    };
    Exposure exposure_of(const SnapshotSeries& series, std::int64_t index) const;
    Snapshot truth_of(const Snapshot& snapshot, const Exposure& exposure, std::int64_t index) const;
    std::vector<double> instants_of(const GrainMotion& motion) const;

    RenderOptions options_;
    TrajectoryInfo info_;
    double height_;  // of the cell [a]
    double seconds_per_unit_;
    std::uint64_t seed_;
    View view_;
    Camera camera_;
    std::unique_ptr<Optics> optics_;
    FlightTally flights_;
};

/// The exposure T in seconds; 0 where the trajectory has no clock.
double shutter_seconds(const RenderOptions& options, double seconds_per_unit);

}  // namespace grainfield::simulate
