#include "io/h5/checkpoint_file.h"

#include <bit>
#include <fstream>
#include <iterator>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/random.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Checkpoint sample() {
    Checkpoint checkpoint;
    checkpoint.kind = "field";
    checkpoint.configuration = {{"model.nu", "0.003"}, {"grid.nx", "64"}, {"odd \"näme\"", "a\nb"}};
    RandomStream random(3, "checkpoint test");
    for (int i = 0; i < 1000; ++i) checkpoint.reals["rho"].push_back(random.normal());
    checkpoint.reals["edge"] = {0.0, -0.0, std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::denorm_min(), 0.1};
    checkpoint.reals["empty"] = {};
    checkpoint.texts["warnings"] = {"frame 3: zu dunkel für Kugeln", ""};
    checkpoint.integers["step"] = {std::numeric_limits<std::int64_t>::min(), 0, 1LL << 60};
    return checkpoint;
}

std::string bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void put(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

std::string refusal(const std::string& path) {
    try {
        read_checkpoint(path);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(CheckpointFile, GivesBackEveryBit) {
    const testing::ScratchFolder folder;
    const Checkpoint written = sample();
    write_checkpoint(written, folder / "run.checkpoint");
    const Checkpoint read = read_checkpoint(folder / "run.checkpoint");
    EXPECT_EQ(read, written);
    for (std::size_t i = 0; i < written.reals.at("edge").size(); ++i) {
        EXPECT_EQ(std::bit_cast<std::uint64_t>(read.reals.at("edge")[i]),
                  std::bit_cast<std::uint64_t>(written.reals.at("edge")[i]));
    }
    EXPECT_EQ(folder.entries(), 1U);
}

TEST(CheckpointFile, KeepsTheBitsOfNaN) {
    const testing::ScratchFolder folder;
    Checkpoint checkpoint;
    checkpoint.reals["x"] = {std::bit_cast<double>(0x7ff8dead'beef0001ULL)};
    write_checkpoint(checkpoint, folder / "c");
    EXPECT_EQ(std::bit_cast<std::uint64_t>(read_checkpoint(folder / "c").reals.at("x")[0]),
              0x7ff8dead'beef0001ULL);
}

TEST(CheckpointFile, ReplacesAnOlderOne) {
    const testing::ScratchFolder folder;
    Checkpoint checkpoint = sample();
    write_checkpoint(checkpoint, folder / "c");
    checkpoint.integers["step"] = {2};
    write_checkpoint(checkpoint, folder / "c");
    EXPECT_EQ(read_checkpoint(folder / "c").integers.at("step"), std::vector<std::int64_t>{2});
}

TEST(CheckpointFile, EveryFlippedBitIsNoticed) {
    const testing::ScratchFolder folder;
    Checkpoint small;
    small.kind = "md";
    small.reals["x"] = {1, 2};
    small.integers["n"] = {7};
    write_checkpoint(small, folder / "c");
    const std::string good = bytes_of(folder / "c");
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
        std::string bad = good;
        bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
        put(folder / "bad", bad);
        EXPECT_THROW(read_checkpoint(folder / "bad"), InputError) << "bit " << bit;
    }
}

TEST(CheckpointFile, EveryCutAndAnyAdditionIsNoticed) {
    const testing::ScratchFolder folder;
    write_checkpoint(sample(), folder / "c");
    const std::string good = bytes_of(folder / "c");
    for (std::size_t length = 0; length < good.size(); length += length < 700 ? 1 : 97) {
        put(folder / "bad", good.substr(0, length));
        EXPECT_THROW(read_checkpoint(folder / "bad"), InputError) << "length " << length;
    }
    put(folder / "bad", good + '\0');
    EXPECT_THROW(read_checkpoint(folder / "bad"), InputError);
}

TEST(CheckpointFile, SaysWhatIsWrong) {
    const testing::ScratchFolder folder;
    EXPECT_THAT(refusal(folder / "none"), AllOf(HasSubstr("none"), HasSubstr("No such file")));
    EXPECT_THAT(refusal(folder.path().string()), HasSubstr("cannot go on from"));
    put(folder / "foreign", "frame,x,y\n0,1,2\n");
    EXPECT_THAT(refusal(folder / "foreign"), HasSubstr("not a checkpoint"));
    write_checkpoint(sample(), folder / "c");
    std::string other = bytes_of(folder / "c");
    other[22] = 9;
    put(folder / "other", other);
    EXPECT_THAT(refusal(folder / "other"), HasSubstr("format version 9"));
}

TEST(CheckpointFile, AnUnwritableFolderIsAnOutputError) {
    EXPECT_THROW(write_checkpoint(sample(), "/nonexistent/folder/c"), OutputError);
}

TEST(CheckpointFile, ShowsEachOptionThatDiffers) {
    Checkpoint checkpoint;
    checkpoint.configuration = {{"nu", "0.01"}, {"grid", "64"}, {"old", "1"}};
    EXPECT_NO_THROW(require_same_configuration(
        checkpoint, {{"grid", "64"}, {"old", "1"}, {"nu", "0.01"}}, "c"));
    try {
        require_same_configuration(checkpoint, {{"nu", "0.003"}, {"grid", "64"}, {"new", "2"}},
                                   "run.checkpoint");
        FAIL() << "accepted";
    } catch (const InputError& error) {
        EXPECT_THAT(
            error.what(),
            AllOf(HasSubstr("run.checkpoint"), HasSubstr("nu: 0.01 in the checkpoint, 0.003 now"),
                  HasSubstr("old: 1 in the checkpoint, absent now"),
                  HasSubstr("new: absent in the checkpoint, 2 now"), Not(HasSubstr("grid"))));
    }
}

TEST(CheckpointFile, ThatIsToBeMergedIsRefusedInWordsOfMerging) {
    const testing::ScratchFolder folder;
    const auto refusal_to_merge = [&](auto&& read) -> std::string {
        try {
            read();
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    };
    const std::string path = folder / "part.acc";
    const auto read = [&] { read_checkpoint(path, CheckpointUse::merge); };
    const auto of_merging = AllOf(HasSubstr("cannot merge"), HasSubstr("part.acc"),
                                  HasSubstr("measure that part again"), Not(HasSubstr("go on")),
                                  Not(HasSubstr("resume")), Not(HasSubstr("checkpoint")));
    EXPECT_THAT(refusal_to_merge(read), of_merging) << "missing";
    put(path, "a table");
    EXPECT_THAT(refusal_to_merge(read), of_merging);
    write_checkpoint(sample(), path);
    const std::string whole = bytes_of(path);
    put(path, whole.substr(0, whole.size() / 2));
    EXPECT_THAT(refusal_to_merge(read), of_merging);
    EXPECT_THAT(refusal_to_merge([&] {
                    require_same_configuration(sample(), {{"model.nu", "0.003"}}, path,
                                               CheckpointUse::merge);
                }),
                AllOf(HasSubstr("part.acc' was measured with other options"),
                      HasSubstr("grid.nx: 64 in the part, absent now"),
                      HasSubstr("measure all parts again"), Not(HasSubstr("resume")),
                      Not(HasSubstr("checkpoint"))));
}

}  // namespace
}  // namespace grainfield::io
