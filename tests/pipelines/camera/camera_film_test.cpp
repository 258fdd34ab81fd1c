// A layer seen through a lens that distorts, by a camera that is tilted, against the same layer
// seen straight.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/analysis.h"
#include "analysis/order/bond_order.h"
#include "analysis/spectra/structure_factor.h"
#include "core/memory_frames.h"
#include "tests/support/layer_frames.h"
#include "tests/support/tilted_camera.h"
#include "tracking/camera/camera_fit.h"
#include "tracking/tracking.h"

namespace grainfield {
namespace {

using testing::held;
using testing::Pose;
using testing::TiltedCamera;
using tracking::BoardView;
using tracking::Camera;
using tracking::CameraMap;

constexpr int kFrames = 2;
constexpr double kDiameter = 12;   // of the spheres in the plane, and about that in px
constexpr double kApparent = 10;   // of their discs
constexpr Vec2 kMiddle{280, 220};  // of the layer
constexpr double kPitch = 36;      // of the dots of the plate
constexpr double kNoise = 2;       // counts

/// A layer larger than the frame.
std::vector<Vec2> layer(std::uint64_t seed) {
    return testing::hard_disc_liquid(560, 440, kDiameter, 0.45, seed).position;
}

std::vector<Vec2> plate() {
    std::vector<Vec2> dots;
    for (double y = -20; y < 470; y += kPitch) {
        for (double x = -20; x < 590; x += kPitch) dots.push_back({x, y});
    }
    return dots;
}

struct Seen {
    std::vector<Snapshot> snapshots;
    double diameter = 0;  ///< D that was calibrated [px]
};

Seen tracked(std::vector<Image> images, const std::optional<CameraMap>& map) {
    MemoryFrames frames(std::move(images));
    tracking::TrackOptions options;
    options.camera = map;
    options.threads = 1;
    options.link.search_range = 1;  // layers of their own: identities mean nothing
    Trajectory found = tracking::track(frames, options);
    return {std::move(found.snapshots), found.info.diameter};
}

/// What is measured of a film whose positions lie in this box.
struct Measured {
    std::vector<double> k, s;
    double spacing = 0, order = 0;
    double spheres = 0;
};

Measured measured(const std::vector<Snapshot>& snapshots, const Box& box) {
    Trajectory film;
    film.info.length_unit = LengthUnit::pixel;
    film.info.diameter = kDiameter;
    film.info.diameter_origin = DiameterOrigin::given;
    Measured result;
    double count = 0;
    for (const Snapshot& from : snapshots) {
        Snapshot inside;
        inside.frame = from.frame;
        inside.time = from.time;
        inside.box = box;
        for (const Vec2 p : from.position) {
            if (box.contains(p)) inside.position.push_back(p);
        }
        const auto field = analysis::bond_order(analysis::pattern_of(inside, kDiameter), {});
        for (std::size_t i = 0; i < field.q.size(); ++i) {
            if (!std::isfinite(field.mean_four[i]) || !std::isfinite(field.q[i].real())) continue;
            result.spacing += field.mean_four[i];
            result.order += std::abs(field.q[i]);
            ++count;
        }
        result.spheres += static_cast<double>(inside.size());
        film.snapshots.push_back(std::move(inside));
    }
    result.spacing /= count;
    result.order /= count;
    analysis::AnalysisOptions options;
    options.observables = {"sk"};
    options.of<analysis::StructureFactorOptions>().k_max = 8;
    const Results results = analysis::measure(film, options);
    const Curve* curve = results.find("sk")->find_curve("sk_raw");
    result.k = curve->find("k")->values;
    result.s = curve->find("s")->values;
    return result;
}

/// The turn, the scale known, and the shift that bring places nearest to positions.
struct Rigid {
    double scale = 1, angle = 0;
    Vec2 from, to;

