#include "tracking/synthesis/synthesis_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <Eigen/Dense>

#include "core/support/parallel.h"
#include "tracking/synthesis/optics_fit.h"

namespace grainfield::tracking {
namespace {

// Differences are taken over these steps: over shorter ones the grid of the rays decides.
constexpr double kStepInPlane = 1;  // [distances of rays]
constexpr double kStepInHeight = 2;
constexpr float kStale = 0.03F;  // [a]
constexpr float kNeighbour = 2;  // [a²] nearer ones make derivatives stale as they move
// What is known beforehand of where a round may take a sphere [a].
constexpr double kPlaneRange = 0.1;
constexpr double kHeightRange = 0.3;
constexpr double kLongestInHeight = 0.25;
// Heights that are tried, in parts of what the cell leaves; nearer ones are left to the
// derivatives.
constexpr std::array<float, 5> kHeightsTried = {0.1F, 0.3F, 0.5F, 0.7F, 0.9F};
constexpr float kOtherHeight = 0.1F;    // [a]
constexpr double kSeenOfHeight = 0.65;  // [a] from the sphere
constexpr double kContact = 0.01;       // [a] how far two spheres may overlap
constexpr double kAbout = 0.6;          // [a] radius of the misfit about one sphere
constexpr int kSolverSweeps = 60;
constexpr double kLeastNoise = 0.005;  // [contrast]
constexpr double kFirstDamping = 0.02;
constexpr int kMostRetries = 3;

float squared_in_plane(const Point3& a, const Point3& b) {
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

Point3 plus(Point3 p, const std::array<double, 3>& d) {
    return {p.x + static_cast<float>(d[0]), p.y + static_cast<float>(d[1]),
            p.z + static_cast<float>(d[2])};
}

/// Σ a b over the pixels that both patches hold.
float product(const ImagePatch& a, const ImagePatch& b) {
    const int x0 = std::max(a.x, b.x);
    const int x1 = std::min(a.x + a.width, b.x + b.width);
    const int y0 = std::max(a.y, b.y);
    const int y1 = std::min(a.y + a.height, b.y + b.height);
    if (x1 <= x0) return 0;
    float sum = 0;
    for (int y = y0; y < y1; ++y) {
        const float* p = a.row(y - a.y) + (x0 - a.x);
        const float* q = b.row(y - b.y) + (x0 - b.x);
        float row = 0;
#pragma omp simd reduction(+ : row)
        for (int x = 0; x < x1 - x0; ++x) row += p[x] * q[x];
        sum += row;
    }
    return sum;
}

double product(const ImagePatch& a, const Image& image) {
    double sum = 0;
    for (int y = 0; y < a.height; ++y) {
        const float* p = a.row(y);
        const float* q = image.row(a.y + y) + a.x;
        float row = 0;
#pragma omp simd reduction(+ : row)
        for (int x = 0; x < a.width; ++x) row += p[x] * q[x];
        sum += static_cast<double>(row);
    }
    return sum;
}

}  // namespace

SynthesisFit::SynthesisFit(const Image& brightness, const Image& ceiling, double scale, int threads,
                           double rays)
    : brightness_(brightness),
      ceiling_(ceiling),
      scale_(scale),
      threads_(threads),
      image_(brightness.width(), brightness.height(), scale, threads, rays) {}

void SynthesisFit::start(std::vector<Point3> spheres, const MirrorOptics& optics) {
    spheres_ = std::move(spheres);
    optics_ = optics;
    is_fixed_.clear();
    is_light_known_ = false;
    derivative_.clear();
    render();
}

void SynthesisFit::start(std::vector<Point3> spheres, const MirrorOptics& optics,
                         std::vector<char> is_fixed, const FrameLight& light) {
    spheres_ = std::move(spheres);
    optics_ = optics;
    is_fixed_ = std::move(is_fixed);
    light_ = light;
    is_light_known_ = true;
    derivative_.clear();
    render();
}

void SynthesisFit::replace(std::vector<Point3> spheres) {
    const std::vector<Point3> before = std::move(spheres_);
    std::vector<std::array<ImagePatch, 3>> derivative = std::move(derivative_);
    std::vector<float> moved = std::move(moved_);
    spheres_ = std::move(spheres);
    derivative_.assign(spheres_.size(), {});
    moved_.assign(spheres_.size(), 1.0F);
    std::map<std::tuple<float, float, float>, std::size_t> place;
    for (std::size_t i = 0; i < derivative.size(); ++i) {
        place.emplace(std::tuple(before[i].x, before[i].y, before[i].z), i);
    }
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
        const auto same = place.find({spheres_[i].x, spheres_[i].y, spheres_[i].z});
        if (same == place.end()) continue;
        derivative_[i] = std::move(derivative[same->second]);
        moved_[i] = moved[same->second];
        place.erase(same);
    }
    // What is left in `place` is gone.
    for (const auto& [at, gone] : place) {
        for (std::size_t i = 0; i < spheres_.size(); ++i) {
            if (squared_in_plane(spheres_[i], before[gone]) <= kNeighbour) moved_[i] = 1;
        }
    }
    render();
}

double SynthesisFit::misfit() const {
    const int border = static_cast<int>(std::ceil(3 * optics_.blur * scale_));
    const double rms = inner_rms(residual_, border) / light_.gain;
    return rms * rms * std::max(0, residual_.width() - 2 * border) *
           std::max(0, residual_.height() - 2 * border);
}

SynthesisFit::LocalMisfit SynthesisFit::misfit_about(std::size_t sphere) const {
    const int radius = static_cast<int>(kAbout * scale_);
    const int cx = static_cast<int>(std::lround(static_cast<double>(spheres_[sphere].x) * scale_));
    const int cy = static_cast<int>(std::lround(static_cast<double>(spheres_[sphere].y) * scale_));
    LocalMisfit misfit;
    for (int y = std::max(0, cy - radius); y <= std::min(residual_.height() - 1, cy + radius);
         ++y) {
        for (int x = std::max(0, cx - radius); x <= std::min(residual_.width() - 1, cx + radius);
             ++x) {
            if ((x - cx) * (x - cx) + (y - cy) * (y - cy) > radius * radius) continue;
            const auto value = static_cast<double>(residual_(x, y));
            misfit.sum += value * value;
            misfit.pixels += 1;
        }
    }
    misfit.sum /= light_.gain * light_.gain;
    return misfit;
}

double SynthesisFit::overlap() const {
    double sum = 0;
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
        const NearSpheres& near = this->near(i);
        for (int k = 0; k < near.count; ++k) {
            if (near.id[k] <= static_cast<std::int32_t>(i)) continue;
            const float x = spheres_[i].x - near.x[k];
            const float y = spheres_[i].y - near.y[k];
            const float z = spheres_[i].z - near.z[k];
            const double gap = 1 - std::sqrt(static_cast<double>(x * x + y * y + z * z));
            if (gap > 0) sum += gap * gap;
        }
    }
    return sum;
}

