// `grainfield track` with what a user knows of the picture: a region, a flat field, the cell.
#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/csv_rows.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

class TrackOptions : public ::testing::Test {
 protected:
    Outcome track(const std::string& frame, std::vector<std::string> more) {
        std::vector<std::string> words{"track", "--force", "--json", "-o", folder_ / "t.h5", frame};
        words.insert(words.end(), more.begin(), more.end());
        return run_grainfield(words);
    }

    /// Rows of the last run: column name → value.
    std::vector<std::map<std::string, std::string>> rows() {
        EXPECT_EQ(run_grainfield({"export", "--force", "--digits", "all", folder_ / "t.h5", "-o",
                                  folder_ / "t.csv"})
                      .code,
                  0);
        return testing::csv_rows(folder_ / "t.csv");
    }

    std::vector<Vec2> positions() {
        std::vector<Vec2> found;
        for (auto& row : rows()) found.push_back({std::stod(row["x"]), std::stod(row["y"])});
        return found;
    }

    ScratchFolder folder_;
};

double nearest(const std::vector<Vec2>& points, Vec2 p) {
    double least = 1e9;
    for (const Vec2 q : points) least = std::min(least, norm(q - p));
    return least;
}

TEST_F(TrackOptions, PositionsInARegionAreThoseOfTheWholeFrame) {
    const auto frames = testing::write_disc_sequence(folder_, 1);
    const Outcome outcome = track(frames[0], {"--region", "40,25,120,130"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const std::vector<Vec2> found = positions();
    int expected = 0;
    for (const Vec2 p : testing::few_discs().position) {
        const bool inside = p.x > 40 + 5 && p.x < 160 - 5 && p.y > 25 + 5 && p.y < 155 - 5;
        expected += inside;
        // Some 15 standard errors.
        if (!inside) continue;
        EXPECT_LT(nearest(found, p), 0.15);
    }
    EXPECT_GE(static_cast<int>(found.size()), expected);
    EXPECT_GT(expected, 30);
    for (const Vec2 p : found) {
        EXPECT_TRUE(p.x >= 39.5 && p.x <= 159.5 && p.y >= 24.5 && p.y <= 154.5);
    }
}

TEST_F(TrackOptions, UnitsOfTheLabAreStoredAndSaid) {
    const auto frames = testing::write_disc_sequence(folder_, 2);
    const auto run = [&](std::vector<std::string> more) {
        std::vector<std::string> words{"track", "--force", "-o", folder_ / "t.h5"};
        words.insert(words.end(), frames.begin(), frames.end());
        words.insert(words.end(), more.begin(), more.end());
        return run_grainfield(words);
    };
    const Outcome silent = run({});
    ASSERT_EQ(silent.code, 0) << silent.err;
    EXPECT_THAT(silent.out, AllOf(HasSubstr("give --fps"), HasSubstr("give --sphere-diameter")));
    const Outcome given = run({"--sphere-diameter", "11px", "--diameter-mm", "1mm", "--fps", "500",
                               "--vibration-frequency", "80Hz", "--amplitude-mm", "0.1"});
    ASSERT_EQ(given.code, 0) << given.err;
    EXPECT_THAT(given.out,
                AllOf(HasSubstr("500 frames a second, given"), HasSubstr("11 px a sphere, given"),
                      HasSubstr("1 px is 0.09091 mm"), HasSubstr("Γ = 2.576, 80 Hz, 0.1 mm")));
    const json info = json::parse(run_grainfield({"info", folder_ / "t.h5", "--json"}).out);
    EXPECT_EQ(info["sphere_mm"], 1);
    EXPECT_EQ(info["vibration"], "Γ = 2.576, 80 Hz, 0.1 mm");
    const Outcome analysis = run_grainfield(
        {"analyze", "--json", "--observables", "q4", folder_ / "t.h5", "-o", folder_ / "r.h5"});
    ASSERT_EQ(analysis.code, 0) << analysis.err;
    const json results = json::parse(run_grainfield({"info", folder_ / "r.h5", "--json"}).out);
    EXPECT_EQ(results["label"], "tracked, Γ = 2.576") << "the identity of the run went along";
    const Outcome page =
        run_grainfield({"compare", folder_ / "r.h5", "--no-figures", "-o", folder_ / "r.html"});
    ASSERT_EQ(page.code, 0) << page.err;
    EXPECT_THAT(testing::read_all(folder_ / "r.html"), HasSubstr("1 px is 0.0909 mm"));
    const Outcome contradiction =
        run({"--gamma", "3", "--frequency", "80", "--amplitude-mm", "0.1"});
    EXPECT_EQ(contradiction.code, 2);
    EXPECT_THAT(contradiction.err, AllOf(HasSubstr("--gamma: 3"), HasSubstr("0.1 mm: 2.576")));
}

TEST_F(TrackOptions, ARegionOutsideTheFrameIsRefused) {
    const auto frames = testing::write_disc_sequence(folder_, 1);
    const Outcome outcome = track(frames[0], {"--region", "100,0,120,100"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("192 x 192"));
}

TEST_F(TrackOptions, AFlatFieldTakesOutAnEdgeInTheLight) {
    // Half of the frame behind a grey filter: no smooth background can follow that.
    const auto scene = testing::few_discs();
    Image frame = testing::disc_frame(scene, 0);
    Image flat(frame.width(), frame.height(), 200);
    for (int y = 0; y < frame.height(); ++y) {
        for (int x = 0; x < frame.width() / 2; ++x) {
            frame(x, y) = std::round(0.5F * frame(x, y));
            flat(x, y) = 100;
        }
    }
    testing::write_png(folder_ / "frame.png", frame);
    testing::write_png(folder_ / "flat.png", flat);
    const Outcome plain = track(folder_ / "frame.png", {});
    const double residual_before =
        plain.code == 0 ? json::parse(plain.out)["residual_rms"].get<double>() : 1;
    const Outcome outcome = track(folder_ / "frame.png", {"--flat-field", folder_ / "flat.png"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_LT(json::parse(outcome.out)["residual_rms"], 0.6 * residual_before);
    const std::vector<Vec2> found = positions();
    EXPECT_EQ(found.size(), scene.position.size());
    for (const Vec2 p : scene.position) EXPECT_LT(nearest(found, p), 0.2);
}

/// A caption and a bright disc as large as three spheres, over the frame of few_discs(), and the
/// mask that hides both.
struct CoveredFrame {
    Image frame = testing::disc_frame(testing::few_discs(), 0);
    Image mask{testing::kPictureSize, testing::kPictureSize, 255};

    CoveredFrame() {
        for (int y = 0; y < frame.height(); ++y) {
            for (int x = 0; x < frame.width(); ++x) {
                const bool caption = y < 30 && x < 120;
                const bool stain = std::hypot(x - 130, y - 120) < 24;
                if (!caption && !stain) continue;
                mask(x, y) = 0;
                // Strokes as wide as a sphere; a stain darker than any.
                frame(x, y) = stain ? 0.0F : (x / 6 + y / 6) % 2 == 0 ? 255.0F : 10.0F;
            }
        }
    }
    /// Pixels from p to what is hidden.
    double clearance(Vec2 p) const {
        double least = 1e9;
        for (int y = 0; y < mask.height(); ++y) {
            for (int x = 0; x < mask.width(); ++x) {
                if (mask(x, y) == 0) least = std::min(least, norm(p - Vec2{1.0 * x, 1.0 * y}));
            }
        }
        return least;
    }
};

TEST_F(TrackOptions, WhatTheMaskHidesIsNotLookedAt) {
    const CoveredFrame covered;
    testing::write_png(folder_ / "frame.png", covered.frame);
    testing::write_png(folder_ / "mask.png", covered.mask);
    const auto count_false = [&](const std::vector<Vec2>& found) {
        return std::count_if(found.begin(), found.end(),
                             [](Vec2 p) { return nearest(testing::few_discs().position, p) > 1; });
    };
    const Outcome plain = track(folder_ / "frame.png", {"--diameter", "9", "--polarity", "dark"});
    ASSERT_TRUE(plain.code != 0 || count_false(positions()) > 5) << "nothing for a mask to do";

    const Outcome outcome = track(folder_ / "frame.png", {"--mask", folder_ / "mask.png"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const std::vector<Vec2> found = positions();
    EXPECT_EQ(count_false(found), 0);
    int expected = 0;
    for (const Vec2 p : testing::few_discs().position) {
        const double clearance = covered.clearance(p);
        // Of spheres cut in half positions are known less well.
        if (clearance > 9) {
            ++expected;
            EXPECT_LT(nearest(found, p), 0.2) << p.x << ' ' << p.y;
        }
        if (clearance < 1) {
            EXPECT_GT(nearest(found, p), 3) << "a sphere behind the mask";
        }
    }
    EXPECT_GT(expected, 60);
    // The noise of the picture, nothing of the caption.
    EXPECT_LT(json::parse(outcome.out)["residual_rms"], 0.03);
    EXPECT_NEAR(json::parse(outcome.out)["diameter_px"].get<double>(), 9, 0.1);

    const Outcome plan =
        track(folder_ / "frame.png", {"--mask", folder_ / "mask.png", "--explain"});
    EXPECT_THAT(plan.out, HasSubstr("of the pixels are not looked at"));
}

TEST_F(TrackOptions, AMaskIsOfTheWholeFrameAlsoWithARegion) {
    const CoveredFrame covered;
    testing::write_png(folder_ / "frame.png", covered.frame);
    testing::write_png(folder_ / "mask.png", covered.mask);
    const Outcome outcome =
        track(folder_ / "frame.png", {"--mask", folder_ / "mask.png", "--region", "8,10,180,170"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const std::vector<Vec2> found = positions();
    EXPECT_GT(found.size(), 50U);
    for (const Vec2 p : found) {
        EXPECT_LT(nearest(testing::few_discs().position, p), 1) << p.x << ' ' << p.y;
        EXPECT_GT(covered.clearance(p), 2) << p.x << ' ' << p.y;
    }
}

TEST_F(TrackOptions, AMaskOfAnotherSizeOrWithoutAnyLightIsRefused) {
    const auto frames = testing::write_disc_sequence(folder_, 1);
    testing::write_png(folder_ / "small.png", Image(64, 64, 255));
    const Outcome small = track(frames[0], {"--mask", folder_ / "small.png"});
    EXPECT_EQ(small.code, 3);
    EXPECT_THAT(small.err, HasSubstr("it has 64 x 64 px"));
    EXPECT_THAT(small.err, HasSubstr("192 x 192 px"));
    testing::write_png(folder_ / "black.png", Image(192, 192, 0));
    const Outcome black = track(frames[0], {"--mask", folder_ / "black.png"});
    EXPECT_EQ(black.code, 3);
    EXPECT_THAT(black.err, HasSubstr("leaves nothing to look at"));
    testing::write_png(folder_ / "white.png", Image(192, 192, 1));
    const Outcome white = track(frames[0], {"--mask", folder_ / "white.png", "--explain"});
    EXPECT_EQ(white.code, 0) << white.err;
    EXPECT_THAT(white.out, HasSubstr("is nowhere zero"));
}

/// A film of a liquid seen through a dirty window: 25 specks of the size of spheres that let 30 %
/// of the light pass, and a scratch.
struct DirtyFilm {
    static constexpr int kSize = 192;
    std::vector<testing::LayerScene> scenes;
    Image window{kSize, kSize, 1};

    explicit DirtyFilm(int frames) {
        for (int i = 0; i < frames; ++i) {
            scenes.push_back(testing::hard_disc_liquid(kSize, kSize, 10, 0.35,
                                                       static_cast<std::uint64_t>(i + 1)));
        }
        for (int y = 0; y < kSize; ++y) {
            for (int x = 0; x < kSize; ++x) {
                const double r = std::hypot(x % 38 - 19.3, y % 38 - 18.6);
                const double speck = 0.7 / (1 + std::exp(2 * (r - 4.5) / 1.25));
                const double scratch = std::abs(x - 0.7 * y - 40) < 1.5 ? 0.3 : 0;
                window(x, y) = static_cast<float>((1 - speck) * (1 - scratch));
            }
        }
    }

    Image frame(int i) const {
        Image image =
            testing::tanh_frame(scenes[static_cast<std::size_t>(i)], testing::kApparentDiameter,
                                testing::kEdgeWidth, 0.02, static_cast<std::uint64_t>(i));
        return behind_window(std::move(image));
    }
    /// What comes from the core of a sphere, 30 counts, does not pass the window.
    Image behind_window(Image image) const {
        for (int y = 0; y < kSize; ++y) {
            for (int x = 0; x < kSize; ++x) {
                image(x, y) = std::round(30 + window(x, y) * (image(x, y) - 30));
            }
        }
        return image;
    }
    std::vector<std::string> write(const testing::ScratchFolder& folder) const {
        std::vector<std::string> paths;
        for (int i = 0; i < static_cast<int>(scenes.size()); ++i) {
            paths.push_back(folder / ("dirty_" + std::to_string(1000 + i) + ".png"));
            testing::write_png(paths.back(), frame(i));
        }
        testing::write_png(folder / "empty.png", behind_window(Image(kSize, kSize, 200)));
        return paths;
    }
};

class DirtyWindow : public TrackOptions {
 protected:
    struct Errors {
        int missed = 0, wrong = 0, spheres = 0;
        double squares = 0;
        std::string skipped, warnings;
    };
    Errors errors(const DirtyFilm& film, std::vector<std::string> more) {
        std::vector<std::string> words = film.write(folder_);
        words.insert(words.end(), more.begin(), more.end());
        const std::string first = words.front();
        words.erase(words.begin());
        const Outcome outcome = track(first, words);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        std::vector<std::vector<Vec2>> found(film.scenes.size());
        for (auto& row : rows()) {
            found[std::stoul(row["frame"])].push_back({std::stod(row["x"]), std::stod(row["y"])});
        }
        Errors e;
        const json summary = json::parse(outcome.out);
        e.skipped = summary["skipped"].dump();
        e.warnings = summary["warnings"].dump();
        for (std::size_t f = 0; f < found.size(); ++f) {
            for (const Vec2 p : film.scenes[f].position) {
                const double d = nearest(found[f], p);
                ++e.spheres;
                if (d < 2) e.squares += d * d;
                e.missed += d >= 2;
            }
            for (const Vec2 p : found[f]) e.wrong += nearest(film.scenes[f].position, p) >= 2;
        }
        return e;
    }
};

TEST_F(DirtyWindow, DirtIsTakenForSpheresUnlessTheBackgroundOfTheFilmIsKnown) {
    const DirtyFilm film(48);
    const Errors none = errors(film, {});
    EXPECT_GT(none.wrong, 300) << "nothing to do for --background";
    for (const std::string& kind :
         {std::string("static"), std::string("running"), folder_ / "empty.png"}) {
        const Errors evened = errors(film, {"--background", kind, "--background-window", "40"});
        EXPECT_EQ(evened.wrong, 0) << kind;
        EXPECT_EQ(evened.missed, 0) << kind;
        EXPECT_GT(evened.spheres, 5000);
        const double rms = std::sqrt(evened.squares / (2 * evened.spheres));
        const double before = std::sqrt(none.squares / (2 * none.spheres));
        EXPECT_LT(rms, 0.5 * before) << kind;
        RecordProperty("rmse_" + kind.substr(0, 7), std::to_string(rms));
    }
}

TEST_F(DirtyWindow, SpheresAtRestAreNotPartOfTheBackground) {
    DirtyFilm film(30);
    film.window = Image(DirtyFilm::kSize, DirtyFilm::kSize, 1);
    for (auto& scene : film.scenes) scene = testing::few_discs();
    const Errors plain = errors(film, {});
    const Errors evened = errors(film, {"--background", "static"});
    EXPECT_EQ(evened.wrong, 0);
    EXPECT_EQ(evened.missed, plain.missed);
    EXPECT_NEAR(evened.squares, plain.squares, 0.05 * plain.squares);
    EXPECT_THAT(evened.warnings, HasSubstr("are never clear"));
}

TEST_F(DirtyWindow, AFilmShorterThanTheWindowSaysThatItsBackgroundIsStatic) {
    const auto frames = testing::write_disc_sequence(folder_, 12);
    const std::vector<std::string> others(frames.begin() + 1, frames.end());
    for (const bool is_long : {false, true}) {
        const Outcome outcome =
            track(frames[0], testing::with(others, {"--background", "running", "--explain",
                                                    "--background-window", is_long ? "10" : "12"}));
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_THAT(outcome.out,
                    HasSubstr(is_long ? "running: " : "static (film shorter than the window): "));
    }
}

TEST_F(DirtyWindow, ARepeatedFrameIsNotFittedAgainWithARunningBackground) {
    const auto paths = DirtyFilm(24).write(folder_);
    for (const int i : {8, 9, 17}) {
        std::filesystem::copy_file(paths[static_cast<std::size_t>(i - 1)],
                                   paths[static_cast<std::size_t>(i)],
                                   std::filesystem::copy_options::overwrite_existing);
    }
    const Outcome outcome =
        track(paths[0], testing::with({paths.begin() + 1, paths.end()},
                                      {"--background", "running", "--background-window", "20"}));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(json::parse(outcome.out)["repeated_frames"], 3);
}

TEST_F(DirtyWindow, OneFrameHasNoBackgroundOfItsOwn) {
    const auto frames = testing::write_disc_sequence(folder_, 1);
    const Outcome outcome = track(frames[0], {"--background", "static", "--explain"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("fewer than three frames"));
}

TEST_F(TrackOptions, TheHeightOfTheCellNamesLayers) {
    testing::CrystalPatch patch;
    patch.radius = 0.3;
    const auto scene = testing::crystal_in_liquid(320, 320, 14, 0.6, patch, 3);
    testing::write_png(folder_ / "frame.png", testing::camera_frame(scene, {}, 1));
    const Outcome outcome =
        track(folder_ / "frame.png", {"--height", "1.94", "--sphere-diameter", "14"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json layers = json::parse(outcome.out)["layers"];
    EXPECT_EQ(layers["contradictory"], 0);
    EXPECT_EQ(layers["rejected_pairs"], 0);
    int right = 0;
    int labelled = 0;
    for (auto& row : rows()) {
        if (row["layer"].empty()) continue;
        const Vec2 p{std::stod(row["x"]), std::stod(row["y"])};
        for (std::size_t i = 0; i < scene.position.size(); ++i) {
            if (norm(scene.position[i] - p) > 3) continue;
            if (scene.layer[i] == Layer::unknown) continue;
            ++labelled;
            right += std::stoi(row["layer"]) == static_cast<int>(scene.layer[i]);
        }
    }
    const auto crystal = static_cast<int>(scene.position.size() - scene.crystal_begin);
    EXPECT_GT(labelled, 9 * crystal / 10);
    // One cluster, the right way up or upside down.
    EXPECT_TRUE(right == 0 || right == labelled) << right << " of " << labelled;
}

TEST_F(TrackOptions, TheHeightIsOfNoUseWithoutTheDiameter) {
    const auto frames = testing::write_disc_sequence(folder_, 1);
    const Outcome outcome = track(frames[0], {"--height", "1.94"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--sphere-diameter"));
}

TEST_F(TrackOptions, SynthesisGivesHeightsOpticsAndTheirErrors) {
    const std::string frame = GRAINFIELD_SOURCE_DIR "/data-samples/traced-layer.png";
    const Outcome unknown = track(frame, {"--synthesis"});
    EXPECT_EQ(unknown.code, 2);
    EXPECT_THAT(unknown.err, HasSubstr("give --sphere-diameter"));

    const Outcome outcome =
        track(frame, {"--synthesis", "--sphere-diameter", "10.09", "--height", "1.94", "--searches",
                      "0", "--region", "120,120,100,100"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json found = json::parse(outcome.out).at("synthesis");
    EXPECT_LT(found.at("residual_rms").get<double>(), found.at("residual_before").get<double>());
    EXPECT_GT(found.at("optics").at("reflectivity").get<double>(), 0.3);
    EXPECT_GT(found.at("ms_per_frame").get<double>(), 0);
    const auto table = rows();
    EXPECT_GT(table.size(), 50U);
    for (auto row : table) {
        // The centre lies a/2 or more within the plates.
        EXPECT_GE(std::stod(row["z"]), 0.5 * 10.09 - 1e-3);
        EXPECT_LE(std::stod(row["z"]), 1.44 * 10.09 + 1e-3);
        EXPECT_GT(std::stod(row["z_std"]), 0);
    }
    const Outcome analysed =
        run_grainfield({"analyze", folder_ / "t.h5", "-o", folder_ / "r.h5", "--json"});
    ASSERT_EQ(analysed.code, 0) << analysed.err;
    const json results = json::parse(analysed.out);
    const auto measurement = [&](const char* observable, const std::string& name) {
        for (const json& m : results.at(observable).at("measurements")) {
            if (m.at("name") == name) return m;
        }
        return json{};
    };
    EXPECT_EQ(measurement("lengths", "residual").at("value"), found.at("residual_rms"))
        << "that of the rendering, where positions come from it";
    EXPECT_GT(measurement("gr", "known_heights").at("value").get<double>(), 0.3);
    EXPECT_GT(measurement("height", "height_spread").at("value").get<double>(), 0.05);
}

}  // namespace
}  // namespace grainfield
