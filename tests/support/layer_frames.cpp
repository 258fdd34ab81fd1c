#include "tests/support/layer_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/support/random.h"

namespace grainfield::testing {
namespace {

/// Discs in square cells, for "would this position overlap?".
class DiscCells {
 public:
    DiscCells(int width, int height, double cell, const std::vector<Vec2>& discs)
        : cell_(cell),
          columns_(static_cast<int>(width / cell) + 2),
          rows_(static_cast<int>(height / cell) + 2),
          members_(static_cast<std::size_t>(columns_ * rows_)) {
        for (std::size_t i = 0; i < discs.size(); ++i) insert(i, discs[i]);
    }

    bool is_free(Vec2 p, std::size_t self, const std::vector<Vec2>& discs, double distance) const {
        const int c = column(p.x);
        const int r = row(p.y);
        for (int y = std::max(0, r - 1); y <= std::min(rows_ - 1, r + 1); ++y) {
            for (int x = std::max(0, c - 1); x <= std::min(columns_ - 1, c + 1); ++x) {
                for (const std::size_t j : members_[index(x, y)]) {
                    if (j != self && squared_norm(discs[j] - p) < distance * distance) return false;
                }
            }
        }
        return true;
    }

    void move(std::size_t i, Vec2 from, Vec2 to) {
        auto& cell = members_[index(column(from.x), row(from.y))];
        cell.erase(std::find(cell.begin(), cell.end(), i));
        insert(i, to);
    }

 private:
    int column(double x) const { return std::clamp(static_cast<int>(x / cell_), 0, columns_ - 1); }
    int row(double y) const { return std::clamp(static_cast<int>(y / cell_), 0, rows_ - 1); }
    std::size_t index(int c, int r) const { return static_cast<std::size_t>(r * columns_ + c); }
    void insert(std::size_t i, Vec2 p) { members_[index(column(p.x), row(p.y))].push_back(i); }

    double cell_;
    int columns_, rows_;
    std::vector<std::vector<std::size_t>> members_;
};

/// `sweeps` attempted moves per disc of the first `movable` discs, steps uniform in ±step.
void metropolis(LayerScene& scene, std::size_t movable, double distance, double step, int sweeps,
                RandomStream& random) {
    auto& discs = scene.position;
    DiscCells cells(scene.width, scene.height, distance, discs);
    const double margin = scene.diameter / 2 - 0.5;
    for (int s = 0; s < sweeps; ++s) {
        for (std::size_t i = 0; i < movable; ++i) {
            const Vec2 to{discs[i].x + random.uniform(-step, step),
                          discs[i].y + random.uniform(-step, step)};
            if (to.x < margin || to.y < margin || to.x > scene.width - 1 - margin ||
                to.y > scene.height - 1 - margin || !cells.is_free(to, i, discs, distance)) {
                continue;
            }
            cells.move(i, discs[i], to);
            discs[i] = to;
        }
    }
}

/// A triangular lattice with about `count` sites that fills the frame inside its walls.
std::vector<Vec2> triangular_lattice(const LayerScene& scene, double count) {
    const double margin = scene.diameter / 2 - 0.5 + 1e-9;
    const double w = scene.width - 1 - 2 * margin;
    const double h = scene.height - 1 - 2 * margin;
    const double spacing = std::sqrt(2 / std::sqrt(3.0) * w * h / count);
    const int rows = static_cast<int>(std::lround(h / (spacing * std::sqrt(3.0) / 2))) + 1;
    const int columns = static_cast<int>(std::lround(w / spacing));
    std::vector<Vec2> sites;
    for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c) {
            sites.push_back({margin + (c + (r % 2 == 0 ? 0.0 : 0.5)) * w / (columns - 0.5),
                             margin + r * h / (rows - 1)});
        }
    }
    return sites;
}

std::uint8_t to_8_bits(double value) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

void blur_rows(Image& image, double sigma) {
    const int half = static_cast<int>(std::ceil(4 * sigma));
    std::vector<float> kernel;
    double sum = 0;
    for (int i = -half; i <= half; ++i) sum += std::exp(-0.5 * i * i / (sigma * sigma));
    for (int i = -half; i <= half; ++i) {
        kernel.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)) / sum));
    }
    std::vector<float> line(static_cast<std::size_t>(image.width()));
    for (int y = 0; y < image.height(); ++y) {
        std::copy_n(image.row(y), image.width(), line.begin());
        for (int x = 0; x < image.width(); ++x) {
            float value = 0;
            for (int i = -half; i <= half; ++i) {
                const int from = std::clamp(x + i, 0, image.width() - 1);
                value += kernel[static_cast<std::size_t>(i + half)] *
                         line[static_cast<std::size_t>(from)];
            }
            image(x, y) = value;
        }
    }
}

