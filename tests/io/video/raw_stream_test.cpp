#include "io/video/raw_stream.h"

#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/errors.h"
#include "tests/support/fifo.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const RawStream::IsStopped go_on = [] { return false; };

TEST(RawStream, HeadersSayDepthAndWhatToSkip) {
    const auto format = [](const std::string& space) {
        return yuv4mpeg_format("YUV4MPEG2 W5 H3 F30000:1001 C" + space, "x");
    };
    EXPECT_EQ(format("mono").bit_depth, 8);
    EXPECT_EQ(format("mono").count_bytes(), 15U);
    EXPECT_EQ(format("mono").chroma_bytes, 0U);
    EXPECT_EQ(format("mono10").bit_depth, 10);
    EXPECT_EQ(format("mono10").count_bytes(), 30U);
    EXPECT_EQ(format("420jpeg").chroma_bytes, 2U * 3 * 2);
    EXPECT_EQ(format("420paldv").bit_depth, 8);
    EXPECT_EQ(format("422p12").bit_depth, 12);
    EXPECT_EQ(format("422p12").chroma_bytes, 2U * 2 * 3 * 3);
    EXPECT_EQ(format("444").chroma_bytes, 2U * 15);
    EXPECT_NEAR(*format("mono").fps, 29.97, 0.001);
    EXPECT_EQ(yuv4mpeg_format("YUV4MPEG2 W5 H3 F0:0 Cmono", "x").fps, std::nullopt);
}

TEST(RawStream, OtherHeadersAreRefusedByName) {
    for (const char* line : {"", "RIFF", "YUV4MPEG2", "YUV4MPEG2 W5", "YUV4MPEG2 W0 H3 Cmono",
                             "YUV4MPEG2 W-5 H3 Cmono", "YUV4MPEG2 W5 H3 Cmono17",
                             "YUV4MPEG2 W5 H3 Crgb", "YUV4MPEG2 W5x H3 Cmono",
                             "YUV4MPEG2 W99999999999 H3 Cmono", "YUV4MPEG2 W5 H3 C444alpha"}) {
        try {
            yuv4mpeg_format(line, "cam");
            ADD_FAILURE() << line;
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), HasSubstr("'cam'"));
        }
    }
}

TEST(RawStream, FramesLargerThanTheLimitAreRefusedBeforeMemoryIsAskedFor) {
    const testing::ScratchFolder folder;
    testing::Fifo fifo(folder / "f");
    std::thread writer(
        [&] { fifo.write(testing::yuv4mpeg_header(2'000'000'000, 2'000'000'000, "420")); });
    EXPECT_THROW(RawStream(fifo.path(), std::nullopt, 1'000'000, go_on), InputError);
    writer.join();
}

TEST(RawStream, OfAProgramItsFramesAndItsErrors) {
    const std::string header = testing::yuv4mpeg_header(2, 2, "420");
    RawStream stream({"/bin/sh", "-c",
                      "printf '" + header.substr(0, header.size() - 1) +
                          "\\nFRAME\\nabcdUVFRAME x\\nefghUVFRAMX'"},
                     "camera", 1000, go_on);
    std::vector<std::uint8_t> counts;
    ASSERT_EQ(stream.next(counts, go_on), RawRead::frame);
    EXPECT_EQ(counts, (std::vector<std::uint8_t>{'a', 'b', 'c', 'd'}));
    ASSERT_EQ(stream.next(counts, go_on), RawRead::frame);
    EXPECT_EQ(counts, (std::vector<std::uint8_t>{'e', 'f', 'g', 'h'}));
    EXPECT_EQ(stream.next(counts, go_on), RawRead::damaged);
    EXPECT_THAT(stream.damage(), HasSubstr("'FRAMX' where a frame begins"));
    try {
        RawStream failed({"/bin/sh", "-c", "echo ERROR the lens cap is on"}, "camera", 1000, go_on);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("the lens cap is on"));
    }
    EXPECT_THROW(RawStream({"/no/such/program"}, "camera", 1000, go_on), InputError);
}

/// What is said of a program that gives one frame and then does this.
std::string damage_after_one_frame(const std::string& command) {
    RawStream stream({"/bin/sh", "-c", "printf 'YUV4MPEG2 W2 H2 Cmono\\nFRAME\\nabcd'; " + command},
                     "camera", 1000, go_on);
    std::vector<std::uint8_t> counts;
    EXPECT_EQ(stream.next(counts, go_on), RawRead::frame);
    const RawRead last = stream.next(counts, go_on);
    EXPECT_EQ(last, stream.damage().empty() ? RawRead::ended : RawRead::damaged);
    return stream.damage();
}

TEST(RawStream, AProgramThatFailsIsNoUsualEnd) {
    EXPECT_EQ(damage_after_one_frame("exit 0"), "");
    EXPECT_THAT(damage_after_one_frame("exit 3"), HasSubstr("ended with exit code 3"));
    EXPECT_THAT(damage_after_one_frame("kill -KILL $$"), HasSubstr("ended by signal 9"));
    EXPECT_THAT(damage_after_one_frame("echo FRAME; printf ab; exit 4"),
                HasSubstr("2 bytes of a frame that has 4; its program ended with exit code 4"));
    EXPECT_THAT(damage_after_one_frame("echo ERROR the camera is gone; exit 3"),
                HasSubstr(": the camera is gone"));
}

