// What dropped frames do to identities: what missing frames of a film do.

#include <algorithm>
#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/progress.h"
#include "io/video/live_frames.h"
#include "tests/support/collect.h"
#include "tests/support/disc_stream.h"
#include "tests/support/fifo.h"
#include "tests/support/scratch_folder.h"
#include "tracking/tracker.h"

namespace grainfield {
namespace {

constexpr int opening = 10;  // frames that are never dropped
constexpr int queue = 10;

struct LiveRun {
    std::vector<Snapshot> snapshots;
    tracking::TrackSummary summary;
};

/// Tracks frames 0 to 9 and the last ten; so many between them are dropped.
LiveRun run_with_gap(int dropped, const tracking::TrackOptions& options) {
    std::signal(SIGPIPE, SIG_IGN);
    const testing::ScratchFolder folder;
    testing::Fifo fifo(folder / "camera");
    const int all = opening + dropped + queue;
    std::thread writer([&] {
        testing::write_disc_stream(fifo, all);
        fifo.close();
    });
    io::LiveOptions live;
    live.source = fifo.path();
    live.queue = queue;
    const auto source = io::open_live(live);
    writer.join();
    for (int i = 0; i < 3000 && source->counts().captured < all; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_EQ(source->counts().dropped, dropped);
    RunPlan plan;
    tracking::Tracker tracker(*source, options, plan);
    testing::Collect sink;
    Progress progress("tracking", 0, "frames", Verbosity::quiet);
    LiveRun run;
    run.summary = tracker.run(sink, progress);
    run.snapshots = std::move(sink.snapshots);
    EXPECT_EQ(run.summary.frames, opening + queue);
    EXPECT_EQ(run.summary.frames_missing, dropped);
    EXPECT_EQ(run.snapshots.at(opening).frame, opening + dropped);
    return run;
}

/// How many of the spheres after the gap have the identity of one before it.
std::int64_t kept_identities(const LiveRun& run) {
    const std::vector<std::int64_t>& before = run.snapshots.at(opening - 1).id;
    return std::ranges::count_if(run.snapshots.at(opening).id, [&](std::int64_t id) {
        return std::ranges::find(before, id) != before.end();
    });
}

TEST(LiveTracks, DroppedFramesWithinTheMemoryKeepIdentities) {
    tracking::TrackOptions options;
    options.link.memory = 2;
    const LiveRun run = run_with_gap(2, options);
    EXPECT_EQ(kept_identities(run), std::ssize(run.snapshots.at(opening - 1).id));
}

TEST(LiveTracks, MoreDroppedFramesThanTheMemoryEndAllTracks) {
    tracking::TrackOptions options;
    options.link.memory = 2;
    EXPECT_EQ(kept_identities(run_with_gap(3, options)), 0);
    EXPECT_EQ(kept_identities(run_with_gap(300, options)), 0);
}

TEST(LiveTracks, PredictorsKnowHowManyFramesWereDropped) {
    tracking::TrackOptions options;
    options.link.memory = 60;
    options.link.search_range = 4;  // discs move by 0.36 px a frame
    options.link.predictor = tracking::Predictor::drift;
    const LiveRun run = run_with_gap(20, options);
    const std::int64_t seen = std::ssize(run.snapshots.at(opening).id);
    ASSERT_GT(seen, 100) << "some left the frame";
    EXPECT_EQ(kept_identities(run), seen)
        << "they moved by 7.6 px in all, each to where the drift leads";
}

}  // namespace
}  // namespace grainfield
