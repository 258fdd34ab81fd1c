// Every conversation about taking up a run again: md, field and track share it.
#include "pipelines/resumable.h"

#include <filesystem>
#include <fstream>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/version.h"
#include "io/h5/checkpoint_file.h"
#include "io/h5/trajectory_file.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr ResumeOptions kAnew{.resume = false, .every = std::chrono::hours(1)};
constexpr ResumeOptions kResume{.resume = true, .every = std::chrono::hours(1)};

Checkpoint state() {
    Checkpoint checkpoint;
    checkpoint.kind = "test";
    checkpoint.reals["state"] = {2.5};
    return checkpoint;
}

class ResumableJob : public ::testing::Test {
 protected:
    Resumable::Identity identity(const std::string& nu = "0.01") const {
        return {.kind = "test",
                .output = output_,
                .log = ".records",
                .configuration = {{"model.nu", nu}, {"seed", "1"}}};
    }
    bool has(const char* suffix) const { return fs::exists(output_ + suffix); }

    /// A run that stored five records, was saved after three, and was killed.
    void leave_killed_run() {
        Job job;
        Resumable run(job, identity(), kAnew);
        run.start();
        for (double i = 0; i < 5; ++i) {
            if (i == 3) run.save(state());
            run.log().append({i, 10 * i});
        }
    }
    std::string refusal(const Resumable::Identity& wanted) {
        Job job;
        try {
            const Resumable run(job, wanted, kResume);
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    }

    testing::ScratchFolder folder_;
    const std::string output_ = folder_ / "out.h5";
};

// A failed run goes on with another cure and nothing else; what was changed is told by this run and
// by all that go on from it.
TEST_F(ResumableJob, GoesOnAfterAFailureWithACureAndSaysSoEverAfter) {
    const auto curable = [&](const std::string& step, const std::string& nu = "0.01") {
        Resumable::Identity id = identity(nu);
        id.configuration.emplace_back("run.step", step);
        id.cures = {"run.step"};
        return id;
    };
    {
        Job job;
        Resumable run(job, curable("1"), kAnew);
        run.start();
        run.log().append({1.0});
        run.log().append({2.0});
        run.save_failed(state(), 1, "it broke");
    }
    EXPECT_THAT(refusal(curable("1")), AllOf(HasSubstr("it broke"), HasSubstr("another run.step")));
    EXPECT_THAT(refusal(curable("2", "0.02")), HasSubstr("model.nu: 0.01 in the checkpoint"));
    const auto told = ::testing::ElementsAre(::testing::Field(
        &Warning::text, "goes on after a failure with run.step = 2, 1 before: it broke"));
    {
        Job job;
        Resumable run(job, curable("2"), kResume);
        EXPECT_THAT(job.plan.warnings(), told);
        run.start();
        EXPECT_EQ(run.log().count(), 1) << "what the state vouches for";
        run.save(state());
    }
    EXPECT_THAT(refusal(curable("3")), HasSubstr("run.step: 2 in the checkpoint"))
        << "it has not failed again";
    Job job;
    const Resumable run(job, curable("2"), kResume);
    EXPECT_THAT(job.plan.warnings(), told);
}

TEST_F(ResumableJob, GoesOnWithTheStateAndTheRecordsThatTheCheckpointVouchesFor) {
    leave_killed_run();
    Job job;
    Resumable run(job, identity(), kResume);
    ASSERT_NE(run.from(), nullptr);
    EXPECT_EQ(run.from()->reals.at("state"), std::vector<double>{2.5});
    EXPECT_NO_THROW(run.require_free());
    EXPECT_EQ(run.overwrite(), Overwrite::force) << "its own output, if it was just completed";
    run.start();
    ASSERT_EQ(run.log().count(), 3);
    EXPECT_EQ(run.log().read(2), (std::vector<double>{2, 20}));
    run.finish();
    EXPECT_EQ(folder_.entries(), 0U);
}

/// A job whose output, a trajectory, is complete.
class CompleteJob : public ResumableJob {
 protected:
    CompleteJob() {
        job_.command = "simulate md";
        job_.configuration = {{"model.nu", "0.01"}, {"run.periods", "40"}};
        io::TrajectoryWriter writer(output_, {}, Overwrite::refuse);
        Snapshot snapshot;
        snapshot.position = {{1, 2}};
        snapshot.box.length = {4, 4};
        writer.write(snapshot);
        writer.finish(job_.record());
    }
    Resumable::Identity complete() const {
        Resumable::Identity wanted = identity();
        wanted.record = output_;
        return wanted;
    }