Image transposed(const Image& image) {
    Image result(image.height(), image.width());
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) result(y, x) = image(x, y);
    }
    return result;
}

}  // namespace

LayerScene isolated_discs(int width, int height, double diameter, double spacing,
                          std::uint64_t seed) {
    LayerScene scene{width, height, diameter, {}, {}, 0};
    RandomStream random(seed, "isolated discs");
    for (double y = spacing / 2; y < height; y += spacing) {
        for (double x = spacing / 2; x < width; x += spacing) {
            scene.position.push_back(
                {x + random.uniform(-0.5, 0.5), y + random.uniform(-0.5, 0.5)});
        }
    }
    scene.layer.assign(scene.position.size(), Layer::unknown);
    scene.crystal_begin = scene.position.size();
    return scene;
}

LayerScene hard_disc_liquid(int width, int height, double diameter, double area_fraction,
                            std::uint64_t seed) {
    LayerScene scene{width, height, diameter, {}, {}, 0};
    const double count =
        area_fraction * width * height / (std::numbers::pi / 4 * diameter * diameter);
    scene.position = triangular_lattice(scene, count);
    RandomStream random(seed, "hard disc liquid");
    metropolis(scene, scene.position.size(), diameter, 0.25 * diameter, 200, random);
    scene.layer.assign(scene.position.size(), Layer::unknown);
    scene.crystal_begin = scene.position.size();
    return scene;
}

LayerScene crystal_in_liquid(int width, int height, double diameter, double area_fraction,
                             const CrystalPatch& patch, std::uint64_t seed) {
    RandomStream random(seed, "crystal patch");
    std::vector<Vec2> crystal;
    std::vector<Layer> layers;
    const double radius = patch.radius * width;
    const double s = patch.spacing * diameter;
    const int reach = static_cast<int>(radius / s * 1.5) + 1;
    for (int i = -reach; i <= reach; ++i) {
        for (int j = -reach; j <= reach; ++j) {
            if (std::max(std::abs(i), std::abs(j)) * s > radius) continue;
            const Vec2 site{
                width / 2.0 + s * (i * std::cos(patch.angle) - j * std::sin(patch.angle)),
                height / 2.0 + s * (i * std::sin(patch.angle) + j * std::cos(patch.angle))};
            crystal.push_back({site.x + patch.jitter * diameter * random.normal(),
                               site.y + patch.jitter * diameter * random.normal()});
            layers.push_back((i + j) % 2 == 0 ? Layer::bottom : Layer::top);
        }
    }
    LayerScene scene{width, height, diameter, {}, {}, 0};
    const double count =
        area_fraction * width * height / (std::numbers::pi / 4 * diameter * diameter);
    const DiscCells cells(width, height, diameter, crystal);
    for (const Vec2 p : triangular_lattice(scene, count)) {
        if (cells.is_free(p, crystal.size(), crystal, patch.clearance * diameter)) {
            scene.position.push_back(p);
        }
    }
    scene.crystal_begin = scene.position.size();
    scene.position.insert(scene.position.end(), crystal.begin(), crystal.end());
    scene.layer.assign(scene.crystal_begin, Layer::unknown);
    scene.layer.insert(scene.layer.end(), layers.begin(), layers.end());
    metropolis(scene, scene.crystal_begin, patch.clearance * diameter, 0.25 * diameter, 200,
               random);
    return scene;
}

LayerMotion::LayerMotion(const LayerScene& start, const CrystalPatch& patch, double liquid_step,
                         std::uint64_t seed)
    : scene_(start),
      site_(start.position.begin() + static_cast<std::ptrdiff_t>(start.crystal_begin),
            start.position.end()),
      jitter_(patch.jitter * start.diameter),
      step_(liquid_step),
      seed_(seed) {}

void LayerMotion::advance() {
    RandomStream random(seed_, "layer motion", ++frame_);
    // A stationary jitter with a memory of a few frames about sites that already carry one jitter.
    constexpr double kMemory = 0.5;
    for (std::size_t i = 0; i < site_.size(); ++i) {
        Vec2& p = scene_.position[scene_.crystal_begin + i];
        const double kick = 0.5 * jitter_ * std::sqrt(1 - kMemory * kMemory);
        p = site_[i] + kMemory * (p - site_[i]) +
            Vec2{kick * random.normal(), kick * random.normal()};
    }
    metropolis(scene_, scene_.crystal_begin, 0.88 * scene_.diameter, step_, 3, random);
}

