#include "pipelines/link/link_job.h"

#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/h5/trajectory_file.h"
#include "pipelines/track/track_job.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A film of 9 small pictures, in which a corner is covered for one frame, so that not every
/// sphere is in every frame.
class LinkJob : public ::testing::Test {
 protected:
    static constexpr int kFrames = 9;

    LinkJob() {
        const testing::LayerScene start = testing::few_discs();
        for (int i = 0; i < kFrames; ++i) {
            Image image = testing::disc_frame(start, i);
            if (i == 5) cover_corner(image);
            paths_.push_back(film_ / fmt::format("frame_{:03}.png", i));
            testing::write_png(paths_.back(), image);
        }
        options_.tracking.stretch = 3;
        options_.tracking.calibration.diameter = testing::kApparentDiameter;
        options_.tracking.calibration.edge_width = testing::kEdgeWidth;
        options_.tracking.sphere_diameter = 10;
        options_.film.region = {8, 4, 176, 180};
    }

    static void cover_corner(Image& image) {
        const float clear = image(0, 0);
        for (int y = 0; y < 64; ++y) {
            std::fill_n(image.row(y), 64, clear);
        }
    }

    void track(const std::string& output, const std::string& frames, bool is_part) {
        TrackJobOptions options = options_;
        options.output = output;
        options.film.frames = frames;
        options.film.is_part = is_part;
        Job job;
        job.inputs.assign(paths_.begin(), paths_.end());
        track_film(options, job);
    }
    std::string part(const std::string& frames) {
        std::string path = folder_ / ("part-" + std::to_string(parts_++) + ".h5");
        track(path, frames, true);
        return path;
    }
    LinkJobResult link(const std::vector<std::string>& parts, LinkJobOptions options = {}) {
        options.output = output_;
        Job job;
        job.overwrite = Overwrite::force;
        job.inputs.assign(parts.begin(), parts.end());
        return link_parts(options, job);
    }
    void expect_same_as(const std::string& whole) {
        io::TrajectoryFile expected(whole);
        io::TrajectoryFile found(output_);
        ASSERT_EQ(found.count(), expected.count());
        EXPECT_EQ(found.info().diameter, expected.info().diameter);
        for (std::int64_t i = 0; i < expected.count(); ++i) {
            const Snapshot a = found.read(i);
            const Snapshot b = expected.read(i);
            EXPECT_EQ(a.frame, b.frame);
            EXPECT_EQ(a.id, b.id) << "frame " << b.frame;
            EXPECT_EQ(a.position, b.position) << "frame " << b.frame;
            EXPECT_EQ(a.position_error, b.position_error);
            EXPECT_EQ(a.quality, b.quality);
            EXPECT_EQ(a.layer, b.layer);
            EXPECT_EQ(a.box.origin, b.box.origin);
        }
        ASSERT_EQ(found.previews().size(), expected.previews().size());
        for (std::size_t i = 0; i < found.previews().size(); ++i) {
            EXPECT_EQ(found.previews()[i].frame.image, expected.previews()[i].frame.image);
            EXPECT_EQ(found.previews()[i].snapshot.id, expected.previews()[i].snapshot.id);
        }
    }

    testing::ScratchFolder film_, folder_;
    std::vector<std::string> paths_;
    TrackJobOptions options_;
    int parts_ = 0;
    const std::string output_ = folder_ / "film.h5";
};

TEST_F(LinkJob, GivesTheTrajectoryOfTheFilmInOnePiece) {
    options_.tracking.layers.height = 1.94;
    const std::string whole = folder_ / "whole.h5";
    track(whole, "::", false);
    // The parts begin in the middle of a stretch.
    const std::vector<std::string> parts{part("7:"), part("0:4"), part("4:7")};
    EXPECT_TRUE(io::TrajectoryFile(parts[1]).read(0).id.empty()) << "a part has no identities";
    const LinkJobResult result = link(parts);
    EXPECT_EQ(result.parts, 3);
    EXPECT_EQ(result.frames, kFrames);
    EXPECT_GT(result.links.bridged, 3) << "spheres come back after frame 5";
    expect_same_as(whole);
}

TEST_F(LinkJob, PartsOfASelectionGiveTheTrajectoryOfTheSelection) {
    options_.film.background = "static";
    const std::string whole = folder_ / "whole.h5";
    track(whole, "1:9:2", false);
    options_.film.part_of = "1:9:2";
    link({part("1:5:2"), part("5:9:2")});
    expect_same_as(whole);
}

TEST_F(LinkJob, GapsAreRefusedByNameOrCountAsMissingFrames) {
    const std::vector<std::string> parts{part("0:3"), part("5:9")};
    EXPECT_THAT([&] { link(parts); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("part-1.h5"), HasSubstr("frames 5 to 8"),
                                                HasSubstr("frames 3 to 4"))));
    EXPECT_THAT([&] { link({parts[0]}); }, ThrowsMessage<InputError>(HasSubstr("frames 3 to 8")));
    EXPECT_FALSE(std::filesystem::exists(output_));
    LinkJobOptions options;
    options.link.memory = 3;
    options.allow_gaps = true;
    const LinkJobResult result = link(parts, options);
    EXPECT_EQ(result.frames, 7);
    EXPECT_GT(result.links.bridged, 0);
}

TEST_F(LinkJob, OverlapsAreRefusedByNameOrTakenOnce) {
    const std::vector<std::string> parts{part("0:7"), part("5:9")};
    EXPECT_THAT([&] { link(parts); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("'" + parts[0] + "' has frames 0 to 6"),
                                                HasSubstr("'" + parts[1] + "' has frames 5"))));
    LinkJobOptions options;
    options.allow_overlaps = true;
    EXPECT_EQ(link(parts, options).frames, kFrames);
    const std::string whole = folder_ / "whole.h5";
    track(whole, "::", false);
    expect_same_as(whole);
}

TEST_F(LinkJob, WhatIsNoPartOfTheSameFilmIsRefused) {
    const std::string first = part("0:6");
    const std::string whole = folder_ / "whole.h5";
    track(whole, "0:6", false);
    EXPECT_THAT([&] { link({whole}); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("whole.h5"), HasSubstr("not a part"))));
    options_.tracking.calibration.diameter = 9.2;
    const std::string wider = part("6:");
    EXPECT_THAT(
        [&] {
            link({first, wider});
        },
        ThrowsMessage<InputError>(
            AllOf(HasSubstr("part-1.h5"), HasSubstr("calibration"), HasSubstr("9.2 px"))));
    options_.tracking.calibration.diameter = testing::kApparentDiameter;
    testing::write_png(paths_[7], testing::disc_frame(testing::few_discs(), 10));
    const std::string other = part("6:");
    EXPECT_THAT(
        [&] {
            link({first, other});
        },
        ThrowsMessage<InputError>(
            AllOf(HasSubstr("part-2.h5"), HasSubstr("film"), HasSubstr("frame_007.png"))));
}

}  // namespace
}  // namespace grainfield::pipelines
