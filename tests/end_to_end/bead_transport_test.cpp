// `grainfield track` on a real film (provenance in its README): black beads among transparent ones,
// most at rest, some rolling over them; skipped when it is not there.
#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/vec2.h"
#include "tests/support/csv_rows.h"

namespace grainfield {
namespace {

const std::filesystem::path kFilm =
    std::filesystem::path(GRAINFIELD_SOURCE_DIR) / "../shared/data/bead_transport";
constexpr int kFrames = 10;
constexpr double kDiameter = 28;  // [px]

struct Bead {
    Vec2 position;
    std::string name;
    bool is_black = true;

    /// All of it is in the picture.
    bool is_whole() const {
        const double r = kDiameter / 2;
        return position.x >= r && position.y >= r && position.x <= 1279 - r &&
               position.y <= 319 - r;
    }
};
using Film = std::vector<std::vector<Bead>>;

Film film_of(const std::string& path, const char* x, const char* y) {
    Film film(kFrames);
    for (auto& row : testing::csv_rows(path)) {
        film.at(std::stoul(row["frame"]))
            .push_back({{std::stod(row[x]), std::stod(row[y])},
                        row["particle"],
                        !row.contains("kind") || row["kind"] == "black"});
    }
    return film;
}

const Bead* within_3_px(const std::vector<Bead>& beads, Vec2 place) {
    const auto found = std::ranges::find_if(beads, [&](const Bead& bead) {
        return bead.is_black && squared_norm(bead.position - place) <= 9;
    });
    return found == beads.end() ? nullptr : &*found;
}

TEST(BeadTransport, FindsTheBlackBeadsAndKeepsTheirIdentities) {
    if (!std::filesystem::exists(kFilm)) GTEST_SKIP() << "no " << kFilm;
    const testing::ScratchFolder folder;
    std::vector<std::string> words{"track", "-o",         folder / "t.h5", "--diameter",
                                   "28",    "--polarity", "dark"};
    for (int i = 0; i < kFrames; ++i) words.push_back(kFilm / fmt::format("frame{:03}.tif", i));
    const testing::Outcome outcome = testing::run_grainfield(words);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    ASSERT_EQ(testing::run_grainfield({"export", folder / "t.h5", "-o", folder / "t.csv"}).code, 0);
    const Film truth = film_of(kFilm / "truth.csv", "x_px", "y_px");
    const Film found = film_of(folder / "t.csv", "x", "y");

    int whole = 0;
    int missed = 0;
    int wrong = 0;
    int switches = 0;
    std::map<std::string, std::string> track_of;
    for (int f = 0; f < kFrames; ++f) {
        const auto i = static_cast<std::size_t>(f);
        for (const Bead& bead : truth[i]) {
            if (!bead.is_black) continue;
            const Bead* match = within_3_px(found[i], bead.position);
            whole += bead.is_whole();
            missed += bead.is_whole() && match == nullptr;
            if (match == nullptr) continue;
            const auto [known, is_new] = track_of.emplace(bead.name, match->name);
            switches += known->second != match->name;
            known->second = match->name;
        }
        for (const Bead& bead : found[i]) {
            wrong += bead.is_whole() && within_3_px(truth[i], bead.position) == nullptr;
        }
    }
    EXPECT_GT(whole, 2900);
    EXPECT_EQ(missed, 0);
    EXPECT_EQ(wrong, 0);
    EXPECT_EQ(switches, 0);
}

// Bright discs of 6 px would explain more of the frame, with more coordinates than it can show.
TEST(BeadTransport, TheBlackBeadsAreFoundWithoutAWord) {
    if (!std::filesystem::exists(kFilm)) GTEST_SKIP() << "no " << kFilm;
    const testing::ScratchFolder folder;
    const testing::Outcome outcome =
        testing::run_grainfield({"track", kFilm / "frame000.tif", "-o", folder / "t.h5"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("spheres    dark, diameter 28.1"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("weighed    dark D = 28.1 px"), std::string::npos) << outcome.out;
}

}  // namespace
}  // namespace grainfield
