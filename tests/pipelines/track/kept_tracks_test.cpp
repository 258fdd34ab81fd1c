#include "pipelines/track/kept_tracks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

using ::testing::HasSubstr;

Snapshot snapshot(std::int64_t frame, std::vector<Vec2> position) {
    Snapshot s;
    s.frame = frame;
    s.time = static_cast<double>(frame);
    s.box = {.origin = {-0.5, -0.5}, .length = {50, 40}};
    for (std::size_t i = 0; i < position.size(); ++i) s.id.push_back(static_cast<std::int64_t>(i));
    s.position = std::move(position);
    return s;
}

class Kept : public ::testing::Test {
 protected:
    OutputFile output() { return {path_, Overwrite::force}; }

    testing::ScratchFolder folder_;
    const std::string path_ = folder_ / "t.h5";
};

TEST_F(Kept, TracksOfARegionStandWhereTheyAreInTheWholeFrame) {
    KeptTracks tracks(output(), {}, {10, 20}, nullptr);
    tracks.write(snapshot(0, {{1, 2}, {3, 4}}));
    tracks.write(snapshot(1, {{1.5, 2}}));
    Frame picture;
    picture.image = Image(4, 4, 1);
    tracks.add_preview(picture, snapshot(0, {{1, 2}}));
    EXPECT_EQ(tracks.frames(), 2);
    EXPECT_DOUBLE_EQ(tracks.particles_mean(), 1.5);
    tracks.finish({});
    io::TrajectoryFile file(path_);
    EXPECT_EQ(file.read(0).position, (std::vector<Vec2>{{11, 22}, {13, 24}}));
    EXPECT_EQ(file.read(0).box.origin, (Vec2{9.5, 19.5}));
    ASSERT_EQ(file.previews().size(), 1U);
    EXPECT_EQ(file.previews()[0].snapshot.position, (std::vector<Vec2>{{11, 22}}));
    EXPECT_EQ(file.previews()[0].snapshot.box.origin, (Vec2{9.5, 19.5}));
}

TEST_F(Kept, ReplayOfALogWritesTheSameFileAgain) {
    io::RecordLog records(folder_ / "t.snapshots", 0);
    io::SnapshotLog log(records);
    {
        KeptTracks interrupted(output(), {}, {}, &log);
        interrupted.write(snapshot(0, {{1, 2}}));
        interrupted.write(snapshot(3, {{2, 2}, {5, 5}}));
    }
    EXPECT_FALSE(std::filesystem::exists(path_)) << "nothing was finished";
    KeptTracks tracks(output(), {}, {}, &log);
    tracks.replay();
    EXPECT_EQ(tracks.frames(), 2);
    EXPECT_EQ(log.count(), 2) << "nothing is logged twice";
    tracks.finish({});
    io::TrajectoryFile file(path_);
    ASSERT_EQ(file.count(), 2);
    EXPECT_EQ(file.read(1).frame, 3);
    EXPECT_EQ(file.read(1).position, (std::vector<Vec2>{{2, 2}, {5, 5}}));
}

TEST_F(Kept, PreviewsShowWhatWasWrittenAndOnlyFramesThatWere) {
    KeptTracks tracks(output(), {}, {}, nullptr);
    Frame picture;
    picture.image = Image(4, 4, 1);
    tracks.add_preview(picture, snapshot(0, {{1, 1}, {2, 2}}));
    picture.index = 5;
    tracks.add_preview(picture, snapshot(5, {{1, 1}}));
    tracks.write(snapshot(0, {{1, 1}}));  // the other track was too short
    tracks.finish({});
    io::TrajectoryFile file(path_);
    ASSERT_EQ(file.previews().size(), 1U);
    EXPECT_EQ(file.previews()[0].snapshot.size(), 1U);
}

TEST_F(Kept, TheLastActKeepsTheFramesThatAreWritten) {
    Job job;
    Resumable resumable(job, {.kind = "track", .output = path_, .log = "", .configuration = {}},
                        {});
    LastAct act(job, resumable);
    EXPECT_THAT(act(), HasSubstr("error: tracking interrupted in the first frame"));
    KeptTracks tracks(output(), {}, {}, nullptr);
    act.holds(&tracks, job);
    EXPECT_THAT(act(), HasSubstr("was not written"));
    tracks.write(snapshot(0, {{1, 2}}));
    tracks.write(snapshot(1, {{1, 2}}));
    EXPECT_THAT(act(), HasSubstr("warning: interrupted within a frame; '" + path_ +
                                 "' holds the 2 frames before it"));
    io::TrajectoryFile file(path_);
    EXPECT_EQ(file.count(), 2);
    ASSERT_EQ(file.record().warnings.size(), 1U);
    EXPECT_THAT(file.record().warnings[0].text, HasSubstr("2 frames before it"));
}

TEST_F(Kept, TheLastActSaysHowToGoOnInTheWordsOfTheCaller) {
    Job job;
    job.plan = RunPlan([](std::string text) {
        const auto at = text.find("option 'resume'");
        return at == std::string::npos ? text : text.replace(at, 15, "--resume");
    });
    Resumable resumable(job, {.kind = "track", .output = path_, .log = "", .configuration = {}},
                        {});
    resumable.start();
    resumable.save({});
    KeptTracks tracks(output(), {}, {}, nullptr);
    LastAct act(job, resumable);
    act.holds(&tracks, job);
    tracks.write(snapshot(0, {{1, 2}}));
    EXPECT_THAT(act(), HasSubstr("holds the 1 frame before it; --resume goes on from there"));
}

}  // namespace
}  // namespace grainfield::pipelines
