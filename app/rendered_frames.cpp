#include "app/rendered_frames.h"

#include <utility>

namespace grainfield::app {

RenderedFrames::RenderedFrames(SnapshotSource& trajectory, const Box& box,
                               const simulate::RenderOptions& options, std::uint64_t seed,
                               int threads, RunPlan& plan)
    : trajectory_(trajectory),
      options_(options),
      seed_(seed),
      threads_(threads),
      renderer_(options, trajectory.info(), box, seed, threads, plan),
      info_(renderer_.truth_info()) {
    last_.index = -1;
}

void RenderedFrames::render(std::int64_t index) {
    const Snapshot snapshot = trajectory_.read(index);
    std::optional<Snapshot> next;
    if (snapshot.velocity.empty() && index + 1 < count()) next = trajectory_.read(index + 1);
    simulate::RenderedFrame rendered = renderer_.render(snapshot, index, next ? &*next : nullptr);
    if (rendered.frame.status == FrameStatus::ok) ++rendered_;
    last_ = std::move(rendered.frame);
    last_.index = index;
    rendered.truth.frame = index;
    if (truth_.contains(index)) return;  // rendered again
    ids_.renumber(rendered.truth);
    truth_[index] = std::move(rendered.truth);
}

simulate::SamplingCheck RenderedFrames::check_sampling() {
    const Snapshot first = trajectory_.read(0);
    std::optional<Snapshot> next;
    if (first.velocity.empty() && count() > 1) next = trajectory_.read(1);
    return simulate::check_sampling(options_, renderer_.view(), trajectory_.info(), first,
                                    next ? &*next : nullptr, seed_, threads_);
}

Frame RenderedFrames::read(std::int64_t index) {
    if (last_.index != index) render(index);
    return last_;
}

const Snapshot& RenderedFrames::truth(std::int64_t index) {
    if (!truth_.contains(index)) render(index);
    return truth_.at(index);
}

}  // namespace grainfield::app