void SynthesisFit::render() {
    scene_.clear();
    scene_.emplace_back(spheres_, optics_);
    if (fine_) {
        fine_->render_only(scene_.front());
    } else {
        image_.render(scene_.front());
    }
    relight();
}

void SynthesisFit::relight() {
    const Image& image = rendering();
    const int border = static_cast<int>(std::ceil(scale_));
    if (!is_light_known_) light_ = fit_light(brightness_, ceiling_, image, border);
    residual_ = light_residual(brightness_, ceiling_, image, light_, threads_);
    rms_ = inner_rms(residual_, border) / light_.gain;
}

void SynthesisFit::sharpen(double rays) {
    take_derivatives();
    fine_.emplace(brightness_.width(), brightness_.height(), scale_, threads_, rays);
    render();
}

void SynthesisFit::take_derivatives() {
    if (fine_) return;
    const std::size_t n = spheres_.size();
    if (derivative_.size() != n) {
        derivative_.assign(n, {});
        moved_.assign(n, 1.0F);
    }
    const MirrorScene& scene = scene_.front();
    const double rays = image_.samples() * scale_;
    const auto across = static_cast<float>(kStepInPlane / rays);
    const auto upwards = static_cast<float>(kStepInHeight / rays);
    parallel_for(static_cast<std::int64_t>(n), threads_, [&](std::int64_t index) {
        const auto i = static_cast<std::size_t>(index);
        const auto sphere = static_cast<std::int32_t>(index);
        if (is_fixed(i)) return;
        float moved = moved_[i];
        const NearSpheres& near = scene.near(sphere);
        for (int k = 0; k < near.count; ++k) {
            if (near.id[k] < 0) continue;
            const Point3 other{near.x[k], near.y[k], near.z[k]};
            if (squared_in_plane(other, spheres_[i]) > kNeighbour) continue;
            moved = std::max(moved, moved_[static_cast<std::size_t>(near.id[k])]);
        }
        if (moved < kStale && !derivative_[i][0].value.empty()) return;
        const bool is_high = spheres_[i].z > 0.5F;
        const float up = is_high ? -upwards : upwards;
        derivative_[i][0] = image_.derivative(scene, sphere, {across, 0, 0});
        derivative_[i][1] = image_.derivative(scene, sphere, {0, across, 0});
        derivative_[i][2] = image_.derivative(scene, sphere, {0, 0, up});
        if (is_high) {
            for (float& v : derivative_[i][2].value) v = -v;
        }
    });
}

