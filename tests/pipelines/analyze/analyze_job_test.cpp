#include "pipelines/analyze/analyze_job.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/h5/results_file.h"
#include "io/h5/trajectory_file.h"
#include "tests/io/h5/cut_off_run.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

constexpr int kSide = 20;  // particles of a row, a apart

/// A square lattice in two frames.
std::string write_lattice(const testing::ScratchFolder& folder) {
    std::string path = folder / "lattice.csv";
    std::ofstream table(path);
    table << "frame,particle,x,y\n";
    for (int f = 0; f < 2; ++f) {
        for (int i = 0; i < kSide * kSide; ++i) {
            table << f << ',' << i << ',' << i % kSide << ',' << i / kSide << '\n';
        }
    }
    return path;
}

AnalyzeJobOptions periodic(const std::string& output) {
    AnalyzeJobOptions options;
    options.output = output;
    options.adjustment.box_length = Vec2{kSide, kSide};
    options.adjustment.boundary = Boundary::periodic;
    options.adjustment.particle_diameter = 1;
    options.analysis.observables = {"q4", "variance"};
    return options;
}

TEST(AnalyzeJob, MeasuresATableOfPointsAndWritesWhatItReturns) {
    const testing::ScratchFolder folder;
    Job job;
    job.inputs = {write_lattice(folder)};
    const AnalyzeJobOptions options = periodic(folder / "r.h5");
    const Results results = run_analysis(options, job);
    EXPECT_EQ(results.frames, 2);
    EXPECT_EQ(results.particles_mean, 400);
    EXPECT_NEAR(*results.find("q4")->find_measurement("q4_mean")->value, 1, 1e-12);
    EXPECT_EQ(results.find("sk"), nullptr) << "not asked for";
    EXPECT_EQ(results.label, "lattice") << "nothing else is known of it";
    ASSERT_EQ(results.previews.size(), 2U) << "both frames: a tracker would keep three";
    EXPECT_EQ(results.previews[0].snapshot.frame, 0);
    EXPECT_EQ(results.previews[1].snapshot.frame, 1);
    EXPECT_EQ(results.previews[0].abs_q4.size(), 400U);
    const Results file = io::read_results(options.output);
    EXPECT_EQ(file.find("q4")->find_measurement("q4_mean")->value,
              results.find("q4")->find_measurement("q4_mean")->value);
    EXPECT_EQ(job.outputs, std::vector<std::filesystem::path>{options.output});
}

TEST(AnalyzeJob, MeasuresTheFramesThatAreAskedFor) {
    const testing::ScratchFolder folder;
    io::TrajectoryWriter writer(folder / "t.h5", {}, Overwrite::force);
    for (int f = 0; f < 6; ++f) {
        Snapshot snapshot;
        snapshot.frame = 3 * f;  // some are missing
        snapshot.time = 3 * f;
        snapshot.box.length = {100, 100};
        for (int i = 0; i <= f; ++i) snapshot.position.push_back({10.0 * i + 5, 50});
        writer.write(snapshot);
    }
    writer.finish({});
    Job job;
    job.inputs = {folder / "t.h5"};
    AnalyzeJobOptions options;
    options.output = folder / "r.h5";
    options.analysis.observables = {"q4"};
    options.frames = "2::2";
    const Results results = run_analysis(options, job);
    EXPECT_EQ(results.frames, 2);
    EXPECT_EQ(results.particles_mean, 4) << "3 of frame 6 and 5 of frame 12";
    ASSERT_EQ(results.previews.size(), 2U);
    EXPECT_EQ(results.previews.back().snapshot.frame, 12);
    EXPECT_EQ(results.previews.back().snapshot.time, 12);
    EXPECT_THAT(job.plan.text(), ::testing::HasSubstr("2 of 6 snapshots: 2 to 4 in steps of 2"));
    options.frames = "6:";
    options.output = folder / "none.h5";
    EXPECT_THAT([&] { run_analysis(options, job); },
                ::testing::ThrowsMessage<OptionError>(::testing::HasSubstr("within 0:6")));
    EXPECT_EQ(folder.entries(), 2U) << "no output is begun";
}

