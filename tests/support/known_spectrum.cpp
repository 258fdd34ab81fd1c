#include "tests/support/known_spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/support/random.h"

namespace grainfield::testing {
namespace {

constexpr std::size_t lane = 64;  // spheres at a time
constexpr int most_waves = 64;    // n and m
using Lane = std::array<double, lane>;

/// cos and sin of n θ for n = 0 … largest, of `lane` spheres: values[n][sphere].
struct Multiples {
    std::array<Lane, most_waves + 1> cosine, sine;

    void set(const Lane& angle, int largest) {
        cosine[0].fill(1);
        sine[0].fill(0);
        for (std::size_t j = 0; j < lane; ++j) {
            cosine[1][j] = std::cos(angle[j]);
            sine[1][j] = std::sin(angle[j]);
        }
        for (std::size_t n = 2; n <= static_cast<std::size_t>(largest); ++n) {
            for (std::size_t j = 0; j < lane; ++j) {
                cosine[n][j] = cosine[n - 1][j] * cosine[1][j] - sine[n - 1][j] * sine[1][j];
                sine[n][j] = sine[n - 1][j] * cosine[1][j] + cosine[n - 1][j] * sine[1][j];
            }
        }
    }
};

/// The tables of the spheres from `begin` on; what is beyond the last sphere has `used` 0.
struct Tile {
    Multiples x, y;
    std::size_t used = 0;

