// `grainfield calibrate-camera`, and tracks that are corrected with its camera file.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/csv_rows.h"
#include "tests/support/image_files.h"
#include "tests/support/program.h"
#include "tests/support/tilted_camera.h"

namespace grainfield {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::held;
using testing::Outcome;
using testing::Pose;
using testing::run_grainfield;
using testing::ScratchFolder;
using testing::TiltedCamera;

constexpr int kColumns = 15, kRows = 11;  // dots of the plate
constexpr double kPitch = 5;              // mm

TiltedCamera small_camera() {
    TiltedCamera camera;
    camera.width = 400;
    camera.height = 300;
    camera.focal = 750;
    camera.centre = {203, 147};
    return camera;
}

std::vector<Vec2> plate() {
    std::vector<Vec2> dots;
    for (int row = 0; row < kRows; ++row) {
        for (int column = 0; column < kColumns; ++column) {
            dots.push_back({static_cast<double>(column), static_cast<double>(row)});
        }
    }
    return dots;
}

/// Spheres apart from one another that drift; in the plane of the plate, in its units.
std::vector<Vec2> spheres(int frame) {
    std::vector<Vec2> places;
    for (int row = 0; row < 19; ++row) {
        for (int column = 0; column < 26; ++column) {
            const double shift = 0.1 * std::sin(3.7 * column + 1.3 * row);
            places.push_back(
                {0.55 * column + shift + 0.01 * frame, 0.55 * row - shift - 0.02 * frame});
        }
    }
    return places;
}

class CameraFile : public ::testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder = new ScratchFolder;
        const TiltedCamera camera = small_camera();
        const std::vector<Pose> poses{cell(), held({0.35, 0, 0}, middle, 36),
                                      held({-0.1, 0.35, 0.3}, middle, 36)};
        for (std::size_t i = 0; i < poses.size(); ++i) {
            boards.push_back(*folder / fmt::format("board_{}.png", i));
            testing::write_png(boards.back(), camera.discs(plate(), 0.42, poses[i], 2, i));
        }
        for (int i = 0; i < 2; ++i) {
            frames.push_back(*folder / fmt::format("film_{}.png", i));
            testing::write_png(frames.back(), camera.discs(spheres(i), 0.4, cell(), 2,
                                                           10 + static_cast<unsigned>(i)));
        }
        calibrated = run_grainfield(
            testing::with({"calibrate-camera", "--json", "-o", *folder / "camera.toml", "--pitch",
                           fmt::format("{}", kPitch)},
                          boards));
    }
    static void TearDownTestSuite() { delete folder; }

    static Pose cell() { return held({0.06, -0.04, 0.02}, middle, 32); }

    Outcome track(std::vector<std::string> words) {
        words.insert(words.begin(), "track");
        return run_grainfield(testing::with(std::move(words), frames));
    }

    /// The camera file with a piece of its text replaced.
    std::string changed(const std::string& from, const std::string& to) {
        std::string text = testing::read_all(*folder / "camera.toml");
        const auto at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        text.replace(at, from.size(), to);
        const std::string path = own_ / "changed.toml";
        std::ofstream(path) << text;
        return path;
    }

    const ScratchFolder own_;
    static inline ScratchFolder* folder = nullptr;
    static inline const Vec2 middle{7, 5};
    static inline std::vector<std::string> boards, frames;
    static inline Outcome calibrated;
};

TEST_F(CameraFile, IsMadeOfPicturesOfADotPlate) {
    ASSERT_EQ(calibrated.code, 0) << calibrated.err;
    const auto facts = nlohmann::json::parse(calibrated.out);
    EXPECT_EQ(facts["board"], "dots");
    EXPECT_EQ(facts["views"], 3);
    EXPECT_LT(facts["residual_px"], 0.05);
    EXPECT_GT(facts["largest_shift_px"], 2);
    EXPECT_EQ(facts["scale_unit"], "mm");
    EXPECT_THAT(testing::read_all(*folder / "camera.svg"), HasSubstr("RMS per axis"));
    const Outcome info = run_grainfield({"info", "--json", *folder / "camera.toml"});
    ASSERT_EQ(info.code, 0) << info.err;
    EXPECT_EQ(nlohmann::json::parse(info.out)["scale"], facts["scale"]);
}

