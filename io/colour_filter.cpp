#include "io/colour_filter.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "core/errors.h"
#include "core/image_mat.h"
#include "io/passed_frames.h"

namespace grainfield::io {

namespace {

constexpr std::size_t red = 0, green = 1, blue = 2;

/// Colours of the first two pixels of the first two rows.
std::array<std::size_t, 4> cell_of(ColourFilter filter) {
    switch (filter) {
        case ColourFilter::grbg:
            return {green, red, blue, green};
        case ColourFilter::gbrg:
            return {green, blue, red, green};
        case ColourFilter::bggr:
            return {blue, green, green, red};
        case ColourFilter::rggb:
        case ColourFilter::none:
            break;
    }
    return {red, green, green, blue};
}

// OpenCV names a filter by the second and third pixel of the second row: RGGB is its "BG".
int grey_code(ColourFilter filter) {
    switch (filter) {
        case ColourFilter::grbg:
            return cv::COLOR_BayerGB2GRAY;
        case ColourFilter::gbrg:
            return cv::COLOR_BayerGR2GRAY;
        case ColourFilter::bggr:
            return cv::COLOR_BayerRG2GRAY;
        case ColourFilter::rggb:
        case ColourFilter::none:
            break;
    }
    return cv::COLOR_BayerBG2GRAY;
}

int colour_code(ColourFilter filter) {
    switch (filter) {
        case ColourFilter::grbg:
            return cv::COLOR_BayerGB2RGB;
        case ColourFilter::gbrg:
            return cv::COLOR_BayerGR2RGB;
        case ColourFilter::bggr:
            return cv::COLOR_BayerRG2RGB;
        case ColourFilter::rggb:
        case ColourFilter::none:
            break;
    }
    return cv::COLOR_BayerBG2RGB;
}

class DemosaicedFrames : public PassedFrames {
 public:
    DemosaicedFrames(std::unique_ptr<FrameSource> source, ColourFilter filter,
                     MosaicChannel channel)
        : PassedFrames(std::move(source)), filter_(filter), channel_(channel) {}

    Frame read(std::int64_t index) override {
        Frame frame = source().read(index);
        if (frame.status == FrameStatus::ok) {
            frame.image = demosaiced(frame.image, filter_, channel_);
        }
        return frame;
    }

 private:
    ColourFilter filter_;
    MosaicChannel channel_;
};

}  // namespace

const char* name_of(ColourFilter filter) {
    static constexpr std::array names{"none", "RGGB", "GRBG", "GBRG", "BGGR"};
    return names[static_cast<std::size_t>(filter)];
}

const char* name_of(MosaicChannel channel) {
    static constexpr std::array names{"grey", "best", "red", "green", "blue"};
    return names[static_cast<std::size_t>(channel)];
}

std::array<double, 3> contrasts_of(const Image& mosaic, ColourFilter filter) {
    const std::array<std::size_t, 4> cell = cell_of(filter);
    std::array<std::vector<float>, 3> counts;
    for (int y = 0; y < mosaic.height(); ++y) {
        for (int x = 0; x < mosaic.width(); ++x) {
            const auto pixel = static_cast<std::size_t>(2 * (y % 2) + x % 2);
            counts[cell[pixel]].push_back(mosaic(x, y));
        }
    }
    std::array<double, 3> contrasts{};
    for (std::size_t c = 0; c < counts.size(); ++c) {
        std::vector<float>& values = counts[c];
        if (values.empty()) continue;
        const auto percentile = [&](double share) {
            const auto rank =
                static_cast<std::ptrdiff_t>(share * (static_cast<double>(values.size()) - 1));
            std::ranges::nth_element(values, values.begin() + rank);
            return static_cast<double>(values[static_cast<std::size_t>(rank)]);
        };
        const double low = percentile(0.02);
        contrasts[c] = percentile(0.98) - low;
    }
    return contrasts;
}

Image demosaiced(const Image& mosaic, ColourFilter filter, MosaicChannel channel) {
    if (filter == ColourFilter::none) return mosaic;
    if (mosaic.width() < 4 || mosaic.height() < 4) {
        throw InputError({.problem = "a frame is too small for a mosaic of colours",
                          .actual = fmt::format("{} x {} px", mosaic.width(), mosaic.height()),
                          .expected = "at least 4 x 4 px",
                          .suggestion = {}});
    }
    cv::Mat counts;
    as_mat(mosaic).convertTo(counts, CV_16U);
    cv::Mat made;
    if (channel == MosaicChannel::grey) {
        cv::cvtColor(counts, made, grey_code(filter));
        return from_mat(made);
    }
    cv::cvtColor(counts, made, colour_code(filter));
    cv::Mat plane;
    cv::extractChannel(made, plane,
                       channel == MosaicChannel::red     ? static_cast<int>(red)
                       : channel == MosaicChannel::green ? static_cast<int>(green)
                                                         : static_cast<int>(blue));
    return from_mat(plane);
}

std::unique_ptr<FrameSource> demosaic_frames(std::unique_ptr<FrameSource> source,
                                             ColourFilter filter, MosaicChannel channel) {
    if (filter == ColourFilter::none) return source;
    return std::make_unique<DemosaicedFrames>(std::move(source), filter, channel);
}

}  // namespace grainfield::io
