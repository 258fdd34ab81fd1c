#include "io/video/live_frames.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "tests/support/fifo.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using testing::Fifo;
using ::testing::HasSubstr;
using testing::ScratchFolder;

constexpr int kWidth = 7, kHeight = 5;

/// Every pixel of every frame has its own count.
std::vector<std::uint16_t> counts_of(int frame, int most = 4095) {
    std::vector<std::uint16_t> counts;
    for (int i = 0; i < kWidth * kHeight; ++i) {
        counts.push_back(static_cast<std::uint16_t>((97 * frame + 113 * i) % (most + 1)));
    }
    return counts;
}

std::vector<float> pixels_of(int frame, int most = 4095) {
    const std::vector<std::uint16_t> counts = counts_of(frame, most);
    return {counts.begin(), counts.end()};
}

class LiveFramesTest : public ::testing::Test {
 protected:
    LiveFramesTest() {
        options_.source = fifo_.path();
        options_.waits = true;
        std::signal(SIGPIPE, SIG_IGN);
    }
    ~LiveFramesTest() override {
        if (writer_.joinable()) writer_.join();
    }

    void write(std::function<void(Fifo&)> work) {
        writer_ = std::thread([this, work = std::move(work)] {
            work(fifo_);
            fifo_.close();
        });
    }
    /// Frames of 12 bit with a header.
    void write_frames(int count) {
        write([count](Fifo& fifo) {
            fifo.write(testing::yuv4mpeg_header(kWidth, kHeight, "mono12"));
            for (int i = 0; i < count; ++i) {
                fifo.write("FRAME\n" + testing::raw_bytes(counts_of(i), 12));
            }
        });
    }
    static void wait_for(const LiveFrames& frames, std::int64_t captured) {
        for (int i = 0; i < 3000 && frames.counts().captured < captured; ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
    }

    ScratchFolder folder_;
    Fifo fifo_{folder_ / "frames"};
    LiveOptions options_;
    std::atomic<bool> is_read_{false};  // outlives the body of the test, as the writer does
    std::thread writer_;
};

TEST_F(LiveFramesTest, CountsOfTwelveBitComeBackToTheBitInTheirOrder) {
    write_frames(40);
    const auto frames = open_live(options_);
    EXPECT_EQ(frames->width(), kWidth);
    EXPECT_EQ(frames->height(), kHeight);
    EXPECT_EQ(frames->bit_depth(), 12);
    EXPECT_EQ(frames->frame_rate(), 25.0);
    std::int64_t read = 0;
    for (; read < frames->count(); ++read) {
        const Frame frame = frames->read(read);
        ASSERT_EQ(frame.status, FrameStatus::ok);
        ASSERT_EQ(frame.index, read);
        ASSERT_DOUBLE_EQ(frame.time, static_cast<double>(read) / 25);
        ASSERT_EQ(frame.image.pixels(), pixels_of(static_cast<int>(read)));
    }
    EXPECT_EQ(read, 40) << "the end is known when it is reached";
    EXPECT_EQ(frames->counts().dropped, 0);
}

TEST_F(LiveFramesTest, FramesWithoutAHeaderAreOfTheSizeAndDepthGiven) {
    options_.size = {kWidth, kHeight};
    options_.bit_depth = 8;
    options_.fps = 50;
    write([](Fifo& fifo) {
        for (int i = 0; i < 12; ++i) fifo.write(testing::raw_bytes(counts_of(i, 255), 8));
    });
    const auto frames = open_live(options_);
    EXPECT_EQ(frames->bit_depth(), 8);
    std::int64_t read = 0;
    for (; read < frames->count(); ++read) {
        const Frame frame = frames->read(read);
        EXPECT_EQ(frame.image.pixels(), pixels_of(static_cast<int>(read), 255));
        EXPECT_DOUBLE_EQ(frame.time, static_cast<double>(read) / 50);
    }
    EXPECT_EQ(read, 12);
}

TEST_F(LiveFramesTest, AFullQueueDropsTheOldestFramesAndCountsThem) {
    options_.waits = false;
    options_.queue = 10;
    write_frames(200);
    const auto frames = open_live(options_);
    wait_for(*frames, 200);
    const LiveCounts counts = frames->counts();
    EXPECT_EQ(counts.captured, 200);
    EXPECT_EQ(counts.dropped, 180);
    EXPECT_EQ(counts.waiting, 20) << "the first ten, and ten more";
}

TEST_F(LiveFramesTest, DroppedFramesAreMissingAndTheOthersKeepTheirPlace) {
    options_.waits = false;
    options_.queue = 10;
    options_.frames = "3::2";
    write_frames(203);
    const auto frames = open_live(options_);
    wait_for(*frames, 100);
    EXPECT_EQ(frames->count(), 10) << "calibration chooses among the first ten";
    std::int64_t read = 0;
    for (; read == 0 || read < frames->count(); ++read) {
        const Frame frame = frames->read(read);
        ASSERT_EQ(frame.index, 3 + 2 * read);
        ASSERT_DOUBLE_EQ(frame.time, static_cast<double>(3 + 2 * read) / 25);
        const bool is_dropped = read >= 10 && read < 90;
        ASSERT_EQ(frame.status, is_dropped ? FrameStatus::missing : FrameStatus::ok) << read;
        if (is_dropped) continue;
        ASSERT_EQ(frame.image.pixels(), pixels_of(static_cast<int>(frame.index)));
    }
    EXPECT_EQ(read, 100);
    EXPECT_EQ(frames->counts().dropped, 80);
}

TEST_F(LiveFramesTest, AFullQueueMayHoldTheSourceInstead) {
    options_.queue = 10;
    write_frames(200);
    const auto frames = open_live(options_);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_LE(frames->counts().waiting, 10);
    std::int64_t read = 0;
    for (; read < frames->count(); ++read) ASSERT_EQ(frames->read(read).index, read);
    EXPECT_EQ(read, 200);
}

TEST_F(LiveFramesTest, TakesTheFramesThatAreWanted) {
    options_.frames = "5:50:10";
    write_frames(80);
    const auto frames = open_live(options_);
    std::vector<std::int64_t> numbers;
    for (std::int64_t i = 0; i < frames->count(); ++i) numbers.push_back(frames->read(i).index);
    EXPECT_THAT(numbers, ::testing::ElementsAre(5, 15, 25, 35, 45));
    options_.frames = "-5:";
    EXPECT_THROW(open_live(options_), OptionError) << "there is no last frame";
}

TEST_F(LiveFramesTest, TheLastTenFramesMayBeReadAgain) {
    write_frames(30);
    const auto frames = open_live(options_);
    for (std::int64_t i = 0; i < 20; ++i) frames->read(i);
    EXPECT_EQ(frames->read(10).image.pixels(), pixels_of(10));
    EXPECT_EQ(frames->read(19).image.pixels(), pixels_of(19));
    EXPECT_THROW(frames->read(9), InputError);
    EXPECT_EQ(frames->read(20).index, 20);
}

TEST_F(LiveFramesTest, FramesBeforeTheDamageAreKept) {
    write([](Fifo& fifo) {
        fifo.write(testing::yuv4mpeg_header(kWidth, kHeight, "mono"));
        for (int i = 0; i < 3; ++i) {
            fifo.write("FRAME\n" + testing::raw_bytes(counts_of(i, 255), 8));
        }
        fifo.write("FRAME\nabc");
    });
    const auto frames = open_live(options_);
    EXPECT_EQ(frames->count(), 3);
    EXPECT_EQ(frames->read(2).image.pixels(), pixels_of(2, 255));
    EXPECT_THAT(frames->counts().damage, HasSubstr("3 bytes of a frame that has 35"));
}

TEST_F(LiveFramesTest, CountsThatTheDepthDoesNotAllowMakeAFrameCorrupt) {
    write([](Fifo& fifo) {
        fifo.write(testing::yuv4mpeg_header(kWidth, kHeight, "mono12"));
        std::vector<std::uint16_t> counts = counts_of(0);
        fifo.write("FRAME\n" + testing::raw_bytes(counts, 12));
        counts[17] = 4096;
        fifo.write("FRAME\n" + testing::raw_bytes(counts, 12));
    });
    const auto frames = open_live(options_);
    EXPECT_EQ(frames->read(0).status, FrameStatus::ok);
    EXPECT_EQ(frames->read(1).status, FrameStatus::corrupt);
    EXPECT_THAT(frames->read(1).message, HasSubstr("12 bit"));
}

TEST_F(LiveFramesTest, WaitingEndsWhenTheJobIsStopped) {
    std::atomic<int> stop{0};
    const StoppableJob job(stop);
    write([&](Fifo& fifo) {
        fifo.write("YUV4");  // and no more
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        stop = SIGINT;
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
    });
    EXPECT_THROW(open_live(options_), Interrupted);
}

TEST_F(LiveFramesTest, AStoppedReaderDoesNotWaitForFrames) {
    std::atomic<int> stop{0};
    const StoppableJob job(stop);
    write([this](Fifo& fifo) {
        fifo.write(testing::yuv4mpeg_header(kWidth, kHeight, "mono12"));
        for (int i = 0; i < 12; ++i) fifo.write("FRAME\n" + testing::raw_bytes(counts_of(i), 12));
        while (!is_read_) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    });
    const auto frames = open_live(options_);
    for (std::int64_t i = 0; i < 12; ++i) frames->read(i);
    stop = SIGINT;
    EXPECT_EQ(frames->count(), 12);
    EXPECT_EQ(frames->read(12).status, FrameStatus::missing);
    is_read_ = true;
}

/// Twelve frames, the last after a second of silence.
void pause_before_the_last(Fifo& fifo) {
    fifo.write(testing::yuv4mpeg_header(kWidth, kHeight, "mono12"));
    for (int i = 0; i < 12; ++i) {
        if (i == 11) std::this_thread::sleep_for(std::chrono::seconds(1));
        fifo.write("FRAME\n" + testing::raw_bytes(counts_of(i), 12));
    }
}

TEST_F(LiveFramesTest, AFifoIsWaitedForInSilenceUnlessALimitIsGiven) {
    std::atomic<int> said{0};
    options_.noted_silence = 0.3;
    options_.on_silence = [&] { ++said; };
    write(pause_before_the_last);
    const auto frames = open_live(options_);
    EXPECT_EQ(frames->read(11).image.pixels(), pixels_of(11));
    EXPECT_EQ(said, 0) << "the end of a FIFO is seen";
    EXPECT_FALSE(frames->counts().is_silent);
}

TEST_F(LiveFramesTest, AGivenLimitEndsASilentSource) {
    options_.longest_silence = 0.3;
    // All that will ever come is in the FIFO before it is read.
    const int end = ::open(fifo_.path().c_str(), O_RDWR | O_CLOEXEC);
    std::string bytes = testing::yuv4mpeg_header(kWidth, kHeight, "mono12");
    for (int i = 0; i < 11; ++i) bytes += "FRAME\n" + testing::raw_bytes(counts_of(i), 12);
    ASSERT_EQ(::write(end, bytes.data(), bytes.size()), std::ssize(bytes));
    const auto frames = open_live(options_);
    EXPECT_EQ(frames->read(10).status, FrameStatus::ok);
    EXPECT_THROW(frames->read(11), OptionError) << "eleven came";
    EXPECT_TRUE(frames->counts().is_silent);
    ::close(end);
}

TEST_F(LiveFramesTest, ASourceThatNeverBeginsIsSilentFromTheStart) {
    options_.longest_silence = 0.3;
    for (const bool has_header : {true, false}) {
        if (!has_header) options_.size = {kWidth, kHeight};
        try {
            open_live(options_);
            ADD_FAILURE();
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), HasSubstr("nothing came for 0.3 s"));
            EXPECT_THAT(error.what(), HasSubstr("'live-silence'"));
        }
    }
}

TEST_F(LiveFramesTest, WhatIsNoLiveSourceIsRefused) {
    const std::string file = folder_ / "film.raw";
    std::ofstream(file) << "bytes";
    options_.source = file;
    EXPECT_THROW(open_live(options_), InputError);
    options_.source = folder_ / "nothing";
    EXPECT_THROW(open_live(options_), InputError);
    write([](Fifo&) {});
    options_.source = "0";
    options_.size = {kWidth, kHeight};
    EXPECT_THROW(open_live(options_), OptionError) << "a camera says its size";
}

TEST_F(LiveFramesTest, AnEmptyStreamIsRefused) {
    write([](Fifo& fifo) { fifo.write(testing::yuv4mpeg_header(kWidth, kHeight, "mono")); });
    try {
        open_live(options_);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("no frame came"));
    }
}

}  // namespace
}  // namespace grainfield::io