TEST_F(CameraFile, IsPrintedAsItIsWritten) {
    const std::vector<std::string> call = testing::with(
        {"calibrate-camera", "-o", "-", "--pitch", fmt::format("{}", kPitch)}, boards);
    const Outcome printed = run_grainfield(call);
    ASSERT_EQ(printed.code, 0) << printed.err;
    EXPECT_EQ(printed.out, testing::read_all(*folder / "camera.toml"));
    EXPECT_EQ(run_grainfield(testing::with(call, {"--json"})).code, 2);
}

TEST_F(CameraFile, CorrectsPositionsToThoseOfThePlane) {
    const Outcome outcome = track({"--json", "-o", own_ / "t.h5", "--camera",
                                   *folder / "camera.toml", "--sphere-mm", "2.25"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto facts = nlohmann::json::parse(outcome.out);
    const double scale = nlohmann::json::parse(calibrated.out)["scale"];
    EXPECT_NEAR(facts["sphere_px"], 2.25 / scale, 1e-9);
    EXPECT_EQ(facts["sphere_px_source"], "given");
    ASSERT_EQ(run_grainfield({"export", own_ / "t.h5", "-o", own_ / "t.csv"}).code, 0);
    // The middle of the frame stays; all else is the plane, turned, in pixels of that scale.
    std::vector<Vec2> found;
    for (const auto& row : testing::csv_rows(own_ / "t.csv")) {
        if (row.at("frame") == "0")
            found.push_back({std::stod(row.at("x")), std::stod(row.at("y"))});
    }
    const TiltedCamera camera = small_camera();
    const Vec2 centre{199.5, 149.5};
    const Vec2 under_centre = camera.place_at(centre, cell());
    double rms = 1e9;
    for (double angle = -0.1; angle < 0.1; angle += 5e-5) {
        double squares = 0;
        double count = 0;
        for (const Vec2 place : spheres(0)) {
            const Vec2 p = camera.seen(place, cell());
            if (p.x < 12 || p.y < 12 || p.x > 387 || p.y > 287) continue;
            const Vec2 w = kPitch / scale * (place - under_centre);
            const Vec2 wanted = centre + Vec2{w.x * std::cos(angle) - w.y * std::sin(angle),
                                              w.x * std::sin(angle) + w.y * std::cos(angle)};
            double least = 4;
            for (const Vec2 q : found) least = std::min(least, squared_norm(q - wanted));
            squares += least;
            ++count;
        }
        rms = std::min(rms, std::sqrt(0.5 * squares / count));
    }
    // Noise of a ninetieth of the contrast: 0.03 px; the turn is looked for in steps of 0.01 px.
    EXPECT_LT(rms, 0.05);
}

TEST_F(CameraFile, WithSynthesisIsRefusedWithWhatToDo) {
    const Outcome both = track({"-o", own_ / "t.h5", "--camera", *folder / "camera.toml",
                                "--synthesis", "--sphere-diameter", "20"});
    EXPECT_EQ(both.code, 2);
    EXPECT_THAT(both.err, AllOf(HasSubstr("taken for heights"),
                                HasSubstr("leave out --synthesis: with --height")));
}

TEST_F(CameraFile, OfAnotherResolutionIsRefusedWithBothSizes) {
    testing::write_png(own_ / "large.png", Image(500, 400, 100));
    const Outcome outcome = run_grainfield(
        {"track", own_ / "large.png", "-o", own_ / "t.h5", "--camera", *folder / "camera.toml"});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("500 x 400 px"));
    EXPECT_THAT(outcome.err, HasSubstr("400 x 300 px"));
}

TEST_F(CameraFile, ThatIsCutOrEditedIsRefusedWithFileAndReason) {
    struct Damage {
        const char *from, *to, *said;
    };
    for (const auto& [from, to, said] :
         {Damage{"k1 =", "k1 = \"x\" #", "key 'lens.k1'"},
          Damage{"homography = [", "homography = [1, ", "key 'tilt.homography'"},
          Damage{"[check]", "[check]\nmood = 3 #", "unknown key 'check.mood'"},
          Damage{"[scale]", "[scale]\nmood = 3\n", "unknown key 'scale.mood'"},
          Damage{"camera 1", "camera 9", "key 'format'"},
          Damage{"length = ", "length = 1", "changed or cut"},
          Damage{"unit = \"mm\"", "unit = \"m\"", "key 'scale.unit'"},
          Damage{"[frame]", "[frame", "line "}}) {
        const Outcome outcome = track({"-o", own_ / "t.h5", "--camera", changed(from, to)});
        EXPECT_EQ(outcome.code, 3) << said;
        EXPECT_THAT(outcome.err, HasSubstr("changed.toml': "));
        EXPECT_THAT(outcome.err, HasSubstr(said));
    }
    const std::string whole = testing::read_all(*folder / "camera.toml");
    for (std::size_t length = 0; length < whole.size() - 1; length += whole.size() / 6) {
        std::ofstream(own_ / "cut.toml") << whole.substr(0, length);
        const Outcome outcome = track({"-o", own_ / "t.h5", "--camera", own_ / "cut.toml"});
        EXPECT_EQ(outcome.code, 3) << length;
        EXPECT_THAT(outcome.err, HasSubstr("cut.toml': "));
    }
}

TEST_F(CameraFile, IsHeldByAKeptCalibration) {
    const std::string camera = *folder / "camera.toml";
    const Outcome first =
        track({"-o", own_ / "a.h5", "--camera", camera, "--save-calibration", own_ / "cal.toml"});
    ASSERT_EQ(first.code, 0) << first.err;
    ASSERT_EQ(track({"-o", own_ / "b.h5", "--calibration", own_ / "cal.toml"}).code, 0);
    const auto positions = [&](const char* name) {
        EXPECT_EQ(run_grainfield({"export", own_ / name, "-o", own_ / "p.csv", "--force"}).code, 0);
        return testing::read_all(own_ / "p.csv");
    };
    EXPECT_EQ(positions("a.h5"), positions("b.h5"));
    const Outcome info = run_grainfield({"info", "--json", own_ / "cal.toml"});
    EXPECT_THAT(info.out, HasSubstr("camera_residual_px"));
}

TEST_F(CameraFile, OfARectangleMakesItTheBox) {
    const TiltedCamera camera = small_camera();
    std::string corners;
    for (const Vec2 place : {Vec2{2, 1}, Vec2{12, 1}, Vec2{12, 9}, Vec2{2, 9}}) {
        const Vec2 p = camera.seen(place, cell());
        corners += fmt::format("{}{},{}", corners.empty() ? "" : ",", p.x, p.y);
    }
    const Outcome made = run_grainfield({"calibrate-camera", frames[0], "-o", own_ / "tilt.toml",
                                         "--corners", corners, "--sides", "50,40", "--json"});
    ASSERT_EQ(made.code, 0) << made.err;
    const double scale = nlohmann::json::parse(made.out)["scale"];
    ASSERT_EQ(track({"-o", own_ / "t.h5", "--camera", own_ / "tilt.toml"}).code, 0);
    const auto info = nlohmann::json::parse(run_grainfield({"info", "--json", own_ / "t.h5"}).out);
    EXPECT_NEAR(info["box"][0], 50 / scale, 1e-6);
    EXPECT_NEAR(info["box"][1], 40 / scale, 1e-6);
    // Half the answer is none.
    const Outcome half = run_grainfield(
        {"calibrate-camera", frames[0], "-o", own_ / "no.toml", "--corners", corners});
    EXPECT_EQ(half.code, 2);
    EXPECT_THAT(half.err, HasSubstr("--sides is not given"));
    // Width for height.
    const Outcome swapped = run_grainfield({"calibrate-camera", frames[0], "-o", own_ / "no.toml",
                                            "--corners", corners, "--sides", "40,50"});
    EXPECT_EQ(swapped.code, 2);
    EXPECT_THAT(swapped.err,
                AllOf(HasSubstr("wrong order: 40,50: seen from"), HasSubstr("; 50,40: seen from"),
                      HasSubstr("give --sides as 50,40")));
    EXPECT_FALSE(std::filesystem::exists(own_ / "no.toml"));
}

TEST_F(CameraFile, OfWallsWantsTheirSidesInOrderAndNoBoard) {
    TiltedCamera camera;
    camera.k1 = camera.k2 = camera.p1 = camera.p2 = 0;
    testing::write_png(own_ / "cell.png",
                       camera.cell(40, 30, 1.5, {}, held({0.07, -0.05, 0.02}, {20, 15}, 85), 2, 1));
    const auto calibrate = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {"calibrate-camera", own_ / "cell.png", "-o",
                                     own_ / "walls.toml", "--unit", "a"});
        return run_grainfield(words);
    };
    const auto refused = [&](std::vector<std::string> words, const std::string& text) {
        const Outcome outcome = calibrate(std::move(words));
        EXPECT_EQ(outcome.code, 2) << outcome.out << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(text));
        EXPECT_FALSE(std::filesystem::exists(own_ / "walls.toml"));
    };
    refused({"--walls"}, "--sides is not given");
    refused({"--sides", "40,30"}, "neither --corners nor --walls is given");
    refused({"--walls", "--sides", "30,40"}, "give --sides as 40,30");
    refused({"--walls", "--sides", "40,30", "--pitch", "5"}, "--pitch is for pictures of a board");
    refused({"--walls", "--sides", "40,30", "--inner-corners", "7,7"}, "--inner-corners is for");
    refused({"--walls", "--sides", "40,30", "--cell-picture", "1"}, "1 of 1");
    const Outcome made = calibrate({"--walls", "--sides", "40,30"});
    EXPECT_EQ(made.code, 0) << made.err;
    EXPECT_EQ(made.err.find("warning"), std::string::npos) << made.err;
    const std::string help = run_grainfield({"calibrate-camera", "--help"}).out;
    EXPECT_THAT(help, HasSubstr("--walls or --corners"));
}

