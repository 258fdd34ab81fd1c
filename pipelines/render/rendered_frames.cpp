#include "pipelines/render/rendered_frames.h"

#include <utility>

namespace grainfield::pipelines {

RenderedFrames::RenderedFrames(SnapshotSource& trajectory, const Box& box,
                               const simulate::RenderOptions& options, std::uint64_t seed,
                               int threads, RunPlan& plan)
    : trajectory_(trajectory),
      window_(trajectory),
      options_(options),
      seed_(seed),
      threads_(threads),
      renderer_(options, trajectory.info(), box, seed, threads, plan),
      info_(renderer_.truth_info()),
      ids_(renderer_.crossing_span(box)) {
    last_.index = -1;
}

void RenderedFrames::render(std::int64_t index) {
    last_ = renderer_.render(window_.around(index, renderer_.half_exposure()), index).frame;
    if (last_.status == FrameStatus::ok) ++rendered_;
}

simulate::SamplingCheck RenderedFrames::check_sampling() {
    return simulate::check_sampling(options_, renderer_.view(), trajectory_.info(),
                                    window_.around(0, renderer_.half_exposure()), seed_, threads_);
}

Frame RenderedFrames::read(std::int64_t index) {
    if (last_.index != index) render(index);
    return last_;
}

// Crossings of a boundary are found in the order of the frames, in whatever order they are read.
Snapshot RenderedFrames::truth(std::int64_t index) {
    const double reach = renderer_.half_exposure();
    std::optional<Snapshot> truth;
    while (ids_.followed() <= index) {
        const std::int64_t next = ids_.followed();
        truth = renderer_.truth(window_.around(next, reach), next);
        ids_.follow(*truth);
    }
    if (!truth) truth = renderer_.truth(window_.around(index, reach), index);
    ids_.renumber(*truth, index);
    return *std::move(truth);
}

}  // namespace grainfield::pipelines
