// Frames that are tracked while they come: a FIFO, standard input, a camera that GStreamer makes
// up.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <png.h>

#include "tests/support/csv_rows.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/disc_stream.h"
#include "tests/support/fifo.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using ::testing::AllOf;
using testing::Fifo;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::program;
using testing::run_grainfield;
using testing::ScratchFolder;

/// 30 frames of 9 bit, so that a count of frame 21 may be too high.
void write_stream_with_a_bad_count(Fifo& fifo) {
    fifo.write(testing::disc_stream_header("mono9"));
    for (int i = 0; i < 30; ++i) {
        const auto bytes = testing::bytes_of(testing::disc_frame(testing::few_discs(), i));
        std::vector<std::uint16_t> counts(bytes.begin(), bytes.end());
        if (i == 21) counts[0] = 512;
        fifo.write("FRAME\n" + testing::raw_bytes(counts, 9));
    }
    fifo.close();
}

bool is_without_test_source(const Outcome& live) {
    return live.code == 3 && live.err.find("opens it") != std::string::npos;
}

class Live : public ::testing::Test {
 protected:
    Live() { std::signal(SIGPIPE, SIG_IGN); }

    /// Frames, identities and positions of the last run.
    std::string points(const std::string& tracks) {
        const Outcome exported = run_grainfield(
            {"export", "--force", "--digits", "all", out_ / tracks, "-o", out_ / "t.csv"});
        EXPECT_EQ(exported.code, 0) << exported.err;
        const std::string text = testing::read_all(out_ / "t.csv");
        return text.substr(text.find("frame,"));
    }

    ScratchFolder out_;
};

TEST_F(Live, FramesFromAFifoGiveTheTracksOfTheFilm) {
    constexpr int frames = 14;
    const ScratchFolder film;
    std::vector<std::string> words{"track", "-o", out_ / "film.h5", "--fps", "25"};
    for (const std::string& path : testing::write_disc_sequence(film, frames)) {
        words.push_back(path);
    }
    ASSERT_EQ(run_grainfield(words).code, 0);
    Fifo fifo(out_ / "camera");
    std::thread writer([&] {
        for (int i = 0; i < frames; ++i) fifo.write(testing::raw_disc_frame(i));
        fifo.close();
    });
    const Outcome live = run_grainfield({"track", "--live", fifo.path(), "--live-size", "192,192",
                                         "--live-wait", "--fps", "25", "-o", out_ / "live.h5"});
    writer.join();
    ASSERT_EQ(live.code, 0) << live.err;
    EXPECT_THAT(live.out, AllOf(HasSubstr("14 frames"), HasSubstr("14 frames came, 0 dropped"),
                                HasSubstr("the source ended")));
    EXPECT_EQ(points("live.h5"), points("film.h5"));
}

TEST_F(Live, AStreamOfFfmpegOnStandardInputGivesTheTracksOfItsFilm) {
    const ScratchFolder film;
    testing::write_disc_sequence(film, 12);
    const std::string encode =
        fmt::format("ffmpeg -v error -framerate 30 -i '{}/frame_%03d.png' -pix_fmt gray12le",
                    film.path().string());
    if (testing::shell(fmt::format("{} -c:v ffv1 '{}'", encode, out_ / "film.mkv")).code != 0) {
        GTEST_SKIP() << "ffmpeg is not installed";
    }
    ASSERT_EQ(run_grainfield({"track", out_ / "film.mkv", "-o", out_ / "film.h5"}).code, 0);
    const Outcome live = testing::shell(
        fmt::format("{} -f yuv4mpegpipe -strict -1 - | $GRAINFIELD track --live - --live-wait -o "
                    "'{}' --json",
                    encode, out_ / "live.h5"));
    ASSERT_EQ(live.code, 0) << live.err;
    EXPECT_EQ(nlohmann::json::parse(live.out)["frame_rate"], 30);
    EXPECT_EQ(points("live.h5"), points("film.h5"));
}