TEST_F(CameraFile, NeedsABoardInThePictureOfTheCell) {
    testing::write_png(own_ / "grey.png", Image(400, 300, 100));
    const Outcome none =
        run_grainfield({"calibrate-camera", own_ / "grey.png", boards[0], "-o", own_ / "c.toml"});
    EXPECT_EQ(none.code, 3);
    EXPECT_THAT(none.err, HasSubstr("no board in '"));
    const Outcome other = run_grainfield({"calibrate-camera", own_ / "grey.png", boards[0], "-o",
                                          own_ / "c.toml", "--cell-picture", "1"});
    EXPECT_EQ(other.code, 0) << other.err;
    EXPECT_THAT(other.err, HasSubstr("left out"));
}

TEST_F(CameraFile, IsNotMadeOfAFrameOfTheFilm) {
    const auto refused = [&](const std::string& picture, const std::string& words) {
        const Outcome outcome =
            run_grainfield({"calibrate-camera", picture, "-o", own_ / "c.toml"});
        EXPECT_EQ(outcome.code, 3) << picture;
        EXPECT_THAT(outcome.err, AllOf(HasSubstr(words), HasSubstr("frame")));
        EXPECT_EQ(own_.entries(), 1U) << "no camera file, no picture";
    };
    // A crystal: every sphere has its place on a grid, and none is quite there.
    std::mt19937 random(3);
    std::normal_distribution<double> off(0, 0.05);
    std::vector<Vec2> crystal = plate();
    for (Vec2& p : crystal) p += {off(random), off(random)};
    const TiltedCamera camera = small_camera();
    testing::write_png(own_ / "film.png", camera.discs(crystal, 0.42, cell(), 2, 1));
    refused(own_ / "film.png", "is no even grid");
    // A liquid with a crystal in its middle: most spheres are on no grid.
    std::uniform_real_distribution<double> anywhere(-0.3, 0.3);
    crystal = plate();
    for (Vec2& p : crystal) {
        const bool is_crystal = std::abs(p.x - 7) < 2.5 && std::abs(p.y - 5) < 2.5;
        if (!is_crystal) p += {anywhere(random), anywhere(random)};
    }
    testing::write_png(own_ / "film.png", camera.discs(crystal, 0.3, cell(), 2, 1));
    refused(own_ / "film.png", "spots that lie on no common grid");
}

TEST_F(CameraFile, GoesThroughARun) {
    const Outcome outcome =
        run_grainfield(testing::with({"run", "-o", own_ / "r", "--camera", *folder / "camera.toml",
                                      "--no-overlay", "--observables", "q4", "--sphere-mm", "2.25"},
                                     frames));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("spheres of 2.25 mm"));
    const Outcome overlay =
        run_grainfield({"export", own_ / "r/tracks.h5", "--overlay", own_ / "film.mp4"});
    EXPECT_EQ(overlay.code, 0) << overlay.err;
}

}  // namespace
}  // namespace grainfield