    void set(const std::vector<Vec2>& position, std::size_t begin, double step, double margin,
             int largest) {
        used = std::min(lane, position.size() - begin);
        Lane ax{}, ay{};
        for (std::size_t j = 0; j < used; ++j) {
            ax[j] = step * (position[begin + j].x - margin);
            ay[j] = step * (position[begin + j].y - margin);
        }
        x.set(ax, largest);
        y.set(ay, largest);
        for (std::size_t j = used; j < lane; ++j) {
            for (auto* row : {&x.cosine, &x.sine}) {
                for (std::size_t n = 0; n <= static_cast<std::size_t>(largest); ++n) {
                    (*row)[n][j] = 0;
                }
            }
        }
    }
};

// The compiler makes one version an instruction set; the order of the sums is the same in all.
#define GRAINFIELD_VERSIONS __attribute__((target_clones("avx512f", "avx2", "default")))

GRAINFIELD_VERSIONS double sum_of_products(const Lane& x, const Lane& y) {
    std::array<double, 8> sum{};
    for (std::size_t j = 0; j < lane; j += sum.size()) {
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += x[j + i] * y[j + i];
    }
    double all = 0;
    for (const double s : sum) all += s;
    return all;
}

GRAINFIELD_VERSIONS void add_product(Lane& sum, double factor, const Lane& x) {
    for (std::size_t j = 0; j < lane; ++j) sum[j] += factor * x[j];
}

GRAINFIELD_VERSIONS void add_product(Lane& sum, const Lane& x, const Lane& y, double factor) {
    for (std::size_t j = 0; j < lane; ++j) sum[j] += factor * x[j] * y[j];
}

/// One of the eight symmetries of the square.
void turn(SlitScene& scene, std::uint64_t which) {
    for (Vec2& r : scene.position) {
        if ((which & 1U) != 0) r.x = scene.side - r.x;
        if ((which & 2U) != 0) r.y = scene.side - r.y;
        if ((which & 4U) != 0) std::swap(r.x, r.y);
    }
}

}  // namespace

double WantedSpectrum::at(double k) const {
    const auto law = [&](double q) { return s0 + s1 * std::pow(q, alpha); };
    if (k <= peak) return law(k);
    const double share = std::min(1.0, (k - peak) / (cut - peak));
    return law(peak) + share * (beyond - law(peak));
}

KnownSpectrumLayer::KnownSpectrumLayer(const KnownSpectrumOptions& options) : options_(options) {
    step_ = std::numbers::pi / (options.side - 2 * options.margin);
    largest_ = static_cast<int>(options.wanted.cut / step_);
    if (largest_ > most_waves) throw std::invalid_argument("too many waves below the cut");
    for (int l = 0; l < options.liquids; ++l) {
        liquids_.push_back(shaken_bilayer(options.side, options.height, options.spacing, 0.3,
                                          options.melt,
                                          options.seed + 1000 * static_cast<std::uint64_t>(l)));
    }
    grains_ = liquids_.front().position.size();
    const auto count = static_cast<double>(grains_);
    for (int n = 0; n <= largest_; ++n) {
        for (int m = 0; m <= largest_; ++m) {
            const double k = step_ * std::hypot(n, m);
            if ((n == 0 && m == 0) || k >= options.wanted.cut) continue;
            const double share = n == 0 || m == 0 ? 0.5 : 0.25;
            waves_.push_back({n, m, k, std::sqrt(share * count * options.wanted.at(k)), 0});
        }
    }
}

std::vector<double> KnownSpectrumLayer::amplitudes(const std::vector<Vec2>& position) const {
    std::vector<double> c(waves_.size(), 0.0);
    Tile tile;
    for (std::size_t begin = 0; begin < position.size(); begin += lane) {
        tile.set(position, begin, step_, options_.margin, largest_);
        for (std::size_t w = 0; w < waves_.size(); ++w) {
            c[w] += sum_of_products(tile.x.cosine[static_cast<std::size_t>(waves_[w].n)],
                                    tile.y.cosine[static_cast<std::size_t>(waves_[w].m)]);
        }
    }
    return c;
}

SlitScene KnownSpectrumLayer::next() {
    const auto frame = static_cast<std::uint64_t>(frame_);
    RandomStream random(options_.seed, "known spectrum", frame);
    SlitScene& liquid = liquids_[frame % liquids_.size()];
    shake(liquid, 0.3, 2, options_.seed + 1'000'000 + frame);
    SlitScene scene = liquid;
    turn(scene, random.below(8));
    for (Wave& wave : waves_) {
        const double keep = options_.diffusion > 0 && frame_ > 0
                                ? std::exp(-options_.diffusion * wave.k * wave.k)
                                : 0.0;
        wave.wanted =
            keep * wave.wanted + std::sqrt(1 - keep * keep) * wave.width * random.normal();
    }
    ++frame_;
    const auto count = static_cast<double>(grains_);
    const std::vector<Vec2> start = scene.position;
    std::vector<double> potential(waves_.size(), 0.0);
    Tile tile;
    for (int round = 0; round < 60; ++round) {
        const std::vector<double> c = amplitudes(scene.position);
        double worst = 0;
        for (std::size_t w = 0; w < waves_.size(); ++w) {
            const Wave& wave = waves_[w];
            const double share = wave.n == 0 || wave.m == 0 ? 2.0 : 4.0;
            worst = std::max(worst, std::abs(c[w] - wave.wanted));
            potential[w] += share / (count * wave.k * wave.k) * (wave.wanted - c[w]);
        }
        if (worst <= options_.tolerance * std::sqrt(count)) return scene;
        for (std::size_t begin = 0; begin < start.size(); begin += lane) {
            tile.set(start, begin, step_, options_.margin, largest_);
            Lane ux{}, uy{};
            for (std::size_t w = 0; w < waves_.size();) {  // rows of one n
                const int n = waves_[w].n;
                Lane cosine{}, sine{};
                for (; w < waves_.size() && waves_[w].n == n; ++w) {
                    const auto m = static_cast<std::size_t>(waves_[w].m);
                    add_product(cosine, potential[w], tile.y.cosine[m]);
                    add_product(sine, potential[w] * waves_[w].m, tile.y.sine[m]);
                }
                add_product(ux, cosine, tile.x.sine[static_cast<std::size_t>(n)], -step_ * n);
                add_product(uy, sine, tile.x.cosine[static_cast<std::size_t>(n)], -step_);
            }
            for (std::size_t j = 0; j < tile.used; ++j) {
                scene.position[begin + j] = start[begin + j] + Vec2{ux[j], uy[j]};
            }
        }
    }
    throw std::runtime_error("the density modes did not reach their wanted values");
}

}  // namespace grainfield::testing
