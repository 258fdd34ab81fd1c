#include "pipelines/render/kept_frames.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/frame_files.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

/// 7 × 5 px: no multiple of what the log's numbers hold, 8 bytes.
constexpr int width = 7;
constexpr int height = 5;

Frame frame_of(int index, int bits) {
    Frame frame;
    frame.index = index;
    frame.bit_depth = bits;
    frame.image = Image(width, height);
    for (std::size_t i = 0; i < frame.image.size(); ++i) {
        frame.image.pixels()[i] = static_cast<float>(
            (static_cast<unsigned>(index) * 977U + i * 613U) % (1U << static_cast<unsigned>(bits)));
    }
    return frame;
}

class FramesThatAreKept : public ::testing::TestWithParam<int> {
 protected:
    struct Run {
        Run(const FramesThatAreKept& test, const std::string& name, bool resume)
            : is_video(io::is_video_name(name)),
              resumable(job, test.identity(name),
                        {.resume = resume, .every = std::chrono::hours(1)}),
              options{.width = width, .height = height, .bit_depth = GetParam(), .fps = 25},
              writer(io::make_frame_writer(test.folder_ / name, options, resumable.overwrite())) {
            resumable.start();
            kept = std::make_unique<KeptFrames>(resumable, *writer, options, is_video);
        }

        Job job;
        bool is_video;
        Resumable resumable;
        io::FrameWriterOptions options;
        std::unique_ptr<io::FrameWriter> writer;
        std::unique_ptr<KeptFrames> kept;
    };

    Resumable::Identity identity(const std::string& name) const {
        return {.kind = "render",
                .output = folder_ / name,
                .log = io::is_video_name(name) ? KeptFrames::log_suffix : "",
                .configuration = {}};
    }

    /// Five frames, of which four are vouched for.
    void leave_killed_run(const std::string& name) {
        Run run(*this, name, false);
        for (int i = 0; i < 5; ++i) {
            if (i == 4) run.kept->save(4);
            run.kept->write(frame_of(i, GetParam()));
        }
    }

    testing::ScratchFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Bits, FramesThatAreKept, ::testing::Values(8, 12, 16));

TEST_P(FramesThatAreKept, OfAVideoComeBackWithEveryCount) {
    leave_killed_run("film.mkv");
    Run run(*this, "film.mkv", true);
    ASSERT_EQ(run.kept->done(), 4);
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(run.kept->restore(i));
    run.kept->write(frame_of(4, GetParam()));
    EXPECT_EQ(run.resumable.log().count(), 5);
    run.writer->finish();
    const auto frames = io::open_frames({folder_ / "film.mkv"}, {});
    ASSERT_EQ(frames->count(), 5);
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(frames->read(i).image, frame_of(i, GetParam()).image) << i;
    }
}

TEST_P(FramesThatAreKept, OfAFolderAreThePicturesThatAreThere) {
    leave_killed_run("frames");
    std::filesystem::remove(folder_ / "frames/frame-000002.tif");
    const Run run(*this, "frames", true);
    ASSERT_EQ(run.kept->done(), 4);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(run.kept->restore(i), i != 2) << i;
}

TEST_P(FramesThatAreKept, OfAnotherSizeAreRefused) {
    leave_killed_run("film.mkv");
    Run run(*this, "film.mkv", true);
    io::FrameWriterOptions wider = run.options;
    wider.width += 10;
    KeptFrames kept(run.resumable, *run.writer, wider, true);
    EXPECT_THROW(kept.restore(0), InputError);
}

TEST_P(FramesThatAreKept, AFolderIsVouchedForBeforeItsFirstPicture) {
    {
        const Run run(*this, "frames", false);
        EXPECT_TRUE(std::filesystem::exists(run.resumable.checkpoint_path()));
    }
    const Run again(*this, "frames", true);
    EXPECT_EQ(again.kept->done(), 0);
}

TEST_P(FramesThatAreKept, ACheckpointThatDoesNotSayHowManyIsRefused) {
    {
        Run run(*this, "film.mkv", false);
        run.resumable.save({});
    }
    EXPECT_THROW(Run(*this, "film.mkv", true), InputError);
}

}  // namespace
}  // namespace grainfield::pipelines
