#include "tracking/synthesis/mirror_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "core/support/parallel.h"

namespace grainfield::tracking {
namespace {

constexpr int kMostSamples = 4;
constexpr double kWidestPatch = 1.6;  // [a] from the sphere: what is mirrored farther away is weak
constexpr double kBlurReach = 3.5;    // [σ]

std::size_t at(std::ptrdiff_t index) {
    return static_cast<std::size_t>(index);
}

std::vector<float> gaussian(double sigma) {
    const int reach = std::max(1, static_cast<int>(std::ceil(kBlurReach * sigma)));
    std::vector<float> tap(at(2 * reach + 1));
    double sum = 0;
    for (int i = -reach; i <= reach; ++i) sum += std::exp(-0.5 * i * i / (sigma * sigma));
    for (int i = -reach; i <= reach; ++i) {
        tap[at(i + reach)] = static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)) / sum);
    }
    return tap;
}

}  // namespace

Image gaussian_blurred(const Image& image, double sigma, int threads) {
    const std::vector<float> tap = gaussian(sigma);
    const int reach = static_cast<int>(tap.size() / 2);
    const int width = image.width();
    const int height = image.height();
    Image rows(width, height);
    parallel_for(height, threads, [&](std::int64_t row) {
        const int y = static_cast<int>(row);
        std::vector<float> wide(at(width + 2 * reach));
        for (int x = -reach; x < width + reach; ++x) {
            wide[at(x + reach)] = image(std::clamp(x, 0, width - 1), y);
        }
        float* out = rows.row(y);
        for (std::size_t k = 0; k < tap.size(); ++k) {
            const float* in = wide.data() + k;
            const float share = tap[k];
#pragma omp simd
            for (int x = 0; x < width; ++x) out[x] += share * in[x];
        }
    });
    Image result(width, height);
    parallel_for(height, threads, [&](std::int64_t row) {
        const int y = static_cast<int>(row);
        float* out = result.row(y);
        for (int k = -reach; k <= reach; ++k) {
            const float* in = rows.row(std::clamp(y + k, 0, height - 1));
            const float share = tap[at(k + reach)];
#pragma omp simd
            for (int x = 0; x < width; ++x) out[x] += share * in[x];
        }
    });
    return result;
}

MirrorImage::MirrorImage(int width, int height, double scale, int threads, double rays)
    : width_(width),
      height_(height),
      scale_(scale),
      threads_(threads),
      samples_(std::clamp(static_cast<int>(std::ceil(rays / scale)), 1, kMostSamples)),
      image_(width, height) {}

/// Where a ray crosses the plane z = 0 [a].
Point3 MirrorImage::place(std::int32_t ray) const {
    const int columns = width_ * samples_;
    const int row = ray / columns;
    const int column = ray - row * columns;
    const double step = 1.0 / samples_;
    const double first = 0.5 * step - 0.5;
    return {static_cast<float>((column * step + first) / scale_),
            static_cast<float>((row * step + first) / scale_), 0};
}

std::vector<float> MirrorImage::places() const {
    std::vector<float> x;
    for (std::int32_t column = 0; column < width_ * samples_; ++column) {
        x.push_back(place(column).x);
    }
    return x;
}