    Vec2 operator()(Vec2 place) const {
        const Vec2 w = scale * (place - from);
        return to + Vec2{w.x * std::cos(angle) - w.y * std::sin(angle),
                         w.x * std::sin(angle) + w.y * std::cos(angle)};
    }
};

Rigid rigid(const std::vector<Vec2>& place, const std::vector<Vec2>& position, double scale) {
    Rigid map;
    map.scale = scale;
    const double weight = 1 / static_cast<double>(place.size());
    for (std::size_t i = 0; i < place.size(); ++i) {
        map.from += weight * place[i];
        map.to += weight * position[i];
    }
    double along = 0;
    double across = 0;
    for (std::size_t i = 0; i < place.size(); ++i) {
        const Vec2 w = place[i] - map.from;
        const Vec2 f = position[i] - map.to;
        along += dot(w, f);
        across += w.x * f.y - w.y * f.x;
    }
    map.angle = std::atan2(across, along);
    return map;
}

/// The layer as both cameras see it, and what the tilted one was calibrated to be.
class TiltedFilm : public ::testing::Test {
 protected:
    static void SetUpTestSuite() {
        const Pose cell = held({0.06, -0.04, 0.02}, kMiddle, truth.focal);
        std::vector<BoardView> views;
        for (const Pose& pose : {cell, held({0.35, 0, 0}, kMiddle, 1.3 * truth.focal),
                                 held({-0.1, 0.35, 0.3}, kMiddle, 1.2 * truth.focal)}) {
            views.push_back(tracking::find_dots(truth.discs(plate(), 11, pose, kNoise, 1), 1));
        }
        // One unit of the plane is a pixel of the straight camera.
        camera =
            tracking::fit_camera(views, 0, truth.width, truth.height, tracking::PlaneScale{kPitch})
                .camera;
        TiltedCamera straight = truth;
        straight.k1 = straight.k2 = straight.p1 = straight.p2 = 0;
        const Pose above = held({0, 0, 0}, kMiddle, straight.focal);
        std::vector<Image> tilted_frames;
        std::vector<Image> straight_frames;
        for (std::uint64_t i = 0; i < kFrames; ++i) {
            layers.push_back(layer(i));
            tilted_frames.push_back(truth.discs(layers[i], kApparent, cell, kNoise, 10 + i));
            straight_frames.push_back(straight.discs(layers[i], kApparent, above, kNoise, 20 + i));
            for (const Vec2 place : layers[i]) {
                in_picture.push_back(truth.seen(place, cell));
                in_straight.push_back(straight.seen(place, above));
            }
        }
        corrected = tracked(std::move(tilted_frames), CameraMap(camera));
        undistorted = tracked(std::move(straight_frames), {});
        // From the straight picture to corrected pixels: the scale is the camera's word.
        std::vector<Vec2> wanted;
        std::vector<Vec2> found;
        const CameraMap map(camera);
        for (std::size_t i = 0; i < in_picture.size(); ++i) {
            const Vec2 p = in_picture[i];
            if (p.x < 0 || p.y < 0 || p.x > truth.width || p.y > truth.height) continue;
            wanted.push_back(in_straight[i]);
            found.push_back(map.corrected(p).position);
        }
        to_corrected = rigid(wanted, found, 1 / camera.scale->length);
        for (Snapshot& snapshot : undistorted.snapshots) {
            for (Vec2& p : snapshot.position) p = to_corrected(p);
        }
        // What all three have seen whole.
        box = map.box(truth.width, truth.height);
        box.origin += Vec2{22, 22};
        box.length -= Vec2{44, 44};
    }

