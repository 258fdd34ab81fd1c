// The real frame of a vibrated layer (provenance in its README); skipped when it is not there.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>
#include <tiffio.h>

#include "tracking/calibrate/calibration.h"
#include "tracking/calibrate/edge_fit.h"
#include "tracking/refine/disc_kernel.h"
#include "tracking/score/match_positions.h"

namespace grainfield::tracking {
namespace {

const std::filesystem::path kFrame =
    std::filesystem::path(GRAINFIELD_SOURCE_DIR) / "../shared/data/vibrated_layer_frame.tif";

Image read_tiff(const std::filesystem::path& path) {
    TIFF* tiff = TIFFOpen(path.c_str(), "r");
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
    Image image(static_cast<int>(width), static_cast<int>(height));
    std::vector<unsigned char> row(width);
    for (std::uint32_t y = 0; y < height; ++y) {
        TIFFReadScanline(tiff, row.data(), y, 0);
        std::copy(row.begin(), row.end(), image.row(static_cast<int>(y)));
    }
    TIFFClose(tiff);
    return image;
}

class RealFrame : public ::testing::Test {
 protected:
    static void SetUpTestSuite() {
        if (!std::filesystem::exists(kFrame)) return;
        frame_ = read_tiff(kFrame);
        RunPlan plan;
        calibration_ = calibrate(frame_, {}, {}, {}, 2, plan);
        if (!calibration_) return;
        Locator locator(frame_.width(), frame_.height(), calibration_->model.disc, 2);
        found_ =
            locator.locate(calibration_->model.darkness(frame_), {}, {}, calibration_->positions);
        transmission_ = locator.transmission();
    }
    void SetUp() override {
        if (!std::filesystem::exists(kFrame)) GTEST_SKIP() << "no " << kFrame;
        ASSERT_TRUE(calibration_);
    }

    static inline Image frame_;
    static inline std::optional<Calibration> calibration_;
    static inline Located found_;
    static inline std::optional<PaddedImage> transmission_;
};

TEST_F(RealFrame, HoldsBetween10050And10650Spheres) {
    EXPECT_GE(found_.position.size(), 10050u);
    EXPECT_LE(found_.position.size(), 10650u);
}

TEST_F(RealFrame, NoPairIsCloserThanTheCellHeightAllows) {
    double nearest = 1e9;
    for (std::size_t i = 0; i < found_.position.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            nearest = std::min(nearest, squared_norm(found_.position[i] - found_.position[j]));
        }
    }
    EXPECT_GE(std::sqrt(nearest), 0.34 * 10.09);
}

TEST_F(RealFrame, ExposedEdgesGiveTheKnownDiameterAndWidth) {
    const EdgeFit edges = fit_exposed_edges(calibration_->model.darkness(frame_), found_.position,
                                            calibration_->model.disc);
    EXPECT_NEAR(edges.disc.diameter, 8.9, 0.3);
    EXPECT_NEAR(edges.disc.edge_width, 1.25, 0.15);
}

TEST_F(RealFrame, TheResidualShowsNoSphere) {
    EXPECT_LT(found_.residual_rms, 0.085);
    // A missing sphere would leave a gain of at least half of what the faintest accepted one has.
    const DiscProfile& disc = calibration_->model.disc;
    DiscCorrelation correlation(frame_.width(), frame_.height(), disc, 1);
    const Image gain = correlation.gain(padded_darkness(calibration_->model.darkness(frame_), disc),
                                        *transmission_);
    int remnants = 0;
    for (int y = 12; y < gain.height() - 12; ++y) {
        for (int x = 12; x < gain.width() - 12; ++x) {
            remnants += static_cast<double>(gain(x, y)) > 0.25 * correlation.full_gain();
        }
    }
    EXPECT_EQ(remnants, 0);
}

TEST_F(RealFrame, TheCrystalHasItsProjectedSpacing) {
    // Median distance of the four nearest, over spheres of the patch in the middle.
    std::vector<double> spacing;
    for (const Vec2 p : found_.position) {
        if (std::abs(p.x - 460) > 90 || std::abs(p.y - 560) > 90) continue;
        std::vector<double> distances;
        for (const Vec2 q : found_.position) {
            const double d = norm(q - p);
            if (d > 0 && d < 30) distances.push_back(d);
        }
        std::partial_sort(distances.begin(), distances.begin() + 4, distances.end());
        spacing.push_back((distances[0] + distances[1] + distances[2] + distances[3]) / 4);
    }
    std::nth_element(spacing.begin(),
                     spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2),
                     spacing.end());
    EXPECT_NEAR(spacing[spacing.size() / 2] / 10.09, 0.81, 0.02);
}

}  // namespace
}  // namespace grainfield::tracking
