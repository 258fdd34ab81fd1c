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
        EXPECT_EQ(run({"export", tracks, "-o", folder_ / "x.csv", "--force"}).code, 0);
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