SynthesisFit::Information SynthesisFit::normal_equations(Contacts contacts) const {
    const std::size_t n = spheres_.size();
    Information info;
    info.own.resize(n);
    info.gradient.resize(n);
    info.pair.resize(n);
    const MirrorScene& scene = scene_.front();
    const auto gain = static_cast<double>(light_.gain);
    const double noise = std::max(kLeastNoise, rms_) * gain;
    parallel_for(static_cast<std::int64_t>(n), threads_, [&](std::int64_t index) {
        const auto i = static_cast<std::size_t>(index);
        if (is_fixed(i)) return;
        const std::array<ImagePatch, 3>& own = derivative_[i];
        for (std::size_t p = 0; p < 3; ++p) {
            info.gradient[i][p] = gain * product(own[p], residual_);
            for (std::size_t q = 0; q < 3; ++q) {
                info.own[i][3 * p + q] = gain * gain * static_cast<double>(product(own[p], own[q]));
            }
        }
        const NearSpheres& near = scene.near(static_cast<std::int32_t>(i));
        for (int k = 0; k < near.count; ++k) {
            if (near.id[k] < 0) continue;
            const auto j = static_cast<std::size_t>(near.id[k]);
            const bool is_free = !is_fixed(j);
            Block block{near.id[k], {}};
            for (std::size_t p = 0; p < 3 && is_free; ++p) {
                for (std::size_t q = 0; q < 3; ++q) {
                    block.value[3 * p + q] = static_cast<float>(
                        gain * gain * static_cast<double>(product(own[p], derivative_[j][q])));
                }
            }
            // Spheres that overlap in space push each other apart.
            const Eigen::Vector3d apart(static_cast<double>(spheres_[i].x - near.x[k]),
                                        static_cast<double>(spheres_[i].y - near.y[k]),
                                        static_cast<double>(spheres_[i].z - near.z[k]));
            const double distance = apart.norm();
            if (contacts == Contacts::penalised && distance < 1 && distance > 0.1) {
                const Eigen::Vector3d along = apart / distance;
                const double weight = noise * noise / (kContact * kContact);
                for (std::size_t p = 0; p < 3; ++p) {
                    const auto row = static_cast<Eigen::Index>(p);
                    info.gradient[i][p] += weight * (1 - distance) * along(row);
                    for (std::size_t q = 0; q < 3; ++q) {
                        const double w = weight * along(row) * along(static_cast<Eigen::Index>(q));
                        info.own[i][3 * p + q] += w;
                        block.value[3 * p + q] -= static_cast<float>(w);
                    }
                }
            }
            if (is_free) info.pair[i].push_back(block);
        }
        const double plane = noise * noise / (kPlaneRange * kPlaneRange);
        info.own[i][0] += plane;
        info.own[i][4] += plane;
        info.own[i][8] += noise * noise / (kHeightRange * kHeightRange);
    });
    return info;
}

SynthesisFit::Information SynthesisFit::information(Contacts contacts) {
    take_derivatives();
    return normal_equations(contacts);
}

std::vector<std::array<double, 3>> SynthesisFit::gradient_of(const Image& residual) const {
    std::vector<std::array<double, 3>> gradient(spheres_.size(), {0, 0, 0});
    parallel_for(static_cast<std::int64_t>(gradient.size()), threads_, [&](std::int64_t index) {
        const auto i = static_cast<std::size_t>(index);
        for (std::size_t p = 0; p < 3 && !is_fixed(i); ++p) {
            gradient[i][p] = light_.gain * product(derivative_[i][p], residual);
        }
    });
    return gradient;
}

std::vector<std::array<double, 3>> SynthesisFit::solve(const Information& info,
                                                       double damping) const {
    const std::size_t n = spheres_.size();
    std::vector<Eigen::Matrix3d> inverse(n);
    for (std::size_t i = 0; i < n; ++i) {
        if (is_fixed(i)) continue;
        Eigen::Matrix3d own = Eigen::Map<const Eigen::Matrix3d>(info.own[i].data());
        own.diagonal() *= 1 + damping;
        inverse[i] = own.inverse();
    }
    std::vector<std::array<double, 3>> step(n, {0, 0, 0});
    for (int sweep = 0; sweep < kSolverSweeps; ++sweep) {
        for (std::size_t i = 0; i < n; ++i) {
            if (is_fixed(i)) continue;
            Eigen::Vector3d rest = Eigen::Map<const Eigen::Vector3d>(info.gradient[i].data());
            for (const Block& block : info.pair[i]) {
                const std::array<double, 3>& d = step[static_cast<std::size_t>(block.other)];
                for (std::size_t p = 0; p < 3; ++p) {
                    for (std::size_t q = 0; q < 3; ++q) {
                        rest(static_cast<Eigen::Index>(p)) -=
                            static_cast<double>(block.value[3 * p + q]) * d[q];
                    }
                }
            }
            const Eigen::Vector3d next = inverse[i] * rest;
            step[i] = {next(0), next(1), next(2)};
        }
    }
    return step;
}