    Job job_;
};

TEST_F(CompleteJob, SaysThatThereIsNothingToDo) {
    try {
        const Resumable run(job_, complete(), kResume);
        FAIL() << "taken for an unfinished one";
    } catch (const AlreadyComplete& done) {
        EXPECT_THAT(done.what(), HasSubstr("out.h5: complete already, nothing to do"));
    }
    EXPECT_NO_THROW(Resumable(job_, complete(), kAnew)) << "not asked to resume";
    EXPECT_NO_THROW(Resumable(job_, identity(), kResume)) << "no output says who made it";
    job_.overwrite = Overwrite::force;
    EXPECT_NO_THROW(Resumable(job_, complete(), kResume)) << "begins anew";
}

TEST_F(CompleteJob, IsTheSameWhateverOptionsAreThatItDoesNotDependOn) {
    job_.configuration.emplace_back("threads", "7");
    EXPECT_THROW(Resumable(job_, complete(), kResume), InputError);
    job_.indifferent = {"threads"};
    EXPECT_THROW(Resumable(job_, complete(), kResume), AlreadyComplete);
}

TEST_F(CompleteJob, IsToldFromOneCutShortByTheCodeOfAWarningAlone) {
    const auto write = [&](WarningCode code) {
        Job made = job_;
        made.plan.warn(code, "interrupted after 3 of 40 periods");
        io::TrajectoryWriter writer(output_, {}, Overwrite::force);
        Snapshot snapshot;
        snapshot.position = {{1, 2}};
        snapshot.box.length = {4, 4};
        writer.write(snapshot);
        writer.finish(made.record());
    };
    write(WarningCode::interrupted);
    EXPECT_NO_THROW(Resumable(job_, complete(), kResume));
    write(WarningCode::other);
    EXPECT_THROW(Resumable(job_, complete(), kResume), AlreadyComplete);
}

TEST_F(CompleteJob, IsRefusedWithTheDifferenceIfItWasMadeOtherwise) {
    const auto refusal = [&] {
        try {
            const Resumable run(job_, complete(), kResume);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    job_.configuration[1].second = "80";
    EXPECT_THAT(refusal(),
                AllOf(HasSubstr("run.periods: 40 there, 80 now"), Not(HasSubstr("model.nu"))));
    job_.configuration[1].second = "40";
    job_.seed = 5;
    EXPECT_THAT(refusal(), HasSubstr("seed: 1 there, 5 now"));
    job_.seed = 1;
    job_.command = "track";
    EXPECT_THAT(refusal(), HasSubstr("command: simulate md there, track now"));
    job_.command = "simulate md";
    std::ofstream(folder_ / "input.txt") << "other";
    job_.inputs = {folder_ / "input.txt"};
    EXPECT_THAT(refusal(), HasSubstr("the content of its inputs"));
}

TEST_F(ResumableJob, VouchesForFewerRecordsIfAsked) {
    {
        Job job;
        Resumable run(job, identity(), kAnew);
        run.start();
        for (double i = 0; i < 4; ++i) run.log().append({i});
        run.save(state(), 1);
    }
    Job job;
    Resumable run(job, identity(), kResume);
    run.start();
    EXPECT_EQ(run.log().count(), 1);
}

TEST_F(ResumableJob, StartsFromTheBeginningWhereNothingIsToBeResumed) {
    Job job;
    Resumable run(job, identity(), kResume);
    EXPECT_EQ(run.from(), nullptr);
    EXPECT_NO_THROW(run.require_free());
    EXPECT_EQ(run.overwrite(), Overwrite::refuse) << "an output that is there is another run's";
    run.explain();
    ASSERT_EQ(job.plan.stages().size(), 2U);
    EXPECT_THAT(job.plan.stages()[0].reason, HasSubstr("starts from the beginning"));
    EXPECT_EQ(job.plan.stages()[1].reason, "every 60 min");
    EXPECT_TRUE(job.plan.warnings().empty()) << "the output is that of a run that was not resumed";
}

TEST_F(ResumableJob, KeepsAnInterruptedRunUnlessItMayBeReplaced) {
    leave_killed_run();
    Job job;
    Resumable refused(job, identity(), kAnew);
    try {
        refused.require_free();
        ADD_FAILURE() << "the checkpoint may be overwritten";
    } catch (const OutputError& error) {
        EXPECT_THAT(error.what(),
                    AllOf(HasSubstr("out.h5.checkpoint' exists: an interrupted run of"),
                          HasSubstr("'resume'"), HasSubstr("'force'")));
    }
    EXPECT_TRUE(has(".checkpoint"));
    job.overwrite = Overwrite::force;
    Resumable forced(job, identity(), kAnew);
    EXPECT_NO_THROW(forced.require_free());
    EXPECT_EQ(forced.from(), nullptr);
    EXPECT_TRUE(has(".checkpoint")) << "until the output is claimed";
    forced.start();
    EXPECT_FALSE(has(".checkpoint")) << "it must not outlive its records";
    EXPECT_EQ(forced.log().count(), 0);
}

TEST_F(ResumableJob, RefusesOtherOptionsWithTheDifference) {
    leave_killed_run();
    EXPECT_THAT(refusal(identity("0.5")), HasSubstr("model.nu: 0.01 in the checkpoint, 0.5 now"));
    EXPECT_TRUE(has(".checkpoint"));
    EXPECT_TRUE(has(".records"));
}

TEST_F(ResumableJob, RefusesAnotherVersionWithItsVersion) {
    leave_killed_run();
    Checkpoint old = io::read_checkpoint(output_ + ".checkpoint");
    old.texts["program version"] = {"0.0.7"};
    old.configuration.emplace_back("not.known", "any more");
    io::write_checkpoint(old, output_ + ".checkpoint");
    EXPECT_THAT(refusal(identity()), AllOf(HasSubstr("version 0.0.7 wrote it"), HasSubstr(kVersion),
                                           Not(HasSubstr("not.known"))));
    old.texts.clear();
    io::write_checkpoint(old, output_ + ".checkpoint");
    EXPECT_THAT(refusal(identity()), HasSubstr("it does not say which version wrote it"));
}

TEST_F(ResumableJob, RefusesAnotherKindAndDamage) {
    leave_killed_run();
    Resumable::Identity other = identity();
    other.kind = "md";
    EXPECT_THAT(refusal(other), HasSubstr("it is of kind 'test'"));
    fs::resize_file(output_ + ".checkpoint", 60);
    EXPECT_THAT(refusal(identity()), HasSubstr("out.h5.checkpoint"));
    std::ofstream(output_ + ".checkpoint") << "something else";
    EXPECT_THAT(refusal(identity()), HasSubstr("out.h5.checkpoint"));
}

TEST_F(ResumableJob, RefusesALogThatIsShorterThanTheCheckpointSays) {
    leave_killed_run();
    fs::resize_file(output_ + ".records", 8);
    Job job;
    Resumable run(job, identity(), kResume);
    EXPECT_THROW(run.start(), InputError);
}

TEST_F(ResumableJob, LeavesNothingIfItFailsBeforeItsFirstCheckpoint) {
    {
        Job job;
        Resumable run(job, identity(), kAnew);
        run.start();
        run.log().append({1});
        EXPECT_TRUE(has(".records"));
    }
    EXPECT_EQ(folder_.entries(), 0U);
}

TEST_F(ResumableJob, IsSavedWhenItIsTime) {
    Job job;
    Resumable seldom(job, identity(), kAnew);
    seldom.start();
    EXPECT_FALSE(seldom.is_due());
    Resumable::Identity other = identity();
    other.output = folder_ / "other.h5";
    Resumable always(job, other, {.resume = false, .every = std::chrono::seconds(0)});
    always.start();
    EXPECT_TRUE(always.is_due());
}

TEST_F(ResumableJob, SaysHowToGoOnOnceThatIsPossible) {
    Job job;
    Resumable run(job, identity(), kAnew);
    run.start();
    EXPECT_EQ(run.interrupted(3, 40, "frames").text, "interrupted after 3 of 40 frames");
    run.save(state());
    EXPECT_THAT(run.interrupted(2.5, 14, "periods").text,
                AllOf(HasSubstr("interrupted after 2.5 of 14 periods; "), HasSubstr("'resume'")));
    EXPECT_EQ(run.interrupted(2.5, 14, "periods").code, WarningCode::interrupted);
    const Resumable other(job, identity(), {.resume = true, .how = "the same command"});
    EXPECT_THAT(other.advice(), HasSubstr("the same command goes on from there"));
}

TEST_F(ResumableJob, WithoutAnOutputFindsNoCheckpointOfAnother) {
    const fs::path before = fs::current_path();
    fs::current_path(folder_.path());
    std::ofstream(".checkpoint") << "of no run";
    Job job;
    Resumable::Identity nameless = identity();
    nameless.output.clear();
    const Resumable run(job, nameless, kResume);
    fs::current_path(before);
    EXPECT_EQ(run.from(), nullptr);
}

TEST_F(ResumableJob, IsRecordedAsTheRunThatItCompletes) {
    leave_killed_run();
    Checkpoint saved = io::read_checkpoint(output_ + ".checkpoint");
    saved.reals["seconds"] = {3600};
    io::write_checkpoint(saved, output_ + ".checkpoint");
    Job job;
    Resumable run(job, identity(), kResume);
    run.start();
    EXPECT_GE(job.seconds(), 3600) << "its wall time adds up";
}

}  // namespace
}  // namespace grainfield::pipelines
