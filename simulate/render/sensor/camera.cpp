#include "simulate/render/sensor/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/support/parallel.h"
#include "core/support/random.h"
#include "simulate/render/sensor/gaussian_blur.h"
#include "simulate/render/sensor/sensor_row.h"

namespace grainfield::simulate {

namespace {

constexpr float exact_below = 20;  // electrons
constexpr int rows_per_band = 32;

double full_scale_of(const SensorOptions& sensor) {
    return std::exp2(sensor.bits) - 1;
}

void add_dust(const LightOptions& light, double scale, std::uint64_t seed, Image& map) {
    RandomStream random(seed, "render dust");
    for (int i = 0; i < light.dust; ++i) {
        const double x = random.uniform(0, map.width());
        const double y = random.uniform(0, map.height());
        const double diameter = random.uniform(0.2, 1.0) * scale;
        const double depth = 1 - random.uniform(0.5, 0.9);
        // Out of focus: a Gaussian whose width at half depth is the diameter.
        const double sigma = std::max(diameter / 2.355, 0.3);
        const auto reach = static_cast<int>(std::ceil(4 * sigma));
        const int x0 = static_cast<int>(x);
        const int y0 = static_cast<int>(y);
        for (int row = std::max(0, y0 - reach); row <= std::min(map.height() - 1, y0 + reach);
             ++row) {
            for (int column = std::max(0, x0 - reach);
                 column <= std::min(map.width() - 1, x0 + reach); ++column) {
                const double r2 = (column - x) * (column - x) + (row - y) * (row - y);
                map(column, row) *=
                    static_cast<float>(1 - depth * std::exp(-0.5 * r2 / (sigma * sigma)));
            }
        }
    }
}

Image make_map(const LightOptions& light, const View& view, std::uint64_t seed) {
    Image map(view.width(), view.height(), 1.0F);
    const double half_x = view.width() / 2.0;
    const double half_y = view.height() / 2.0;
    const double corner2 = half_x * half_x + half_y * half_y;
    const double angle = light.gradient_angle * std::numbers::pi / 180;
    const double along_x = std::cos(angle);
    const double along_y = std::sin(angle);
    const double extent = half_x * std::abs(along_x) + half_y * std::abs(along_y);
    const double focal = view.scale() * view.distance();
    const double vignetting = light.vignetting ? 1 / (focal * focal) : 0;
    for (int y = 0; y < view.height(); ++y) {
        for (int x = 0; x < view.width(); ++x) {
            const double dx = x + 0.5 - half_x;
            const double dy = y + 0.5 - half_y;
            const double r2 = dx * dx + dy * dy;
            const double cos2 = 1 / (1 + r2 * vignetting);
            const double fall = 0.5 * (1 + (dx * along_x + dy * along_y) / extent);
            map(x, y) = static_cast<float>((1 - light.falloff * r2 / corner2) * cos2 * cos2 *
                                           (1 - light.gradient * fall));
        }
    }
    // At its brightest the panel is 1; dust only takes away.
    const float brightest = *std::max_element(map.pixels().begin(), map.pixels().end());
    if (brightest > 0) {
        for (float& value : map.pixels()) value /= brightest;
    }
    add_dust(light, view.scale(), seed, map);
    return map;
}

Image fixed_pattern(const NoiseStream& noise, double mean, double rms, int width, int height) {
    Image pattern;
    if (rms <= 0) return pattern;
    pattern = Image(width, height);
    for (int y = 0; y < height; ++y) {
        float* row = pattern.row(y);
        noise.normal(0, static_cast<std::uint32_t>(y), {row, static_cast<std::size_t>(width)});
        for (int x = 0; x < width; ++x) row[x] = static_cast<float>(mean + rms * double{row[x]});
    }
    return pattern;
}

// The mean over blocks of n × n pixels.
Image reduce(const Image& fine, int n) {
    if (n == 1) return fine;
    Image coarse(fine.width() / n, fine.height() / n);
    const float weight = 1.0F / static_cast<float>(n * n);
    for (int y = 0; y < coarse.height(); ++y) {
        for (int x = 0; x < coarse.width(); ++x) {
            float sum = 0;
            for (int j = 0; j < n; ++j) {
                const float* row = fine.row(y * n + j) + x * n;
                for (int i = 0; i < n; ++i) sum += row[i];
            }
            coarse(x, y) = weight * sum;
        }
    }
    return coarse;
}

}  // namespace

Camera::Camera(const RenderOptions& options, const View& view, std::uint64_t seed, int threads)
    : options_(options.effective()),
      threads_(threads),
      width_(view.width()),
      height_(view.height()),
      seed_(seed),
      noise_(seed, "render sensor") {
    require_valid(options);
    const SensorOptions& sensor = options_.sensor;
    const double full_scale = full_scale_of(sensor);
    gain_ = sensor.gain.value_or((full_scale - sensor.offset) / sensor.full_well);

    const double blur = options_.light.blur * view.scale();
    if (blur > 0) supersampling_ = std::clamp(static_cast<int>(std::ceil(2 / blur)), 1, 8);
    sigma_ = blur * supersampling_;
    margin_ = (blur_reach(sigma_) + supersampling_ - 1) / supersampling_;

    map_ = make_map(options_.light, view, seed);
    response_ =
        fixed_pattern(NoiseStream(seed, "render response"), 1, sensor.prnu, width_, height_);
    dark_ = fixed_pattern(NoiseStream(seed, "render dark level"), 0, sensor.dsnu, width_, height_);
    RandomStream random(seed, "render defects");
    const auto dead =
        static_cast<std::size_t>(std::llround(sensor.defects * static_cast<double>(map_.size())));
    for (std::size_t i = 0; i < 2 * dead; ++i) {
        const double value = i < dead ? std::round(sensor.offset) : full_scale;
        defects_.push_back({random.below(map_.size()), static_cast<float>(value)});
    }
}

View Camera::radiance_view(const View& view) const {
    return view.padded(margin_).refined(supersampling_);
}

Image Camera::exposure(const Image& radiance) const {
    Image blurred = gaussian_blur(radiance, sigma_, threads_);
    // The margin is whole camera pixels, the blur takes whole radiance pixels.
    const int spare = margin_ * supersampling_ - (sigma_ > 0 ? blur_reach(sigma_) : 0);
    if (spare > 0) {
        Image cut(width_ * supersampling_, height_ * supersampling_);
        for (int y = 0; y < cut.height(); ++y) {
            const float* from = blurred.row(y + spare) + spare;
            std::copy(from, from + cut.width(), cut.row(y));
        }
        blurred = std::move(cut);
    }
    Image exposure = reduce(blurred, supersampling_);
    const auto stray = static_cast<float>(options_.light.stray);
    const std::size_t size = exposure.size();
    float* out = exposure.pixels().data();
    const float* map = map_.pixels().data();
    for (std::size_t i = 0; i < size; ++i) out[i] = ((1.0F - stray) * out[i] + stray) * map[i];
    return exposure;
}

void Camera::develop_row(const Image& exposure, std::int64_t index, int y, Image& counts) const {
    const SensorOptions& sensor = options_.sensor;
    const auto size = static_cast<std::size_t>(width_);
    const SensorTerms terms{static_cast<float>(options_.light.level * sensor.full_well),
                            static_cast<float>(sensor.read_noise),
                            static_cast<float>(gain_),
                            static_cast<float>(sensor.offset),
                            static_cast<float>(sensor.full_well),
                            static_cast<float>(full_scale_of(sensor))};
    thread_local std::vector<float> mean;
    thread_local std::vector<float> electrons;
    thread_local std::vector<float> z;
    mean.resize(size);
    expected_electrons(exposure.row(y), response_.empty() ? nullptr : response_.row(y), width_,
                       terms.electrons, mean.data());
    electrons = mean;
    if (options_.camera == CameraKind::noisy) {
        z.resize(size);
        noise_.normal(static_cast<std::uint64_t>(index) + 1, static_cast<std::uint32_t>(y), z);
        add_noise(z.data(), width_, terms.read_noise, electrons.data());
        // Few electrons are not Gaussian; one stream a row, drawn from where needed.
        RandomStream dim(seed_, "render dim pixels",
                         static_cast<std::uint64_t>(index) * static_cast<std::uint64_t>(height_) +
                             static_cast<std::uint64_t>(y));
        for (std::size_t x = 0; x < size; ++x) {
            if (mean[x] >= exact_below) continue;
            const auto photons = static_cast<float>(dim.poisson(std::max(0.0F, mean[x])));
            electrons[x] = photons + terms.read_noise * z[x];
        }
    }
    quantise(electrons.data(), dark_.empty() ? nullptr : dark_.row(y), width_, terms,
             counts.row(y));
}

Frame Camera::develop(const Image& exposure, std::int64_t index) const {
    Frame frame;
    frame.index = index;
    frame.time = static_cast<double>(index);
    frame.bit_depth = options_.sensor.bits;
    frame.image = Image(width_, height_);
    const int bands = (height_ + rows_per_band - 1) / rows_per_band;
    parallel_for(bands, threads_, [&](std::int64_t b) {
        const int first = static_cast<int>(b) * rows_per_band;
        const int end = std::min(first + rows_per_band, height_);
        for (int y = first; y < end; ++y) develop_row(exposure, index, y, frame.image);
    });
    for (const Defect& defect : defects_) frame.image.pixels()[defect.pixel] = defect.value;
    return frame;
}

double Camera::mean_counts(double exposure) const {
    const double electrons = options_.light.level * options_.sensor.full_well * exposure;
    return gain_ * std::min(electrons, options_.sensor.full_well) + options_.sensor.offset;
}

double Camera::variance_counts(double exposure) const {
    constexpr double quantisation = 1.0 / 12;
    if (options_.camera == CameraKind::ideal) return quantisation;
    const double electrons = options_.light.level * options_.sensor.full_well * exposure;
    const double read = options_.sensor.read_noise;
    return gain_ * gain_ * (read * read + electrons) + quantisation;
}

}  // namespace grainfield::simulate
