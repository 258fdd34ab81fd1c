#include "bench/tracking/reference_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace grainfield::bench {

namespace {

using tracking::DiscProfile;

constexpr double kRoom = 1;  // how far a disc may be from the middle of its window [px]

template <class Real>
class ReferenceFit {
 public:
    ReferenceFit(const Image& darkness, const DiscProfile& disc, const std::vector<Vec2>& start,
                 const ReferenceFitOptions& options)
        : darkness_(darkness),
          options_(options),
          radius_(static_cast<Real>(disc.radius())),
          reach_(static_cast<Real>(disc.reach())),
          steepness_(static_cast<Real>(2 / disc.edge_width)),
          ring_(static_cast<Real>(options.ring * disc.edge_width)),
          longest_step_(static_cast<Real>(disc.edge_width)),
          half_(static_cast<int>(std::ceil(disc.reach() + kRoom))),
          side_(2 * half_ + 1) {
        for (const Vec2 p : start) {
            discs_.push_back({static_cast<Real>(p.x), static_cast<Real>(p.y), 0, 0, {}, {}});
        }
        const double near = 2 * disc.reach() + disc.diameter / 2;
        for (std::size_t i = 0; i < discs_.size(); ++i) {
            place_window(discs_[i]);
            for (std::size_t j = 0; j < i; ++j) {
                if (squared_norm(start[i] - start[j]) > near * near) continue;
                discs_[i].neighbours.push_back(j);
                discs_[j].neighbours.push_back(i);
            }
        }
    }

    void refine() {
        std::vector<Real> last(discs_.size(), longest_step_);
        const auto tolerance = static_cast<Real>(options_.tolerance);
        for (int sweep = 0; sweep < options_.max_sweeps; ++sweep) {
            bool any = false;
            std::vector<Real> now(discs_.size(), Real{0});
            for (std::size_t j = 0; j < discs_.size(); ++j) {
                const auto moves = [&](std::size_t k) { return last[k] > tolerance; };
                const auto& near = discs_[j].neighbours;
                if (!moves(j) && std::none_of(near.begin(), near.end(), moves)) continue;
                now[j] = step(discs_[j]);
                any = any || now[j] > tolerance;
            }
            if (!any) return;
            last.swap(now);
        }
    }

    std::vector<Vec2> positions() const {
        std::vector<Vec2> positions;
        for (const Disc& d : discs_) {
            positions.push_back({static_cast<double>(d.x), static_cast<double>(d.y)});
        }
        return positions;
    }

 private:
    struct Disc {
        Real x, y;
        int left, top;        // of its window
        std::vector<Real> p;  // its darkness there
        std::vector<std::size_t> neighbours;
    };

    void place_window(Disc& d) const {
        d.left = static_cast<int>(std::lround(d.x)) - half_;
        d.top = static_cast<int>(std::lround(d.y)) - half_;
        draw(d, d.x, d.y, d.p);
    }

    void draw(const Disc& d, Real x, Real y, std::vector<Real>& p) const {
        p.resize(static_cast<std::size_t>(side_ * side_));
        Real* at = p.data();
        for (int row = 0; row < side_; ++row) {
            const Real dy = static_cast<Real>(d.top + row) - y;
            for (int column = 0; column < side_; ++column, ++at) {
                const Real dx = static_cast<Real>(d.left + column) - x;
                const Real r2 = dx * dx + dy * dy;
                *at = r2 < reach_ * reach_
                          ? 1 / (1 + std::exp(steepness_ * (std::sqrt(r2) - radius_)))
                          : 0;
            }
        }
    }

    // Σ, max or Π of what all other discs make of the window.
    void gather_others(const Disc& d) {
        const bool is_product = options_.sum == ImageSum::product;
        others_.assign(static_cast<std::size_t>(side_ * side_), is_product ? Real{1} : Real{0});
        for (const std::size_t k : d.neighbours) {
            const Disc& o = discs_[k];
            const int x0 = std::max(d.left, o.left);
            const int x1 = std::min(d.left, o.left) + side_;
            const int y0 = std::max(d.top, o.top);
            const int y1 = std::min(d.top, o.top) + side_;
            for (int y = y0; y < y1; ++y) {
                Real* here = others_.data() + (y - d.top) * side_ + (x0 - d.left);
                const Real* there = o.p.data() + (y - o.top) * side_ + (x0 - o.left);
                for (int x = x0; x < x1; ++x, ++here, ++there) add(*here, *there);
            }
        }
    }

