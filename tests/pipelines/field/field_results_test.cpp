#include "pipelines/field/field_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "pipelines/field/field_job.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

using ::testing::HasSubstr;

class FieldResults : public ::testing::Test {
 protected:
    FieldResults() {
        FieldJobOptions options;
        options.output = path_;
        options.field.lattice.nx = 64;
        options.field.model.nu = 0.1;
        options.field.record = {.relax = 200, .record = 2000, .sample = 10, .store = 500};
        Job job;
        run_field(options, job);  // 4 fields are stored
    }
    Results results(const FieldChoice& choice) const {
        Job job;
        return field_results(path_, choice, {}, job);
    }

    testing::ScratchFolder folder_;
    const std::string path_ = folder_ / "run.h5";
};

double first_s(const Results& results) {
    const Curve* sk = results.find("sk")->find_curve("sk");
    return sk->find("s")->values.front();
}

TEST_F(FieldResults, OfChosenFieldsAreOfThoseAlone) {
    const Results all = results({FieldSamples::stored, "::"});
    const Results early = results({FieldSamples::stored, ":2"});
    const Results late = results({FieldSamples::stored, "2:"});
    EXPECT_EQ(all.frames, 4);
    EXPECT_EQ(early.frames, 2);
    EXPECT_NE(first_s(early), first_s(late));
    EXPECT_NEAR(0.5 * (first_s(early) + first_s(late)), first_s(all), 1e-12 * first_s(all));
}

TEST_F(FieldResults, ThatTheRunAccumulatedAreOfAllItsSamples) {
    EXPECT_EQ(results({FieldSamples::accumulated, "::"}).frames, 4);
    EXPECT_THAT(
        [&] {
            results({FieldSamples::accumulated, "2:"});
        },
        ::testing::ThrowsMessage<OptionError>(HasSubstr("from-fields")));
    RunPlan plan;
    EXPECT_THROW(plan_field_results(path_, {FieldSamples::accumulated, "2:"}, plan), OptionError);
    plan_field_results(path_, {FieldSamples::stored, "2:"}, plan);
    EXPECT_THAT(plan.text(), HasSubstr("2 of 4"));
}

}  // namespace
}  // namespace grainfield::pipelines
