#include "pipelines/md/md_job.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/h5/trajectory_file.h"
#include "tests/pipelines/interrupted_run.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

namespace fs = std::filesystem;

MdJobOptions small(const std::string& output) {
    MdJobOptions options;
    options.output = output;
    options.order = true;
    options.resume.every = std::chrono::seconds(0);
    options.md.cell.grains = 300;
    options.md.cell.length_x = options.md.cell.length_y = 17.7;
    options.md.run.periods = 40;
    options.md.run.discard = 4;
    options.md.run.snapshot_every = 2;
    return options;
}

MdJobResult run(const MdJobOptions& options) {
    Job job;
    return run_md(options, job);
}

void expect_same(const fs::path& a, const fs::path& b) {
    io::TrajectoryFile one(a), other(b);
    ASSERT_EQ(one.count(), other.count());
    for (std::int64_t i = 0; i < one.count(); ++i) {
        EXPECT_EQ(one.read(i).position, other.read(i).position) << i;
        EXPECT_EQ(one.read(i).time, other.read(i).time) << i;
    }
    ASSERT_EQ(one.curves().size(), other.curves().size());
    for (std::size_t c = 0; c < one.curves().size(); ++c) {
        for (std::size_t k = 0; k < one.curves()[c].columns.size(); ++k) {
            EXPECT_EQ(one.curves()[c].columns[k].values, other.curves()[c].columns[k].values);
        }
    }
}

TEST(MdJob, ThatWasInterruptedEndsInTheSameBits) {
    const testing::ScratchFolder folder;
    MdJobOptions options = small(folder / "stopped.h5");
    EXPECT_EXIT(testing::interrupt_once_saved(options.output, [&] { return run(options).signal; }),
                ::testing::ExitedWithCode(130), "");
    ASSERT_TRUE(fs::exists(folder / "stopped.h5.checkpoint"));
    ASSERT_FALSE(fs::exists(options.output));
    EXPECT_THROW(run(options), OutputError) << "not begun anew without being told to";
    options.resume.resume = true;
    const MdJobResult resumed = run(options);
    EXPECT_DOUBLE_EQ(resumed.periods, 40);
    EXPECT_EQ(folder.entries(), 1U) << "the output alone";
    const MdJobResult whole = run(small(folder / "whole.h5"));
    EXPECT_EQ(resumed.events, whole.events) << "events before the resume count";
    expect_same(folder / "stopped.h5", folder / "whole.h5");
}

TEST(MdJob, WritesTheSnapshotsThatItsPlanAnnouncesAndTheTimeSeries) {
    const testing::ScratchFolder folder;
    const MdJobOptions options = small(folder / "run.h5");
    Job planned;
    plan_md(options, planned);
    EXPECT_THAT(planned.plan.text(), ::testing::HasSubstr("run  snapshots: 19, every 2 periods"));
    EXPECT_EQ(folder.entries(), 0U);
    const MdJobResult result = run(options);
    EXPECT_EQ(result.failure, "");
    io::TrajectoryFile file(options.output);
    EXPECT_EQ(file.count(), 19);
    EXPECT_EQ(result.snapshots, 19);
    EXPECT_EQ(file.read(18).size(), 300U);
    ASSERT_EQ(file.curves().size(), 2U);
    EXPECT_EQ(file.curves()[0].name, "order");
    EXPECT_EQ(file.curves()[0].find("q4_mean")->values.size(), 19U);
    EXPECT_EQ(file.curves()[1].find("t")->values.size(), 41U) << "a row a period and the start";
}

TEST(MdJob, StartsFromTheSnapshotOfAnotherRun) {
    const testing::ScratchFolder folder;
    run(small(folder / "first.h5"));
    MdJobOptions next = small(folder / "next.h5");
    next.start = folder / "first.h5";
    next.start_frame = 19;
    EXPECT_THROW(run(next), OptionError) << "the last is 18";
    next.start_frame = 5;
    next.md.run.discard = 0;
    run(next);
    io::TrajectoryFile first(folder / "first.h5"), second(folder / "next.h5");
    EXPECT_EQ(second.read(0).position, first.read(5).position);
}

}  // namespace
}  // namespace grainfield::pipelines