TEST(RawStream, SignalsOfTheTerminalDoNotReachTheProgram) {
    try {
        RawStream stream({"/bin/sh", "-c", "echo ERROR $$ $(cut -d ' ' -f 5 /proc/$$/stat)"},
                         "camera", 1000, go_on);
        FAIL();
    } catch (const InputError& error) {
        std::istringstream words(
            std::string(error.what()).substr(std::string(error.what()).find_last_of(':') + 1));
        pid_t process = 0, group = 0;
        words >> process >> group;
        EXPECT_GT(process, 0) << error.what();
        EXPECT_EQ(group, process) << error.what();
    }
}

TEST(RawStream, AReadThatFailsIsNoUsualEnd) {
    const int input = ::dup(STDIN_FILENO);
    const int folder = ::open("/", O_RDONLY | O_DIRECTORY);
    ::dup2(folder, STDIN_FILENO);
    RawStream stream("-", RawFormat{.width = 2, .height = 2, .fps = {}}, 1000, go_on);
    ::dup2(input, STDIN_FILENO);
    ::close(input);
    ::close(folder);
    std::vector<std::uint8_t> counts;
    EXPECT_EQ(stream.next(counts, go_on), RawRead::damaged);
    EXPECT_THAT(stream.damage(), HasSubstr("byte 0: Is a directory"));
}

TEST(RawStream, AProgramThatGivesNothingIsEnded) {
    int asked = 0;
    EXPECT_THROW(
        RawStream({"/bin/sh", "-c", "sleep 100"}, "camera", 1000, [&] { return ++asked > 2; }),
        InputError);
}

std::string program_that_pauses() {
    return "printf 'YUV4MPEG2 W4 H1 F1:1 Cmono\\nFRAME\\nabcd'; sleep 1; printf 'FRAME\\nefgh'; "
           "sleep 1; printf 'FRAME\\nijkl'";
}

TEST(RawStream, ASilenceThatIsOnlyNotedIsSaidOnceAndWaitedFor) {
    int said = 0;
    RawStream stream({"/bin/sh", "-c", program_that_pauses()}, "camera", 1000, go_on,
                     {.noted = 0.3, .note = [&] { ++said; }});
    std::vector<std::uint8_t> counts;
    EXPECT_EQ(stream.next(counts, go_on), RawRead::frame);
    EXPECT_EQ(said, 0);
    EXPECT_EQ(stream.next(counts, go_on), RawRead::frame);
    EXPECT_EQ(said, 1);
    EXPECT_EQ(stream.next(counts, go_on), RawRead::frame);
    EXPECT_EQ(counts, (std::vector<std::uint8_t>{'i', 'j', 'k', 'l'}));
    EXPECT_EQ(stream.next(counts, go_on), RawRead::ended);
    EXPECT_EQ(said, 1) << "the second silence is not news";
    EXPECT_FALSE(stream.is_silent());
}

TEST(RawStream, ASilenceLongerThanTheLongestIsDamage) {
    RawStream stream({"/bin/sh", "-c", program_that_pauses()}, "camera", 1000, go_on,
                     {.longest = 0.3});
    std::vector<std::uint8_t> counts;
    EXPECT_EQ(stream.next(counts, go_on), RawRead::frame);
    EXPECT_EQ(stream.next(counts, go_on), RawRead::damaged);
    EXPECT_TRUE(stream.is_silent());
    EXPECT_THAT(stream.damage(), HasSubstr("nothing came for 0.3 s"));
}

std::string refusal_of_silent(const std::string& fifo) {
    try {
        RawStream(fifo, std::nullopt, 1000, go_on, {.longest = 0.2});
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

TEST(RawStream, AFifoThatNobodyOpensIsSilentFromTheStart) {
    const testing::ScratchFolder folder;
    const testing::Fifo fifo(folder / "f");
    EXPECT_THAT(refusal_of_silent(fifo.path()),
                AllOf(HasSubstr("nothing came for 0.2 s"), HasSubstr("'live-silence'")));
    RawStream stream(fifo.path(), RawFormat{.width = 2, .height = 2, .fps = {}}, 1000, go_on,
                     {.longest = 0.2});
    std::vector<std::uint8_t> counts;
    EXPECT_EQ(stream.next(counts, go_on), RawRead::damaged);
    EXPECT_TRUE(stream.is_silent());
}

TEST(RawStream, AFifoThatIsOpenedButNotWrittenIsSilent) {
    const testing::ScratchFolder folder;
    const testing::Fifo fifo(folder / "f");
    const int writer = ::open(fifo.path().c_str(), O_RDWR | O_CLOEXEC);
    EXPECT_THAT(refusal_of_silent(fifo.path()), HasSubstr("nothing came for 0.2 s"));
    ::close(writer);
}

TEST(RawStream, AWriterThatComesWithinTheLimitIsRead) {
    const testing::ScratchFolder folder;
    testing::Fifo fifo(folder / "f");
    std::thread writer([&] {
        fifo.write(testing::yuv4mpeg_header(2, 1, "mono") + "FRAME\nab");
        fifo.close();
    });
    RawStream stream(fifo.path(), std::nullopt, 1000, go_on, {.longest = 60});
    std::vector<std::uint8_t> counts;
    EXPECT_EQ(stream.next(counts, go_on), RawRead::frame);
    EXPECT_EQ(counts, (std::vector<std::uint8_t>{'a', 'b'}));
    writer.join();
}

}  // namespace
}  // namespace grainfield::io
