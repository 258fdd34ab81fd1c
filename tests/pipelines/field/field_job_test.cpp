#include "pipelines/field/field_job.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/h5/field_file.h"
#include "tests/pipelines/interrupted_run.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

namespace fs = std::filesystem;

FieldJobOptions small(const std::string& output) {
    FieldJobOptions options;
    options.output = output;
    options.resume.every = std::chrono::seconds(0);
    options.field.lattice.nx = 64;
    options.field.model.nu = 0.1;
    options.field.record = {.relax = 200, .record = 2000, .sample = 10, .store = 500};
    return options;
}

FieldJobResult run(const FieldJobOptions& options) {
    Job job;
    return run_field(options, job);
}

void expect_same(const fs::path& a, const fs::path& b) {
    io::FieldFile one(a), other(b);
    ASSERT_EQ(one.count(), other.count());
    for (std::int64_t i = 0; i < one.count(); ++i) {
        EXPECT_EQ(one.read(i).density.front().value, other.read(i).density.front().value) << i;
    }
    ASSERT_EQ(one.statistics().size(), other.statistics().size());
    for (std::size_t o = 0; o < one.statistics().size(); ++o) {
        const auto& mine = one.statistics()[o].measurements;
        const auto& theirs = other.statistics()[o].measurements;
        ASSERT_EQ(mine.size(), theirs.size());
        for (std::size_t m = 0; m < mine.size(); ++m) {
            EXPECT_EQ(mine[m].value, theirs[m].value);
            EXPECT_EQ(mine[m].error.has_value(), theirs[m].error.has_value());
            if (!mine[m].error || !theirs[m].error) continue;
            // A block that was summed in two parts is rounded otherwise.
            EXPECT_NEAR(*mine[m].error, *theirs[m].error, 1e-9 * *theirs[m].error) << mine[m].name;
        }
    }
}

TEST(FieldJob, ThatWasInterruptedEndsInTheSameBits) {
    const testing::ScratchFolder folder;
    FieldJobOptions options = small(folder / "stopped.h5");
    EXPECT_EXIT(testing::interrupt_once_saved(options.output, [&] { return run(options).signal; }),
                ::testing::ExitedWithCode(130), "");
    ASSERT_TRUE(fs::exists(folder / "stopped.h5.checkpoint"));
    EXPECT_THROW(run(options), OutputError) << "not begun anew without being told to";
    options.resume.resume = true;
    const FieldJobResult resumed = run(options);
    EXPECT_EQ(folder.entries(), 1U) << "the output alone";
    const FieldJobResult whole = run(small(folder / "whole.h5"));
    EXPECT_EQ(resumed.steps, whole.steps);
    expect_same(folder / "stopped.h5", folder / "whole.h5");
}

TEST(FieldJob, OfAnotherModelDoesNotGoOnFromACheckpoint) {
    const testing::ScratchFolder folder;
    FieldJobOptions options = small(folder / "stopped.h5");
    EXPECT_EXIT(testing::interrupt_once_saved(options.output, [&] { return run(options).signal; }),
                ::testing::ExitedWithCode(130), "");
    options.resume.resume = true;
    options.field.model.nu = 0.2;
    EXPECT_THAT([&] { run(options); },
                ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("model.nu")));
    // The recording may become longer.
    options.field.model.nu = 0.1;
    options.field.record.record = 4000;
    EXPECT_EQ(run(options).steps, 8400) << "200 + 4000 in steps of 0.5";
    FieldJobOptions whole = small(folder / "whole.h5");
    whole.field.record.record = 4000;
    run(whole);
    expect_same(options.output, whole.output);
}

TEST(FieldJob, StoresFieldsOnScheduleWithWhatTheyAre) {
    const testing::ScratchFolder folder;
    const FieldJobOptions options = small(folder / "run.h5");
    const FieldJobResult result = run(options);
    EXPECT_LT(result.mass_drift, 1e-3);
    io::FieldFile file(options.output);
    EXPECT_EQ(file.count(), 4) << "every 500 of 2000";
    EXPECT_EQ(file.read(0).density.front().nx, 64);
    ASSERT_TRUE(file.identity().control);
    EXPECT_EQ(file.identity().control->value, 0.1);
    EXPECT_EQ(file.identity().gradient_order, 4);
}

}  // namespace
}  // namespace grainfield::pipelines