float SynthesisFit::best_height(std::size_t sphere, float top) const {
    const Point3 here = spheres_[sphere];
    float best = here.z;
    double least = 0;
    for (const float share : kHeightsTried) {
        const float z = share * top;
        if (std::abs(z - here.z) < kOtherHeight) continue;
        const ImagePatch patch = image_.change(scene_.front(), static_cast<std::int32_t>(sphere),
                                               {here.x, here.y, z}, kSeenOfHeight);
        const double change =
            light_.gain * light_.gain * static_cast<double>(product(patch, patch)) -
            2 * light_.gain * product(patch, residual_);
        if (change >= least) continue;
        least = change;
        best = z;
    }
    return best;
}

int SynthesisFit::choose_heights(const SynthesisLimits& limits, double share) {
    std::vector<float> best(spheres_.size());
    parallel_for(static_cast<std::int64_t>(best.size()), threads_, [&](std::int64_t index) {
        const auto i = static_cast<std::size_t>(index);
        best[i] =
            is_fixed(i) ? spheres_[i].z : best_height(i, static_cast<float>(limits.height - 1));
    });
    int moved = 0;
    for (std::size_t i = 0; i < best.size(); ++i) {
        moved += best[i] != spheres_[i].z ? 1 : 0;
        spheres_[i].z += static_cast<float>(share) * (best[i] - spheres_[i].z);
    }
    derivative_.clear();
    render();
    return moved;
}

int SynthesisFit::find_heights(SynthesisLimits limits) {
    constexpr int kFirstSweeps = 2;
    constexpr int kSweepsBetween = 2;
    constexpr double kShareOfWay = 0.7;  // neighbours move as well
    limits.most_rounds = 1;
    int rounds = 0;
    for (int sweep = 0; sweep < kFirstSweeps; ++sweep) choose_heights(limits, kShareOfWay);
    for (int sweep = 0; sweep < kSweepsBetween; ++sweep) {
        rounds += refine(limits);
        choose_heights(limits, kShareOfWay);
    }
    return rounds + refine(limits);
}

int SynthesisFit::refine(const SynthesisLimits& limits) {
    double damping = kFirstDamping;
    const auto top = static_cast<float>(limits.height - 1);
    for (int round = 0; round < limits.most_rounds; ++round) {
        take_derivatives();
        for (std::size_t i = 0; i < moved_.size(); ++i) {
            if (moved_[i] >= kStale) moved_[i] = 0;
        }
        const Information info = normal_equations(Contacts::penalised);
        const std::vector<Point3> before = spheres_;
        const double rms = rms_;
        double moved = 0;
        for (int retry = 0; retry < kMostRetries; ++retry) {
            std::vector<std::array<double, 3>> step = solve(info, damping);
            moved = 0;
            for (std::size_t i = 0; i < step.size(); ++i) {
                const double length = std::hypot(step[i][0], step[i][1]);
                const double shorter =
                    length > limits.longest_step ? limits.longest_step / length : 1;
                step[i][0] *= shorter;
                step[i][1] *= shorter;
                step[i][2] = std::clamp(step[i][2], -kLongestInHeight, kLongestInHeight);
                spheres_[i] = plus(before[i], step[i]);
                spheres_[i].z = std::clamp(spheres_[i].z, 0.0F, top);
                moved += step[i][0] * step[i][0] + step[i][1] * step[i][1];
            }
            render();
            if (rms_ <= rms * 1.02) break;
            damping *= 8;
        }
        damping = std::max(0.3 * damping, 1e-3);
        for (std::size_t i = 0; i < spheres_.size(); ++i) {
            const Point3 a = before[i];
            const Point3 b = spheres_[i];
            moved_[i] += std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) +
                                   0.1F * (a.z - b.z) * (a.z - b.z));
        }
        if (std::sqrt(moved / static_cast<double>(spheres_.size())) < limits.settled) {
            return round + 1;
        }
    }
    return limits.most_rounds;
}

void SynthesisFit::fit_optics() {
    const FittedOptics fitted =
        fitted_optics({brightness_, ceiling_, scale_}, spheres_, optics_, threads_);
    optics_ = fitted.optics;
    optics_error_ = fitted.error;
    derivative_.clear();
    render();
}

}  // namespace grainfield::tracking
