#include "report/maps/overlay.h"

#include <algorithm>
#include <cmath>

#include "report/figures/colours.h"

namespace grainfield::report {

namespace {

constexpr Colour trail_colour{0xe8, 0x59, 0x0c};
constexpr double longest_step = 2;  // diameters

// The darkest and brightest permille of a frame.
std::array<double, 2> range_of(const Image& image) {
    std::vector<float> counts = image.pixels();
    const auto at = [&](double share) {
        const auto place =
            static_cast<std::ptrdiff_t>(share * static_cast<double>(counts.size() - 1));
        std::ranges::nth_element(counts, counts.begin() + place);
        return static_cast<double>(counts[static_cast<std::size_t>(place)]);
    };
    const double low = at(0.001);
    const double high = at(0.999);
    return {low, high > low ? high : low + 1};
}

}  // namespace

Vec2 Overlay::on_picture(Vec2 position) const {
    const double x = (position.x - options_.x[0]) / (options_.x[1] - options_.x[0]);
    const double y = (position.y - options_.y[0]) / (options_.y[1] - options_.y[0]);
    return {x * options_.width - 0.5, (options_.y_down ? y : 1 - y) * options_.height - 0.5};
}

void Overlay::blend(int x, int y, Colour colour, double share) {
    if (x < 0 || y < 0 || x >= options_.width || y >= options_.height) return;
    std::uint8_t* pixel =
        rgb_.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(options_.width) +
                           static_cast<std::size_t>(x));
    for (std::size_t c = 0; c < 3; ++c) {
        pixel[c] =
            static_cast<std::uint8_t>(std::lround((1 - share) * pixel[c] + share * colour[c]));
    }
}

void Overlay::draw_background(const Image& image) {
    const auto pixels =
        static_cast<std::size_t>(options_.width) * static_cast<std::size_t>(options_.height);
    rgb_.assign(3 * pixels, 255);
    if (image.empty() || image.width() != options_.width || image.height() != options_.height)
        return;
    if (!range_) range_ = range_of(image);
    const auto [low, high] = *range_;
    for (std::size_t i = 0; i < pixels; ++i) {
        const double part = (static_cast<double>(image.pixels()[i]) - low) / (high - low);
        const auto grey = static_cast<std::uint8_t>(std::lround(255 * std::clamp(part, 0.0, 1.0)));
        rgb_[3 * i] = rgb_[3 * i + 1] = rgb_[3 * i + 2] = grey;
    }
}

void Overlay::draw_ring(Vec2 centre, Colour colour, bool filled) {
    const double scale = options_.width / (options_.x[1] - options_.x[0]);
    const double outer = 0.5 * 0.85 * options_.diameter * scale;
    const double inner = filled ? 0 : std::max(0.0, outer - std::max(1.2, 0.25 * outer));
    const int reach = static_cast<int>(std::ceil(outer + 1));
    const int x0 = static_cast<int>(std::lround(centre.x));
    const int y0 = static_cast<int>(std::lround(centre.y));
    for (int y = y0 - reach; y <= y0 + reach; ++y) {
        for (int x = x0 - reach; x <= x0 + reach; ++x) {
            const double r = std::hypot(x - centre.x, y - centre.y);
            // A pixel wide edge on both sides.
            const double outside = std::clamp(outer - r + 0.5, 0.0, 1.0);
            const double inside = filled ? 1 : std::clamp(r - inner + 0.5, 0.0, 1.0);
            if (outside * inside > 0) blend(x, y, colour, outside * inside);
        }
    }
}

void Overlay::draw_line(Vec2 from, Vec2 to) {
    const int steps =
        static_cast<int>(std::ceil(std::max(std::abs(to.x - from.x), std::abs(to.y - from.y)))) + 1;
    for (int i = 0; i <= steps; ++i) {
        const double part = static_cast<double>(i) / steps;
        blend(static_cast<int>(std::lround(from.x + part * (to.x - from.x))),
              static_cast<int>(std::lround(from.y + part * (to.y - from.y))), trail_colour, 0.8);
    }
}

void Overlay::draw_trails(const Snapshot& snapshot) {
    for (std::size_t i = 0; i < snapshot.id.size(); ++i) {
        if (snapshot.id[i] < 0) continue;  // not linked
        Trace& trace = traces_[snapshot.id[i]];
        const Vec2 here = snapshot.position[i];
        if (!trace.points.empty() &&
            norm(here - trace.points.back()) > longest_step * options_.diameter) {
            trace.points.clear();
        }
        trace.points.push_back(here);
        trace.last = frame_;
        if (trace.points.size() > static_cast<std::size_t>(options_.trail) + 1) {
            trace.points.pop_front();
        }
        for (std::size_t p = 1; p < trace.points.size(); ++p) {
            draw_line(on_picture(trace.points[p - 1]), on_picture(trace.points[p]));
        }
    }
    std::erase_if(traces_,
                  [&](const auto& entry) { return frame_ - entry.second.last > options_.trail; });
}

const std::vector<std::uint8_t>& Overlay::draw(const Image& image, const Snapshot& snapshot,
                                               const std::vector<double>& abs_q4) {
    draw_background(image);
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        const double q = i < abs_q4.size() ? abs_q4[i] : std::nan("");
        draw_ring(on_picture(snapshot.position[i]), viridis(q), image.empty());
    }
    if (options_.trail > 0) draw_trails(snapshot);
    ++frame_;
    return rgb_;
}

}  // namespace grainfield::report