TEST_F(Live, CtrlCKeepsAllThatWasTracked) {
    Fifo fifo(out_ / "camera");
    std::atomic<int> written{0};
    std::thread writer([&] {
        if (!fifo.write(testing::disc_stream_header())) return;
        while (fifo.write(testing::disc_stream_frame(written % 200))) {
            ++written;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
    });
    const testing::Process process(program({"track", "--live", fifo.path(), "-o", out_ / "live.h5",
                                            "--preview", out_ / "now.png", "--json"}));
    for (int i = 0; i < 6000 && written < 60; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    process.send(SIGINT);
    const Outcome live = process.wait();
    writer.join();
    ASSERT_EQ(live.code, 0) << live.err << "a signal is the usual end";
    const auto facts = nlohmann::json::parse(live.out);
    EXPECT_EQ(facts["live"]["signal"], SIGINT);
    const int frames = facts["frames"];
    EXPECT_GE(frames, 30);
    EXPECT_LE(frames, written + 2);
    const auto& counts = facts["live"];
    EXPECT_EQ(counts["frames_captured"].get<int>(),
              frames + counts["frames_dropped"].get<int>() + counts["frames_untracked"].get<int>());
    std::set<std::string> seen;
    std::set<std::string> identities;
    points("live.h5");
    for (auto& row : testing::csv_rows(out_ / "t.csv")) {
        seen.insert(row["frame"]);
        identities.insert(row["particle"]);
    }
    EXPECT_EQ(static_cast<int>(seen.size()), frames);
    EXPECT_LT(identities.size(), 200U) << "some 120 discs keep their identity";
    EXPECT_THAT(testing::shell("ls '" + out_.path().string() + "'").out, Not(HasSubstr("partial")));
    png_image preview{};
    preview.version = PNG_IMAGE_VERSION;
    ASSERT_TRUE(png_image_begin_read_from_file(&preview, (out_ / "now.png").c_str()));
    EXPECT_EQ(preview.width, 192U);
    EXPECT_GT(preview.height, 192U) << "caption and colour key stand below the frame";
    png_image_free(&preview);
}

TEST_F(Live, ThePreviewIsRenewedEachSecond) {
    Fifo fifo(out_ / "camera");
    std::atomic<bool> is_over{false};
    std::thread writer([&] {
        fifo.write(testing::disc_stream_header());
        for (int i = 0; !is_over && fifo.write(testing::disc_stream_frame(i % 200)); ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        fifo.close();
    });
    const testing::Process process(program(
        {"track", "--live", fifo.path(), "-o", out_ / "live.h5", "--preview", out_ / "now.png"}));
    using Clock = std::chrono::steady_clock;
    std::vector<Clock::time_point> renewed;
    std::string picture;
    const auto deadline = Clock::now() + std::chrono::seconds(60);
    while (renewed.size() < 4 && Clock::now() < deadline) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        std::string now = testing::read_all(out_ / "now.png");
        if (now == picture) continue;
        picture = std::move(now);
        renewed.push_back(Clock::now());
    }
    is_over = true;
    writer.join();
    EXPECT_EQ(process.wait().code, 0);
    ASSERT_EQ(renewed.size(), 4U);
    // A loaded machine may be late now and then, not each time.
    auto shortest = Clock::duration::max();
    for (std::size_t i = 1; i < renewed.size(); ++i) {
        shortest = std::min(shortest, renewed[i] - renewed[i - 1]);
    }
    EXPECT_LT(shortest, std::chrono::milliseconds(1500));
    EXPECT_GT(renewed.back() - renewed.front(), std::chrono::milliseconds(2500));
    EXPECT_LT(renewed.back() - renewed.front(), std::chrono::seconds(12));
}

TEST_F(Live, ThePreviewMayBeAJpeg) {
    Fifo fifo(out_ / "camera");
    std::thread writer([&] {
        testing::write_disc_stream(fifo, 12);
        fifo.close();
    });
    const Outcome live = run_grainfield({"track", "--live", fifo.path(), "--live-wait", "-o",
                                         out_ / "live.h5", "--preview", out_ / "now.jpg"});
    writer.join();
    ASSERT_EQ(live.code, 0) << live.err;
    if (live.err.find("without libav") != std::string::npos) GTEST_SKIP() << "no libav";
    const Outcome info = run_grainfield({"info", out_ / "now.jpg"});
    EXPECT_EQ(info.code, 0) << info.err;
    EXPECT_THAT(info.out, HasSubstr(fmt::format("width        {} px", testing::kPictureSize)));
}

TEST_F(Live, FramesThatComeTooFastAreDroppedAndCounted) {
    Fifo fifo(out_ / "camera");
    constexpr int all = 3000;
    std::thread writer([&] {
        fifo.write(testing::disc_stream_header());
        const std::string first = testing::raw_disc_frame(0);
        const std::string second = testing::raw_disc_frame(1);
        for (int i = 0; i < all; ++i) fifo.write("FRAME\n" + (i % 2 == 0 ? first : second));
        fifo.close();
    });
    const Outcome live = run_grainfield(
        {"track", "--live", fifo.path(), "--live-queue", "10", "-o", out_ / "live.h5", "--json"});
    writer.join();
    ASSERT_EQ(live.code, 0) << live.err;
    const auto facts = nlohmann::json::parse(live.out);
    const int dropped = facts["live"]["frames_dropped"];
    EXPECT_EQ(facts["live"]["frames_captured"], all);
    EXPECT_GT(dropped, 100);
    EXPECT_EQ(facts["frames"].get<int>() + dropped, all) << "what was not dropped was tracked";
    EXPECT_THAT(live.err, AllOf(HasSubstr("were dropped"), HasSubstr("frames a second came")));
    points("live.h5");
    const auto rows = testing::csv_rows(out_ / "t.csv");
    ASSERT_FALSE(rows.empty());
    EXPECT_EQ(rows.back().at("frame"), std::to_string(all - 1)) << "dropped frames are gaps";
}

TEST_F(Live, TheRateIsThatOfAllFramesWhereOnlySomeAreWanted) {
    Fifo fifo(out_ / "camera");
    std::thread writer([&] {
        fifo.write(testing::disc_stream_header());
        for (int i = 0; i < 61; ++i) {
            fifo.write(testing::disc_stream_frame(i));
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
        fifo.close();
    });
    const Outcome live = run_grainfield({"track", "--live", fifo.path(), "--frames", "::2", "--fps",
                                         "19.9", "-o", out_ / "live.h5", "--json"});
    writer.join();
    ASSERT_EQ(live.code, 0) << live.err;
    const auto facts = nlohmann::json::parse(live.out);
    EXPECT_EQ(facts["live"]["frames_arrived"], 61);
    EXPECT_EQ(facts["live"]["frames_captured"], 31);
    EXPECT_EQ(facts["frames"], 31);
    const double rate = 60 / facts["live"]["seconds"].get<double>();
    EXPECT_LE(rate, 20.5);
    const bool is_warned = live.err.find("frames a second came") != std::string::npos;
    EXPECT_EQ(is_warned, std::abs(rate / 19.9 - 1) > 0.05) << rate << live.err;
}

TEST_F(Live, AFailureKeepsWhatWasTracked) {
    Fifo fifo(out_ / "camera");
    std::thread writer([&] { write_stream_with_a_bad_count(fifo); });
    const Outcome live = run_grainfield(
        {"track", "--live", fifo.path(), "--live-wait", "--strict", "-o", out_ / "live.h5"});
    writer.join();
    EXPECT_EQ(live.code, 3) << live.err;
    EXPECT_THAT(live.err, AllOf(HasSubstr("frame 21"), HasSubstr("holds the 21 frames before")));
    points("live.h5");
    EXPECT_EQ(testing::csv_rows(out_ / "t.csv").back().at("frame"), "20");
}

TEST_F(Live, AFullDiskLeavesWhatCouldBeWrittenAndItIsRead) {
    // The disk is full at different places of a frame.
    for (const int limit : {300, 340, 512}) {
        Fifo fifo(out_ / fmt::format("camera{}", limit));
        std::thread writer([&] {
            testing::write_disc_stream(fifo, 200);
            fifo.close();
        });
        const Outcome live = testing::shell(
            fmt::format("ulimit -f {}; $GRAINFIELD track --force --live '{}' --live-wait -o '{}'",
                        limit, fifo.path(), out_ / "live.h5"));
        writer.join();
        EXPECT_EQ(live.code, 4) << live.err;
        EXPECT_FALSE(std::filesystem::exists(out_ / "live.h5"));
        EXPECT_THAT(live.err, AllOf(HasSubstr("live.h5.partial' is left, with what could be"),
                                    HasSubstr("grainfield export")));
        // What the limit forbids here and a full disk does not.
        std::filesystem::resize_file(out_ / "live.h5.partial", 1 << 26);
        points("live.h5.partial");
        const auto rows = testing::csv_rows(out_ / "t.csv");
        EXPECT_GT(rows.size(), 300U);
        const int frames = std::stoi(rows.back().at("frame")) + 1;
        EXPECT_EQ(rows.size() % static_cast<std::size_t>(frames), 0U) << "each frame is whole";
    }
}

TEST_F(Live, AFailureKeepsFramesThatWaitForLongerTracks) {
    Fifo fifo(out_ / "camera");
    std::thread writer([&] { write_stream_with_a_bad_count(fifo); });
    const Outcome live = run_grainfield({"track", "--live", fifo.path(), "--live-wait", "--strict",
                                         "--minimum-length", "100", "-o", out_ / "live.h5"});
    writer.join();
    EXPECT_EQ(live.code, 3) << live.err;
    EXPECT_THAT(live.err, HasSubstr("holds the 21 frames before"));
}

TEST_F(Live, ASourceThatFallsSilentEndsWithWhatCame) {
    Fifo fifo(out_ / "camera");
    // Drawn before the run: the time that takes must not count as silence.
    std::vector<std::string> frames;
    for (int i = 0; i < 15; ++i) frames.push_back(testing::disc_stream_frame(i));
    std::atomic<bool> is_over{false};
    std::thread writer([&] {
        fifo.write(testing::disc_stream_header());
        for (const std::string& frame : frames) fifo.write(frame);
        while (!is_over) std::this_thread::sleep_for(std::chrono::milliseconds(20));
        fifo.close();
    });
    const Outcome live = run_grainfield(
        {"track", "--live", fifo.path(), "--live-silence", "3", "-o", out_ / "live.h5"});
    is_over = true;
    writer.join();
    EXPECT_EQ(live.code, 3) << live.err;
    EXPECT_THAT(live.err, AllOf(HasSubstr("fell silent"), HasSubstr("nothing came for 3 s"),
                                HasSubstr("the frames before are kept")));
    points("live.h5");
    EXPECT_EQ(testing::csv_rows(out_ / "t.csv").back().at("frame"), "14");
}

TEST_F(Live, TheRecordingGoesOnWithoutThePreview) {
    Fifo fifo(out_ / "camera");
    std::filesystem::create_directory(out_ / "pictures");
    std::thread writer([&] {
        testing::write_disc_stream(fifo, 20);
        // The first picture is there; the next one finds its folder gone.
        for (int i = 0; i < 600 && !std::filesystem::exists(out_ / "pictures/now.png"); ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
        std::filesystem::remove_all(out_ / "pictures");
        std::this_thread::sleep_for(std::chrono::milliseconds(1500));
        for (int i = 20; i < 40; ++i) fifo.write(testing::disc_stream_frame(i));
        fifo.close();
    });
    const Outcome live =
        run_grainfield({"track", "--live", fifo.path(), "--live-wait", "-o", out_ / "live.h5",
                        "--preview", out_ / "pictures/now.png", "--json"});
    writer.join();
    ASSERT_EQ(live.code, 0) << live.err;
    EXPECT_EQ(nlohmann::json::parse(live.out)["frames"], 40);
    EXPECT_THAT(live.err, HasSubstr("the preview was given up"));
}

TEST_F(Live, ACheckpointOfTheOutputThatIsReplacedIsRemoved) {
    for (const char* name : {"live.h5", "live.h5.checkpoint", "live.h5.snapshots"}) {
        std::ofstream(out_ / name) << "of an earlier run";
    }
    Fifo fifo(out_ / "camera");
    std::thread writer([&] {
        testing::write_disc_stream(fifo, 12);
        fifo.close();
    });
    const Outcome live =
        run_grainfield({"track", "--live", fifo.path(), "--force", "-o", out_ / "live.h5"});
    writer.join();
    ASSERT_EQ(live.code, 0) << live.err;
    EXPECT_FALSE(std::filesystem::exists(out_ / "live.h5.checkpoint"));
    EXPECT_FALSE(std::filesystem::exists(out_ / "live.h5.snapshots"));
}

TEST_F(Live, AGStreamerPipelineIsACamera) {
    const std::string pipeline =
        "videotestsrc num-buffers=30 pattern=ball ! "
        "video/x-raw,format=GRAY16_LE,width=320,height=240,framerate=30/1";
    const Outcome live =
        run_grainfield({"track", "--live", pipeline, "--live-wait", "--polarity", "bright",
                        "--disc-diameter", "40", "-o", out_ / "live.h5", "--json", "-v"});
    if (is_without_test_source(live)) {
        GTEST_SKIP() << "GStreamer has no videotestsrc here";
    }
    ASSERT_EQ(live.code, 0) << live.err;
    const auto facts = nlohmann::json::parse(live.out);
    EXPECT_EQ(facts["frames"], 30);
    EXPECT_EQ(facts["frame_rate"], 30);
    EXPECT_EQ(facts["frame_rate_source"], "live");
    EXPECT_EQ(facts["particles_mean"], 1) << "the one ball of the pattern";
    EXPECT_TRUE(facts["live"]["damage"].is_null()) << "the end of a pipeline is no damage";
}

TEST_F(Live, APipelineThatStallsEnds) {
    // The second frame would come after a minute.
    const std::string pipeline =
        "videotestsrc is-live=true pattern=ball ! "
        "video/x-raw,format=GRAY8,width=320,height=240,framerate=1/60 ! appsink sync=true";
    const Outcome live =
        run_grainfield({"track", "--live", pipeline, "--polarity", "bright", "--disc-diameter",
                        "40", "--live-silence", "4", "-o", out_ / "live.h5"});
    if (is_without_test_source(live)) {
        GTEST_SKIP() << "GStreamer has no videotestsrc here";
    }
    EXPECT_EQ(live.code, 3) << live.err;
    EXPECT_THAT(live.err, HasSubstr("came for 4 s"));
}

TEST_F(Live, ASourceThatBreaksOffIsSaidAndWhatCameIsKept) {
    Fifo fifo(out_ / "camera");
    std::thread writer([&] {
        testing::write_disc_stream(fifo, 12);
        fifo.write("ERROR the camera gives no more frames\n");
        fifo.close();
    });
    const Outcome live =
        run_grainfield({"track", "--live", fifo.path(), "-o", out_ / "live.h5", "--json"});
    writer.join();
    ASSERT_EQ(live.code, 0) << live.err;
    const auto facts = nlohmann::json::parse(live.out);
    EXPECT_EQ(facts["frames"], 12);
    EXPECT_THAT(facts["live"]["damage"].get<std::string>(), HasSubstr("no more frames"));
    EXPECT_THAT(live.err, HasSubstr("the camera gives no more frames; the frames before are kept"));
}

TEST_F(Live, WhatIsNoLiveSourceIsRefused) {
    const auto refused = [&](std::vector<std::string> more, int code, const std::string& text) {
        std::vector<std::string> words{"track", "-o", out_ / "t.h5"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome outcome = run_grainfield(words);
        EXPECT_EQ(outcome.code, code) << outcome.out << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(text));
        EXPECT_FALSE(std::filesystem::exists(out_ / "t.h5"));
    };
    refused({}, 2, "has no input");
    refused({"film.avi", "--preview", "p.png"}, 2, "--live");
    refused({"--live", "-", "film.avi"}, 2, "one of them");
    refused({"--live", "-", "--resume"}, 2, "--resume");
    refused({"--live", "-", "--preview", "p.gif"}, 2, ".png or .jpg");
    refused({"--live", "-"}, 3, "nothing came");
    refused({"--live", out_.path().string()}, 3, "no FIFO");
    refused({"--live", "no-such-element ! x"}, 3, "opens it");
    const Fifo fifo(out_ / "nobody");
    refused({"--live", fifo.path(), "--live-silence", "0.3"}, 3, "nothing came for 0.3 s");
    const Outcome plan = run_grainfield({"track", "--live", "-", "-o", out_ / "t.h5", "--explain"});
    EXPECT_EQ(plan.code, 0) << plan.err;
    EXPECT_THAT(plan.out, HasSubstr("at most 64 of them waiting"));
}

}  // namespace
}  // namespace grainfield