Image tanh_frame(const LayerScene& scene, double apparent_diameter, double edge_width, double noise,
                 std::uint64_t seed) {
    Image transmission(scene.width, scene.height, 1.0F);
    const double radius = apparent_diameter / 2;
    const double reach = radius + 8 * edge_width;
    for (const Vec2 c : scene.position) {
        for (int y = std::max(0, static_cast<int>(c.y - reach));
             y <= std::min(scene.height - 1, static_cast<int>(c.y + reach)); ++y) {
            for (int x = std::max(0, static_cast<int>(c.x - reach));
                 x <= std::min(scene.width - 1, static_cast<int>(c.x + reach)); ++x) {
                const double r = std::hypot(x - c.x, y - c.y);
                const double p = 0.5 * (1 - std::tanh((r - radius) / edge_width));
                transmission(x, y) *= static_cast<float>(1 - p);
            }
        }
    }
    RandomStream random(seed, "tanh frame noise");
    for (float& v : transmission.pixels()) {
        const double counts = 30 + 170 * (static_cast<double>(v) + noise * random.normal());
        v = static_cast<float>(to_8_bits(counts));
    }
    return transmission;
}

Image noise_frame(int width, int height, double mean, double sigma, double blur,
                  std::uint64_t seed) {
    Image frame(width, height);
    RandomStream random(seed, "noise frame");
    for (float& v : frame.pixels()) v = static_cast<float>(random.normal());
    double rms = 1;
    if (blur > 0) {
        blur_rows(frame, blur);
        frame = transposed(frame);
        blur_rows(frame, blur);
        frame = transposed(frame);
        rms = 1 / (2 * blur * std::sqrt(std::numbers::pi));  // of the mean over the kernel
    }
    for (float& v : frame.pixels()) {
        v = static_cast<float>(to_8_bits(mean + sigma / rms * static_cast<double>(v)));
    }
    return frame;
}

Image camera_frame(const LayerScene& scene, const Camera& camera, std::uint64_t seed) {
    constexpr int kOver = 4;  // sub-pixels per pixel and axis
    Image fine(scene.width * kOver, scene.height * kOver);
    const double radius = 0.5 * camera.apparent_diameter * scene.diameter * kOver;
    const double core = radius / std::numbers::sqrt2;
    for (const Vec2 p : scene.position) {
        const Vec2 c{(p.x + 0.5) * kOver - 0.5, (p.y + 0.5) * kOver - 0.5};
        for (int y = std::max(0, static_cast<int>(std::ceil(c.y - radius)));
             y <= std::min(fine.height() - 1, static_cast<int>(c.y + radius)); ++y) {
            for (int x = std::max(0, static_cast<int>(std::ceil(c.x - radius)));
                 x <= std::min(fine.width() - 1, static_cast<int>(c.x + radius)); ++x) {
                const double r2 = (x - c.x) * (x - c.x) + (y - c.y) * (y - c.y);
                if (r2 > radius * radius) continue;
                const float dark =
                    r2 < core * core ? 1.0F : static_cast<float>(camera.rim_darkness);
                fine(x, y) = std::max(fine(x, y), dark);
            }
        }
    }
    Image light(scene.width, scene.height);
    for (int y = 0; y < scene.height; ++y) {
        for (int x = 0; x < scene.width; ++x) {
            float sum = 0;
            for (int j = 0; j < kOver; ++j) {
                for (int i = 0; i < kOver; ++i) sum += fine(x * kOver + i, y * kOver + j);
            }
            light(x, y) = 1 - sum / (kOver * kOver);
        }
    }
    const double sigma = camera.blur * scene.diameter;
    if (sigma > 0) {
        blur_rows(light, sigma);
        light = transposed(light);
        blur_rows(light, sigma);
        light = transposed(light);
    }
    RandomStream random(seed, "camera noise");
    const double full = std::exp2(camera.bit_depth) - 1;
    for (int y = 0; y < scene.height; ++y) {
        for (int x = 0; x < scene.width; ++x) {
            const double dx = 2.0 * x / scene.width - 1;
            const double dy = 2.0 * y / scene.height - 1;
            const double lamp = camera.exposure * (1 - camera.vignetting * (dx * dx + dy * dy) / 2);
            const double mean =
                camera.electrons * lamp * (0.06 + 0.94 * static_cast<double>(light(x, y)));
            const double electrons =
                static_cast<double>(random.poisson(mean)) + camera.read_noise * random.normal();
            light(x, y) = static_cast<float>(
                std::clamp(std::round(electrons / camera.electrons * full), 0.0, full));
        }
    }
    return light;
}

}  // namespace grainfield::testing