void MirrorImage::render(const MirrorScene& scene) {
    const int columns = width_ * samples_;
    const int rows = height_ * samples_;
    const auto rays = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    value_.resize(rays);
    first_.resize(rays);
    Image sharp(width_, height_);
    std::vector<std::vector<Touch>> touches(static_cast<std::size_t>(height_));
    const float share = 1.0F / static_cast<float>(samples_ * samples_);
    const std::vector<float> x = places();
    parallel_for(height_, threads_, [&](std::int64_t row) {
        std::vector<Touch>& list = touches[static_cast<std::size_t>(row)];
        float* out = sharp.row(static_cast<int>(row));
        FirstSpheres begin;
        for (int v = 0; v < samples_; ++v) {
            auto ray = static_cast<std::int32_t>((row * samples_ + v) * columns);
            const float y = place(ray).y;
            scene.first_spheres(x, y, true, begin);
            for (int column = 0; column < columns; ++column, ++ray) {
                const auto k = static_cast<std::size_t>(column);
                TouchedSpheres touched = begin.touched(k);
                const float value = scene.radiance(x[k], y, begin.first[k], touched);
                value_[static_cast<std::size_t>(ray)] = value;
                first_[static_cast<std::size_t>(ray)] = begin.first[k];
                out[column / samples_] += share * value;
                for (int n = 0; n < touched.count; ++n) list.push_back({touched.id[n], ray});
            }
        }
    });
    image_ = gaussian_blurred(sharp, scene.optics().blur * scale_, threads_);
    begin_.assign(scene.spheres().size() + 1, 0);
    for (const std::vector<Touch>& list : touches) {
        for (const Touch& touch : list) ++begin_[static_cast<std::size_t>(touch.sphere) + 1];
    }
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    ray_.resize(static_cast<std::size_t>(begin_.back()));
    std::vector<std::int64_t> next(begin_.begin(), begin_.end() - 1);
    for (const std::vector<Touch>& list : touches) {
        for (const Touch& touch : list) {
            ray_[static_cast<std::size_t>(next[static_cast<std::size_t>(touch.sphere)]++)] =
                touch.ray;
        }
    }
}

void MirrorImage::render_only(const MirrorScene& scene) {
    image_ = std::move(renderings(scene, {scene.optics()}).front());
}

std::vector<Image> MirrorImage::renderings(const MirrorScene& scene,
                                           const std::vector<MirrorOptics>& optics) const {
    if (optics.size() > MirrorScene::kMostOptics) throw std::length_error("too many optics");
    const int columns = width_ * samples_;
    std::vector<Image> images(optics.size(), Image(width_, height_));
    const float share = 1.0F / static_cast<float>(samples_ * samples_);
    const std::vector<float> x = places();
    parallel_for(height_, threads_, [&](std::int64_t row) {
        FirstSpheres begin;
        std::array<float, MirrorScene::kMostOptics> value;
        for (int v = 0; v < samples_; ++v) {
            const float y = place(static_cast<std::int32_t>((row * samples_ + v) * columns)).y;
            scene.first_spheres(x, y, false, begin);
            for (int column = 0; column < columns; ++column) {
                const auto k = static_cast<std::size_t>(column);
                scene.radiances(x[k], y, begin.first[k], optics, value);
                for (std::size_t n = 0; n < images.size(); ++n) {
                    images[n](column / samples_, static_cast<int>(row)) += share * value[n];
                }
            }
        }
    });
    for (std::size_t n = 0; n < images.size(); ++n) {
        images[n] = gaussian_blurred(images[n], optics[n].blur * scale_, threads_);
    }
    return images;
}

void MirrorImage::blur(ImagePatch& patch, double sigma) const {
    const std::vector<float> tap = gaussian(sigma);
    const int reach = static_cast<int>(tap.size() / 2);
    const int width = patch.width;
    const int height = patch.height;
    thread_local std::vector<float> rows;
    rows.assign(patch.value.size(), 0.0F);
    for (int y = 0; y < height; ++y) {
        const float* in = patch.row(y);
        float* out = rows.data() + static_cast<std::ptrdiff_t>(y) * width;
        for (int k = -reach; k <= reach; ++k) {
            const float share = tap[at(k + reach)];
            const int last = std::min(width, width - k);
#pragma omp simd
            for (int x = std::max(0, -k); x < last; ++x) out[x] += share * in[x + k];
        }
    }
    std::fill(patch.value.begin(), patch.value.end(), 0.0F);
    for (int y = 0; y < height; ++y) {
        float* out = patch.value.data() + static_cast<std::ptrdiff_t>(y) * width;
        for (int k = std::max(-reach, -y); k <= std::min(reach, height - 1 - y); ++k) {
            const float* in = rows.data() + static_cast<std::ptrdiff_t>(y + k) * width;
            const float share = tap[at(k + reach)];
#pragma omp simd
            for (int x = 0; x < width; ++x) out[x] += share * in[x];
        }
    }
}