TEST(AnalyzeJob, ShowsOfTheFramesThatTheTrackerKeptThoseThatAreAskedFor) {
    const testing::ScratchFolder folder;
    io::TrajectoryWriter writer(folder / "t.h5", {}, Overwrite::force);
    for (int f = 0; f < 6; ++f) {
        Preview preview;
        preview.snapshot.frame = preview.frame.index = f;
        preview.snapshot.time = f;
        preview.snapshot.box.length = {100, 100};
        preview.snapshot.position = {{50, 50}};
        preview.frame.image = Image(4, 4);
        writer.write(preview.snapshot);
        if (f % 2 == 0) writer.add_preview(preview);
    }
    writer.finish({});
    Job job;
    job.inputs = {folder / "t.h5"};
    AnalyzeJobOptions options;
    options.output = folder / "r.h5";
    options.analysis.observables = {"q4"};
    options.frames = "1:4";
    const Results results = run_analysis(options, job);
    ASSERT_EQ(results.previews.size(), 1U);
    EXPECT_EQ(results.previews.front().snapshot.frame, 2);
    options.frames = "::4";
    options.output = folder / "steps.h5";
    const Results steps = run_analysis(options, job);
    ASSERT_EQ(steps.previews.size(), 2U) << "frame 2 was kept, too, but not measured";
    EXPECT_EQ(steps.previews.back().snapshot.frame, 4);
    EXPECT_EQ(steps.label, "t, frames in steps of 4");
}

TEST(AnalyzeJob, LeavesOutOfASpanWhatTheRunWroteOfItself) {
    const testing::ScratchFolder folder;
    io::TrajectoryWriter writer(folder / "t.h5", {}, Overwrite::force);
    for (int f = 0; f < 4; ++f) {
        Snapshot snapshot;
        snapshot.frame = f;
        snapshot.time = f;
        snapshot.box.length = {100, 100};
        snapshot.position = {{50, 50}};
        writer.write(snapshot);
    }
    writer.add_curve({"md", "", {{"t", "-", "", {0, 1}}, {"energy", "-", "", {1, 2}}}, {}});
    writer.finish({});
    const auto has_series = [&](const std::string& frames, const std::string& output) {
        Job job;
        job.inputs = {folder / "t.h5"};
        AnalyzeJobOptions options;
        options.output = folder / output;
        options.analysis.observables = {"q4"};
        options.frames = frames;
        return run_analysis(options, job).find("series") != nullptr;
    };
    EXPECT_TRUE(has_series("::", "whole.h5"));
    EXPECT_FALSE(has_series("2:", "span.h5"));
}

TEST(AnalyzeJob, NeedsThePeriodsOfAPeriodicTable) {
    const testing::ScratchFolder folder;
    Job job;
    job.inputs = {write_lattice(folder)};
    AnalyzeJobOptions options = periodic(folder / "r.h5");
    options.adjustment.box_length.reset();
    EXPECT_THROW(plan_analysis(options, job), OptionError);
    EXPECT_THROW(run_analysis(options, job), OptionError);
    EXPECT_EQ(folder.entries(), 1U) << "no output is begun";
}

TEST(AnalyzeJob, RepeatsTheWarningsOfATrackThatStillHold) {
    const testing::ScratchFolder folder;
    TrajectoryInfo info;
    info.length_unit = LengthUnit::pixel;
    info.diameter = 8;
    io::TrajectoryWriter writer(folder / "t.h5", info, Overwrite::force);
    Snapshot snapshot;
    snapshot.box.length = {100, 100};
    snapshot.position = {{10, 10}, {30, 40}};
    writer.write(snapshot);
    RunRecord record;
    record.command = "track";
    record.warnings = {{WarningCode::apparent_diameter, "lengths are in D"},
                       {WarningCode::other, "frame 3 is corrupt"}};
    writer.finish(record);
    const auto warnings_with = [&](std::optional<double> diameter) {
        Job job;
        job.inputs = {folder / "t.h5"};
        AnalyzeJobOptions options;
        options.output = folder / "r.h5";
        options.adjustment.particle_diameter = diameter;
        plan_analysis(options, job);
        return job.plan.warnings();
    };
    const Warning apparent{WarningCode::apparent_diameter, "lengths are in D"};
    const Warning corrupt{WarningCode::other, "frame 3 is corrupt"};
    EXPECT_THAT(warnings_with(std::nullopt), ::testing::Contains(apparent));
    EXPECT_THAT(warnings_with(9.0), ::testing::Not(::testing::Contains(apparent)));
    EXPECT_THAT(warnings_with(std::nullopt), ::testing::Not(::testing::Contains(corrupt)));
}

TEST(AnalyzeJob, WarnsOfTheFramesThatAKilledRunDidNotFinish) {
    const testing::ScratchFolder folder;
    Job job;
    job.inputs = {io::write_cut_off_run(folder)};
    AnalyzeJobOptions options;
    options.output = folder / "r.h5";
    plan_analysis(options, job);
    EXPECT_THAT(job.plan.warnings(),
                ::testing::Contains(::testing::AllOf(
                    ::testing::Field(&Warning::code, WarningCode::incomplete),
                    ::testing::Field(&Warning::text,
                                     ::testing::HasSubstr("3 of its 4 frames are left out")))));
}

}  // namespace
}  // namespace grainfield::pipelines
