#include "tracking/synthesis/random_moves.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

constexpr float kAtBorder = 0.5F;  // [a]

/// Spheres in cells one diameter wide.
class Cells {
 public:
    explicit Cells(const std::vector<Point3>& spheres) : spheres_(spheres) {
        low_ = high_ = spheres.front();
        for (const Point3& p : spheres) {
            low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y), 0};
            high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y), 0};
        }
        columns_ = column(high_.x) + 1;
        rows_ = row(high_.y) + 1;
        member_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
        for (std::size_t i = 0; i < spheres.size(); ++i) of(spheres[i]).push_back(i);
    }

    bool is_at_border(const Point3& p) const {
        return p.x < low_.x + kAtBorder || p.y < low_.y + kAtBorder || p.x > high_.x - kAtBorder ||
               p.y > high_.y - kAtBorder;
    }
    bool is_within(const Point3& p) const {
        return p.x >= low_.x && p.y >= low_.y && p.x <= high_.x && p.y <= high_.y;
    }

    /// By how much sphere i would overlap others at p, summed [a].
    double overlap(std::size_t i, const Point3& p) const {
        double sum = 0;
        const int c = column(p.x);
        const int r = row(p.y);
        for (int v = std::max(0, r - 1); v <= std::min(rows_ - 1, r + 1); ++v) {
            for (int u = std::max(0, c - 1); u <= std::min(columns_ - 1, c + 1); ++u) {
                for (const std::size_t j : member_[cell(u, v)]) {
                    if (j == i) continue;
                    const float x = spheres_[j].x - p.x;
                    const float y = spheres_[j].y - p.y;
                    const float z = spheres_[j].z - p.z;
                    const float squared = x * x + y * y + z * z;
                    if (squared < 1) sum += 1 - std::sqrt(static_cast<double>(squared));
                }
            }
        }
        return sum;
    }

    void move(std::size_t i, const Point3& from, const Point3& to) {
        std::vector<std::size_t>& left = of(from);
        std::vector<std::size_t>& entered = of(to);
        if (&left == &entered) return;
        left.erase(std::find(left.begin(), left.end(), i));
        entered.push_back(i);
    }

 private:
    int column(float x) const { return static_cast<int>(x - low_.x); }
    int row(float y) const { return static_cast<int>(y - low_.y); }
    std::size_t cell(int c, int r) const {
        return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(c);
    }
    std::vector<std::size_t>& of(const Point3& p) { return member_[cell(column(p.x), row(p.y))]; }

    const std::vector<Point3>& spheres_;
    Point3 low_, high_;
    int columns_ = 0, rows_ = 0;
    std::vector<std::vector<std::size_t>> member_;
};

}  // namespace

std::vector<Point3> moved_at_random(std::vector<Point3> spheres, double top, double step,
                                    int sweeps, std::uint64_t seed, std::uint64_t stream) {
    if (spheres.empty()) return spheres;
    RandomStream random(seed, "random moves", stream);
    Cells cells(spheres);
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (std::size_t i = 0; i < spheres.size(); ++i) {
            const Point3 here = spheres[i];
            const double dx = random.uniform(-step, step);
            const double dy = random.uniform(-step, step);
            const double dz = random.uniform(-step, step);
            if (cells.is_at_border(here)) continue;
            const Point3 there{
                here.x + static_cast<float>(dx), here.y + static_cast<float>(dy),
                static_cast<float>(std::clamp(static_cast<double>(here.z) + dz, 0.0, top))};
            if (!cells.is_within(there)) continue;
            if (cells.overlap(i, there) > cells.overlap(i, here)) continue;
            cells.move(i, here, there);
            spheres[i] = there;
        }
    }
    return spheres;
}

}  // namespace grainfield::tracking