    void add(Real& others, Real p) const {
        switch (options_.sum) {
            case ImageSum::additive:
                others += p;
                return;
            case ImageSum::maximum:
                others = std::max(others, p);
                return;
            case ImageSum::product:
                others *= 1 - p;
        }
    }

    Real model(Real others, Real p) const {
        switch (options_.sum) {
            case ImageSum::additive:
                return others + p;
            case ImageSum::maximum:
                return std::max(others, p);
            case ImageSum::product:
                break;
        }
        return 1 - others * (1 - p);
    }

    // ∂M/∂P.
    Real share(Real others, Real p) const {
        switch (options_.sum) {
            case ImageSum::additive:
                return 1;
            case ImageSum::maximum:
                return p > others ? Real{1} : Real{0};
            case ImageSum::product:
                break;
        }
        return others;
    }

    template <class Body>
    void each_pixel(const Disc& d, const Body& body) const {
        const int x0 = std::max(0, -d.left);
        const int x1 = std::min(side_, darkness_.width() - d.left);
        for (int row = std::max(0, -d.top); row < std::min(side_, darkness_.height() - d.top);
             ++row) {
            for (int column = x0; column < x1; ++column) {
                body(column, row, static_cast<Real>(darkness_(d.left + column, d.top + row)));
            }
        }
    }

    Real misfit(const Disc& d, const std::vector<Real>& p) const {
        Real sum = 0;
        each_pixel(d, [&](int column, int row, Real seen) {
            const auto i = static_cast<std::size_t>(row * side_ + column);
            const Real r = seen - model(others_[i], p[i]);
            sum += r * r;
        });
        return sum;
    }

    // Returns how far the disc went.
    Real step(Disc& d) {
        gather_others(d);
        Real xx = 0, xy = 0, yy = 0, bx = 0, by = 0;
        each_pixel(d, [&](int column, int row, Real seen) {
            const Real dx = static_cast<Real>(d.left + column) - d.x;
            const Real dy = static_cast<Real>(d.top + row) - d.y;
            const Real distance = std::sqrt(dx * dx + dy * dy);
            if (std::abs(distance - radius_) > ring_ || distance == 0) return;
            const auto i = static_cast<std::size_t>(row * side_ + column);
            const Real p = d.p[i];
            const Real slope = share(others_[i], p) * steepness_ * p * (1 - p) / distance;
            const Real jx = slope * dx;
            const Real jy = slope * dy;
            const Real r = seen - model(others_[i], p);
            xx += jx * jx;
            xy += jx * jy;
            yy += jy * jy;
            bx += jx * r;
            by += jy * r;
        });
        const Real damping = static_cast<Real>(1e-6) * (xx + yy);
        xx += damping;
        yy += damping;
        const Real determinant = xx * yy - xy * xy;
        if (!(determinant > 0)) return 0;
        Real dx = (yy * bx - xy * by) / determinant;
        Real dy = (xx * by - xy * bx) / determinant;
        const Real length = std::sqrt(dx * dx + dy * dy);
        Real part = std::min(Real{1}, longest_step_ / length);
        const Real before = misfit(d, d.p);
        for (int attempt = 0; attempt < 5; ++attempt, part /= 2) {
            draw(d, d.x + part * dx, d.y + part * dy, trial_);
            if (misfit(d, trial_) > before) continue;
            d.x += part * dx;
            d.y += part * dy;
            d.p.swap(trial_);
            const auto off = [&](Real at, int first) {
                return std::abs(at - static_cast<Real>(first + half_));
            };
            if (std::max(off(d.x, d.left), off(d.y, d.top)) > static_cast<Real>(kRoom)) {
                place_window(d);
            }
            return part * length;
        }
        return 0;
    }

    const Image& darkness_;
    const ReferenceFitOptions& options_;
    Real radius_, reach_, steepness_, ring_, longest_step_;
    int half_, side_;
    std::vector<Disc> discs_;
    std::vector<Real> others_, trial_;
};

}  // namespace

template <class Real>
std::vector<Vec2> reference_fit(const Image& darkness, const DiscProfile& disc,
                                const std::vector<Vec2>& start,
                                const ReferenceFitOptions& options) {
    ReferenceFit<Real> fit(darkness, disc, start, options);
    fit.refine();
    return fit.positions();
}

template std::vector<Vec2> reference_fit<float>(const Image&, const DiscProfile&,
                                                const std::vector<Vec2>&,
                                                const ReferenceFitOptions&);
template std::vector<Vec2> reference_fit<double>(const Image&, const DiscProfile&,
                                                 const std::vector<Vec2>&,
                                                 const ReferenceFitOptions&);

}  // namespace grainfield::bench
