#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;
using testing::with;

/// One long film in parts, as on the nodes of a cluster.
class FilmParts : public ::testing::Test {
 protected:
    std::vector<std::string> track(const std::string& output,
                                   const std::vector<std::string>& words) const {
        return with(
            with({"track", "-o", output, "--stretch", "4", "--sphere-diameter", "10"}, words),
            film_);
    }
    static Outcome run(std::vector<std::string> words) {
        return testing::run_grainfield(std::move(words));
    }
    std::string exported(const std::string& tracks) const {
        EXPECT_EQ(
            run({"export", tracks, "-o", folder_ / "x.csv", "--force", "--digits", "all"}).code, 0);
        return testing::read_all(folder_ / "x.csv");
    }

    testing::ScratchFolder frames_, folder_;
    const std::vector<std::string> film_ = testing::write_disc_sequence(frames_, 10);
    const std::string a_ = folder_ / "a.h5", b_ = folder_ / "b.h5", whole_ = folder_ / "whole.h5",
                      film_file_ = folder_ / "film.h5";
};

TEST_F(FilmParts, TrackedApartAndLinkedAreTheFilmInOnePiece) {
    ASSERT_EQ(run(track(whole_, {})).code, 0);
    ASSERT_EQ(run(track(b_, {"--no-link", "--frames", "6:"})).code, 0);
    ASSERT_EQ(run(track(a_, {"--no-link", "--frames", "0:6"})).code, 0);
    const Outcome linked = run({"link", b_, a_, "-o", film_file_, "--json"});
    ASSERT_EQ(linked.code, 0) << linked.err;
    const auto summary = nlohmann::json::parse(linked.out);
    EXPECT_EQ(summary["parts"], 2);
    EXPECT_EQ(summary["frames"], 10);
    EXPECT_EQ(exported(film_file_), exported(whole_));
    const Outcome analysed =
        run({"analyze", film_file_, "-o", folder_ / "r.h5", "--observables", "msd"});
    EXPECT_EQ(analysed.code, 0) << analysed.err;
}

TEST_F(FilmParts, AnalysedApartAndMergedAreTheAnalysisInOnePiece) {
    const std::vector<std::string> what{"--observables", "sk,variance", "--largest", "8"};
    const auto analyze = [&](std::vector<std::string> words, const std::string& output) {
        words.insert(words.begin(), "analyze");
        return run(with(with(words, what), {"-o", output, "--json"}));
    };
    ASSERT_EQ(run(track(whole_, {})).code, 0);
    ASSERT_EQ(run(track(b_, {"--no-link", "--frames", "6:"})).code, 0);
    ASSERT_EQ(run(track(a_, {"--no-link", "--frames", "0:6"})).code, 0);
    for (const std::string& part : {a_, b_}) {
        const Outcome partial = analyze({part, "--partial"}, part + ".acc");
        ASSERT_EQ(partial.code, 0) << partial.err;
    }
    const Outcome merged = analyze({"--merge", b_ + ".acc", a_ + ".acc"}, folder_ / "merged.h5");
    ASSERT_EQ(merged.code, 0) << merged.err;
    const Outcome whole = analyze({whole_}, folder_ / "results.h5");
    ASSERT_EQ(whole.code, 0) << whole.err;
    const auto expected = nlohmann::json::parse(whole.out);
    const auto found = nlohmann::json::parse(merged.out);
    EXPECT_EQ(found["frames"], 10);
    EXPECT_EQ(found["particles_mean"], expected["particles_mean"]);
    for (const char* name : {"sk", "variance"}) {
        const auto& list = expected[name]["measurements"];
        ASSERT_EQ(found[name]["measurements"].size(), list.size());
        ASSERT_GT(list.size(), 0u);
        for (std::size_t i = 0; i < list.size(); ++i) {
            for (const char* key : {"value", "error"}) {
                if (!list[i].contains(key)) continue;
                const double value = list[i][key];
                EXPECT_NEAR(found[name]["measurements"][i][key].get<double>(), value,
                            1e-8 * std::max(1.0, std::abs(value)))
                    << name << " " << list[i]["name"] << " " << key;
            }
        }
    }
    const Outcome missing = analyze({"--merge", b_ + ".acc"}, folder_ / "x.h5");
    EXPECT_EQ(missing.code, 3);
    EXPECT_THAT(missing.err, HasSubstr("b.h5.acc' has frames 6 to 9"));
    const Outcome linked = analyze({whole_, "--partial"}, folder_ / "x.acc");
    EXPECT_EQ(linked.code, 3);
    EXPECT_THAT(linked.err, HasSubstr("is not a part of a film"));
    const Outcome some = analyze({a_, "--partial", "--frames", "2:"}, folder_ / "x.acc");
    EXPECT_EQ(some.code, 2);
    EXPECT_THAT(some.err, HasSubstr("a part of a film is analysed as a whole"));
    EXPECT_EQ(
        analyze({"--merge", a_ + ".acc", b_ + ".acc", "--frames", "2:"}, folder_ / "x.h5").code, 2);
    const Outcome other =
        analyze({"--merge", a_ + ".acc", b_ + ".acc", "--boundary", "periodic"}, folder_ / "x.h5");
    EXPECT_EQ(other.code, 2);
    EXPECT_THAT(other.err, HasSubstr("merged as they were measured"));
    const Outcome otherwise =
        analyze({"--merge", a_ + ".acc", b_ + ".acc", "--sk-k-max", "1"}, folder_ / "x.h5");
    EXPECT_EQ(otherwise.code, 3);
    EXPECT_THAT(otherwise.err, HasSubstr("a.h5.acc' was measured with other options"));
    const Outcome tracks = analyze({"--merge", a_, b_}, folder_ / "x.h5");
    EXPECT_EQ(tracks.code, 3);
    EXPECT_THAT(tracks.err, HasSubstr("a.h5': it is no part of an analysis"));
    EXPECT_EQ(analyze({a_, b_}, folder_ / "x.h5").code, 2) << "two inputs are not merged unasked";
}

TEST_F(FilmParts, AMissingPartIsNamedWithItsFramesAndLeavesNoFile) {
    ASSERT_EQ(run(track(b_, {"--no-link", "--frames", "6:"})).code, 0);
    const Outcome linked = run({"link", b_, "-o", film_file_});
    EXPECT_EQ(linked.code, 3);
    EXPECT_THAT(linked.err, HasSubstr("b.h5' has frames 6 to 9, and no part has frames 0 to 5"));
    EXPECT_THAT(linked.err, HasSubstr("--allow-gaps"));
    EXPECT_FALSE(std::filesystem::exists(film_file_));
    EXPECT_EQ(run({"link", b_, "-o", film_file_, "--allow-gaps"}).code, 0);
}

}  // namespace
}  // namespace grainfield