    static inline TiltedCamera truth{
        .width = 480, .height = 360, .focal = 900, .centre = {243.5, 176}};
    static inline Camera camera;
    static inline Seen corrected, undistorted;
    static inline std::vector<std::vector<Vec2>> layers;
    static inline std::vector<Vec2> in_picture, in_straight;
    static inline Rigid to_corrected;
    static inline Box box;
};

TEST_F(TiltedFilm, HasNoSystematicErrorAboveAFiftiethOfAPixel) {
    constexpr int columns = 3, rows = 2;
    std::array<Vec2, columns * rows> sum{};
    std::array<double, columns * rows> count{};
    double squares = 0, all = 0, reported = 0;
    std::size_t first = 0;
    for (std::size_t f = 0; f < layers.size(); ++f) {
        const Snapshot& snapshot = corrected.snapshots[f];
        for (std::size_t i = 0; i < layers[f].size(); ++i) {
            const Vec2 wanted = to_corrected(in_straight[first + i]);
            if (!box.contains(wanted)) continue;
            double least = 1;
            Vec2 error;
            double own = 0;
            for (std::size_t j = 0; j < snapshot.size(); ++j) {
                const Vec2 d = snapshot.position[j] - wanted;
                if (norm(d) >= least) continue;
                least = norm(d);
                error = d;
                own = squared_norm(snapshot.position_error[j]);
            }
            ASSERT_LT(least, 1) << "a sphere was missed";
            const Vec2 within = wanted - box.origin;
            const auto block = static_cast<std::size_t>(within.x / box.length.x * columns) +
                               columns * static_cast<std::size_t>(within.y / box.length.y * rows);
            sum[block] += error;
            ++count[block];
            squares += squared_norm(error);
            reported += own;
            ++all;
        }
        first += layers[f].size();
    }
    for (std::size_t b = 0; b < sum.size(); ++b) {
        EXPECT_GT(count[b], 100);
        // Noise of some 0.03 px leaves 0.003 px to the mean of a hundred.
        EXPECT_LT(norm((1 / count[b]) * sum[b]), 0.02) << "block " << b;
    }
    // The size of the discs changes over a tilted frame, which may make errors too large.
    const double pull = std::sqrt(squares / reported);
    RecordProperty("rms_pull", std::to_string(pull));
    EXPECT_LT(pull, 1);
    EXPECT_GT(all, 1000);
}

TEST_F(TiltedFilm, HasTheSpectrumSpacingAndOrderOfTheUndistortedOne) {
    const Measured is = measured(corrected.snapshots, box);
    const Measured wanted = measured(undistorted.snapshots, box);
    std::vector<Snapshot> as_seen = undistorted.snapshots;
    std::size_t first = 0;
    for (std::size_t f = 0; f < layers.size(); ++f) {
        const auto begin = in_picture.begin() + static_cast<std::ptrdiff_t>(first);
        as_seen[f].position.assign(begin, begin + static_cast<std::ptrdiff_t>(layers[f].size()));
        first += layers[f].size();
    }
    const Measured raw = measured(as_seen, box);
    ASSERT_EQ(is.s.size(), wanted.s.size());
    double largest = 0;
    double as_seen_largest = 0;
    for (std::size_t i = 0; i < is.s.size(); ++i) {
        largest = std::max(largest, std::abs(is.s[i] / wanted.s[i] - 1));
        as_seen_largest = std::max(as_seen_largest, std::abs(raw.s[i] / wanted.s[i] - 1));
    }
    RecordProperty("largest_change_of_s", std::to_string(largest));
    // Noise of 0.006 px is 5e-4 a: at k = 8/a it changes a mode by 0.4 % of its root.
    EXPECT_GT(is.k.back(), 7);
    EXPECT_LT(largest, 0.01);
    // Without the correction all of it is wrong by more than what is allowed.
    EXPECT_GT(as_seen_largest, 0.1);
    EXPECT_GT(std::abs(raw.spacing / wanted.spacing - 1), 0.01);
    EXPECT_EQ(is.spheres, wanted.spheres);
    EXPECT_NEAR(is.spacing, wanted.spacing, 1e-4 * wanted.spacing);
    EXPECT_NEAR(is.order, wanted.order, 1e-3);
}

}  // namespace
}  // namespace grainfield