/// The pixels within `half` of a place.
ImagePatch MirrorImage::empty_patch(Point3 centre, int half) const {
    const int x0 = static_cast<int>(std::lround(static_cast<double>(centre.x) * scale_)) - half;
    const int y0 = static_cast<int>(std::lround(static_cast<double>(centre.y) * scale_)) - half;
    ImagePatch patch;
    patch.x = std::max(0, x0);
    patch.y = std::max(0, y0);
    patch.width = std::max(0, std::min(width_, x0 + 2 * half + 1) - patch.x);
    patch.height = std::max(0, std::min(height_, y0 + 2 * half + 1) - patch.y);
    patch.value.assign(
        static_cast<std::size_t>(patch.width) * static_cast<std::size_t>(patch.height), 0.0F);
    return patch;
}

ImagePatch MirrorImage::change(const MirrorScene& scene, std::int32_t sphere, Point3 to,
                               double radius) const {
    const double sigma = scene.optics().blur * scale_;
    const Point3 centre = scene.spheres()[static_cast<std::size_t>(sphere)];
    ImagePatch patch = empty_patch(
        centre, static_cast<int>(std::ceil(radius * scale_) + std::ceil(kBlurReach * sigma)));
    const MovedSphere moved{sphere, to};
    const float share = 1.0F / static_cast<float>(samples_ * samples_);
    const int columns = width_ * samples_;
    const auto farthest = static_cast<float>(radius * radius);
    const auto from = [](const Point3& p, const Point3& q) {
        return (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y);
    };
    for (int row = 0; row < patch.height * samples_; ++row) {
        float* out = patch.value.data() + static_cast<std::ptrdiff_t>(row / samples_) * patch.width;
        auto ray =
            static_cast<std::int32_t>((patch.y * samples_ + row) * columns + patch.x * samples_);
        for (int column = 0; column < patch.width * samples_; ++column, ++ray) {
            const Point3 p = place(ray);
            if (from(p, centre) > farthest) continue;
            const std::int32_t first = first_[static_cast<std::size_t>(ray)];
            out[column / samples_] += share * (scene.radiance(p.x, p.y, first, moved) -
                                               value_[static_cast<std::size_t>(ray)]);
        }
    }
    blur(patch, sigma);
    return patch;
}

ImagePatch MirrorImage::derivative(const MirrorScene& scene, std::int32_t sphere,
                                   Point3 step) const {
    const Point3 centre = scene.spheres()[static_cast<std::size_t>(sphere)];
    ImagePatch patch = empty_patch(centre, static_cast<int>(std::ceil(kWidestPatch * scale_)));
    if (patch.value.empty()) return patch;
    const MovedSphere moved{sphere, {centre.x + step.x, centre.y + step.y, centre.z + step.z}};
    const float length = std::sqrt(step.x * step.x + step.y * step.y + step.z * step.z);
    const float share = 1.0F / (length * static_cast<float>(samples_ * samples_));
    const int columns = width_ * samples_;
    for (std::int64_t k = begin_[static_cast<std::size_t>(sphere)];
         k < begin_[static_cast<std::size_t>(sphere) + 1]; ++k) {
        const std::int32_t ray = ray_[static_cast<std::size_t>(k)];
        const int row = ray / columns;
        const int x = (ray - row * columns) / samples_ - patch.x;
        const int y = row / samples_ - patch.y;
        if (x < 0 || y < 0 || x >= patch.width || y >= patch.height) continue;
        const Point3 p = place(ray);
        const float value = scene.radiance(p.x, p.y, first_[static_cast<std::size_t>(ray)], moved);
        patch.value[static_cast<std::size_t>(y) * static_cast<std::size_t>(patch.width) +
                    static_cast<std::size_t>(x)] +=
            share * (value - value_[static_cast<std::size_t>(ray)]);
    }
    blur(patch, scene.optics().blur * scale_);
    return patch;
}

}  // namespace grainfield::tracking
