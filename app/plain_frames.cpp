#include "app/plain_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/parallel.h"
#include "core/random.h"

namespace grainfield::app {

namespace {

constexpr int kFiner = 3;      // sub-pixels per pixel and axis
constexpr int kBandRows = 64;  // of pixels; bands are independent of one another

/// A part of the frame at the finer resolution: darkness, row by row.
struct FineBand {
    int width = 0, rows = 0;
    int first_row = 0;  // in the finer grid of the frame
    std::vector<float> darkness;
    float* row(int y) { return darkness.data() + static_cast<std::ptrdiff_t>(y) * width; }
};

/// Anti-aliased: the share of a sub-pixel within `radius`, for an edge that is straight on it.
float coverage(float radius, float r) {
    return std::clamp(radius - r + 0.5F, 0.0F, 1.0F);
}

void add_sphere(FineBand& band, Vec2 centre, float radius, float core, float rim) {
    const auto x0 = static_cast<int>(std::floor(centre.x - static_cast<double>(radius) - 1));
    const auto x1 = static_cast<int>(std::ceil(centre.x + static_cast<double>(radius) + 1));
    const auto y0 = static_cast<int>(std::floor(centre.y - static_cast<double>(radius) - 1));
    const auto y1 = static_cast<int>(std::ceil(centre.y + static_cast<double>(radius) + 1));
    for (int y = std::max(y0, 0); y <= std::min(y1, band.rows - 1); ++y) {
        float* row = band.row(y);
        const auto dy = static_cast<float>(y - centre.y);
        for (int x = std::max(x0, 0); x <= std::min(x1, band.width - 1); ++x) {
            const auto dx = static_cast<float>(x - centre.x);
            const float r = std::sqrt(dx * dx + dy * dy);
            const float dark = rim * coverage(radius, r) + (1 - rim) * coverage(core, r);
            row[x] = std::max(row[x], dark);
        }
    }
}

/// Weights of a Gaussian and of the mean over a pixel's sub-pixels in one.
std::vector<float> kernel_of(double sigma) {
    const int reach = static_cast<int>(std::ceil(4 * sigma)) + kFiner / 2;
    std::vector<float> kernel;
    double sum = 0;
    for (int i = -reach; i <= reach; ++i) {
        double weight = 0;
        for (int s = -(kFiner / 2); s <= kFiner / 2; ++s) {
            const double d = i - s;
            weight += sigma > 0 ? std::exp(-d * d / (2 * sigma * sigma)) : (d == 0 ? 1.0 : 0.0);
        }
        kernel.push_back(static_cast<float>(weight));
        sum += weight;
    }
    for (float& w : kernel) w /= static_cast<float>(sum);
    return kernel;
}

}  // namespace

OptionTable describe(PlainFrameOptions& o) {
    OptionTable t("camera");
    t.integer("width", o.width, "px", {64, 20000}, "of a frame");
    t.integer("height", o.height, "px", {64, 20000}, "of a frame");
    t.number("scale", o.scale, "px", {3, 500}, "pixels per sphere diameter a");
    t.number("rim-darkness", o.rim_darkness, "-", {0, 1},
             "of the rim of a mirror-like sphere; 1: a plain silhouette");
    t.number("blur", o.blur, "a", {0, 1}, "σ of the point spread");
    t.number("vignetting", o.vignetting, "-", {0, 0.9}, "loss of light in the corners");
    t.number("electrons", o.electrons, "-", {1, 1e9}, "at full scale: shot noise");
    t.number("read-noise", o.read_noise, "-", {0, 1e6}, "electrons");
    t.number("exposure", o.exposure, "-", {0.01, 10}, "brightest background over full scale");
    return t;
}

PlainFrames::PlainFrames(SnapshotSource& trajectory, const PlainFrameOptions& options,
                         std::uint64_t seed, int threads)
    : trajectory_(trajectory), options_(options), seed_(seed), threads_(threads) {
    last_.index = -1;
}

Snapshot PlainFrames::truth(std::int64_t index) const {
    const Snapshot source = trajectory_.read(index);
    const double diameter = trajectory_.info().diameter;
    const double scale = options_.scale / diameter;
    const Vec2 middle = source.box.origin + 0.5 * source.box.length;
    const Vec2 centre{(options_.width - 1) / 2.0, (options_.height - 1) / 2.0};
    const double margin = options_.scale;
    Snapshot truth;
    truth.frame = index;
    truth.time = source.time;
    truth.box.origin = {-0.5, -0.5};
    truth.box.length = {options_.width + 0.0, options_.height + 0.0};
    for (std::size_t i = 0; i < source.size(); ++i) {
        const Vec2 p = centre + scale * (source.position[i] - middle);
        if (p.x < -margin || p.y < -margin || p.x > options_.width - 1 + margin ||
            p.y > options_.height - 1 + margin) {
            continue;
        }
        truth.position.push_back(p);
        truth.id.push_back(source.id.empty() ? static_cast<std::int64_t>(i) : source.id[i]);
        if (source.z.empty() || source.box.height <= 0) continue;
        truth.layer.push_back(source.z[i] > source.box.height / 2 ? Layer::top : Layer::bottom);
    }
    return truth;
}

void PlainFrames::draw_band(Image& image, const std::vector<Vec2>& centres, int first_row, int rows,
                            std::uint64_t frame) const {
    const std::vector<float> kernel = kernel_of(options_.blur * options_.scale * kFiner);
    const auto reach = static_cast<int>(kernel.size() / 2);
    FineBand band{kFiner * options_.width + 2 * reach,
                  kFiner * rows + 2 * reach,
                  kFiner * first_row - reach,
                  {}};
    band.darkness.assign(static_cast<std::size_t>(band.width) * static_cast<std::size_t>(band.rows),
                         0.0F);
    const double radius = kFiner * options_.scale / 2;
    for (const Vec2 c : centres) {
        // Pixel x covers the sub-pixels 3x, 3x + 1, 3x + 2, its centre being the middle one.
        const Vec2 fine{kFiner * c.x + kFiner / 2 + reach,
                        kFiner * c.y + kFiner / 2 - band.first_row};
        if (fine.y < -radius - 2 || fine.y > band.rows + radius + 2) continue;
        add_sphere(band, fine, static_cast<float>(radius),
                   static_cast<float>(radius / std::numbers::sqrt2),
                   static_cast<float>(options_.rim_darkness));
    }
    // Down the columns at the rows of pixels, then along these rows at the pixels.
    std::vector<float> column(static_cast<std::size_t>(band.width));
    for (int y = 0; y < rows; ++y) {
        std::fill(column.begin(), column.end(), 0.0F);
        const int middle = kFiner * y + kFiner / 2 + reach;
        for (int i = -reach; i <= reach; ++i) {
            const float w = kernel[static_cast<std::size_t>(i + reach)];
            const float* from = band.row(middle + i);
            for (int x = 0; x < band.width; ++x) column[static_cast<std::size_t>(x)] += w * from[x];
        }
        float* out = image.row(first_row + y);
        for (int x = 0; x < options_.width; ++x) {
            const float* from = column.data() + kFiner * x + kFiner / 2;
            float sum = 0;
            for (std::size_t i = 0; i < kernel.size(); ++i) sum += kernel[i] * from[i];
            out[x] = sum;
        }
    }
    const double half = std::hypot(options_.width, options_.height) / 2;
    for (int y = first_row; y < first_row + rows; ++y) {
        RandomStream random(
            seed_, "camera noise",
            frame * static_cast<std::uint64_t>(options_.height) + static_cast<std::uint64_t>(y));
        float* out = image.row(y);
        for (int x = 0; x < options_.width; ++x) {
            const double r = std::hypot(x - options_.width / 2.0, y - options_.height / 2.0) / half;
            const double light = options_.exposure * (1 - options_.vignetting * r * r) *
                                 (1 - 0.97 * static_cast<double>(out[x]));
            const double electrons = options_.electrons * light;
            const double noise = std::sqrt(electrons + options_.read_noise * options_.read_noise);
            const double counts = 255 * (electrons + noise * random.normal()) / options_.electrons;
            out[x] = static_cast<float>(std::lround(std::clamp(counts, 0.0, 255.0)));
        }
    }
}

TrajectoryInfo PlainFrames::truth_info() const {
    TrajectoryInfo info = trajectory_.info();
    info.origin = Origin::rendered;
    info.length_unit = LengthUnit::pixel;
    info.diameter = options_.scale;
    return info;
}

Frame PlainFrames::read(std::int64_t index) {
    if (last_.index == index) return last_;
    Frame frame;
    frame.index = index;
    frame.image = Image(options_.width, options_.height);
    const Snapshot truth = this->truth(index);
    frame.time = truth.time;
    const std::int64_t bands = (options_.height + kBandRows - 1) / kBandRows;
    parallel_for(bands, threads_, [&](std::int64_t band) {
        const int first = static_cast<int>(band) * kBandRows;
        draw_band(frame.image, truth.position, first, std::min(kBandRows, options_.height - first),
                  static_cast<std::uint64_t>(index));
    });
    last_ = frame;
    return frame;
}

}  // namespace grainfield::app
