#include "report/maps/overlay.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace grainfield::report {

namespace {

constexpr Colour trail_colour{0xe8, 0x59, 0x0c};
constexpr double longest_step = 2;  // diameters

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kTextHeight = 22;  // of capitals, at scale 1 [px]
constexpr int kOneRow = 640;        // narrower pictures have caption and key one below the other
const cv::Scalar kPaper(24, 24, 24);
const cv::Scalar kInk(235, 235, 235);

/// Size of text beside a picture of this width.
double text_scale(int width) {
    return std::clamp(width / 1600.0, 0.4, 1.0);
}

int row_height(int width) {
    return 2 * static_cast<int>(std::lround(kTextHeight * text_scale(width)));
}

int rows(int width) {
    return width < kOneRow ? 2 : 1;
}

int text_width(const std::string& text, double scale) {
    int below = 0;
    return cv::getTextSize(text, kFont, scale, 1, &below).width;
}

/// Text in the middle of a row, as large as `place` holds; returns where it ends.
int write_text(cv::Mat& picture, const std::string& text, cv::Rect place, double scale) {
    const int wanted = text_width(text, scale);
    if (wanted > place.width) scale *= static_cast<double>(place.width) / wanted;
    const int baseline =
        place.y + static_cast<int>(std::lround(0.5 * (place.height + kTextHeight * scale)));
    cv::putText(picture, text, {place.x, baseline}, kFont, scale, kInk, 1, cv::LINE_AA);
    return place.x + std::min(wanted, place.width);
}

cv::Scalar ink(Colour colour) {
    return {static_cast<double>(colour[0]), static_cast<double>(colour[1]),
            static_cast<double>(colour[2])};
}

/// Title, ends and colours of a range within `place`.
void draw_range(cv::Mat& picture, const ColourKey& key, cv::Rect place, double scale) {
    const int gap = place.height / 4;
    const std::string low = fmt::format("{} {:.3g}", key.title, key.low);
    const std::string high = fmt::format("{:.3g}", key.high);
    const int texts = text_width(low, scale) + text_width(high, scale) + 2 * gap;
    const int least = place.width / 3;  // of the colours
    if (texts > place.width - least) scale *= (place.width - least) / static_cast<double>(texts);
    const int begin = write_text(picture, low, place, scale) + gap;
    const int end = place.x + place.width - text_width(high, scale) - gap;
    for (int x = begin; x < end; ++x) {
        const double part = (x - begin) / static_cast<double>(std::max(1, end - begin - 1));
        cv::line(picture, {x, place.y + gap}, {x, place.y + place.height - 1 - gap},
                 ink(viridis(part)));
    }
    write_text(picture, high, {end + gap, place.y, place.x + place.width - end - gap, place.height},
               scale);
}

/// Title, and a square and a name for each class, and for what is in none.
void draw_classes(cv::Mat& picture, const ColourKey& key, cv::Rect place, double scale) {
    const int gap = place.height / 4;
    const int side = place.height - 2 * gap;
    std::vector<std::string> names = key.classes;
    if (!key.other.empty()) names.push_back(key.other);  // its number is that of no class
    int words = text_width(key.title, scale);
    for (const std::string& name : names) words += text_width(name, scale);
    const int squares = static_cast<int>(names.size()) * (side + 2 * gap);
    if (words > place.width - squares) {
        scale *= std::max(1, place.width - squares) / static_cast<double>(words);
    }
    int x = write_text(picture, key.title, place, scale);
    for (std::size_t i = 0; i < names.size(); ++i) {
        x += gap;
        cv::rectangle(picture, cv::Rect{x, place.y + gap, side, side},
                      ink(key.colour_of(static_cast<double>(i))), cv::FILLED);
        x += side + gap;
        const int left = std::max(1, place.x + place.width - x);
        x = write_text(picture, names[i], {x, place.y, left, place.height}, scale);
    }
}

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

Colour ColourKey::colour_of(double value) const {
    if (classes.empty()) return viridis((value - low) / (high > low ? high - low : 1));
    const auto count = static_cast<double>(classes.size());
    if (!(value >= 0 && value < count)) return viridis(std::nan(""));
    return distinct_colour(static_cast<std::size_t>(value), classes.size());
}

Overlay::Overlay(const OverlayOptions& options)
    : options_(options),
      strip_height_(options.has_strip ? rows(options.width) * row_height(options.width) : 0) {}

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
    rgb_.resize(3 * static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()));
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

void Overlay::draw_strip(const std::string& caption) {
    cv::Mat picture(height(), width(), CV_8UC3, rgb_.data());
    cv::rectangle(picture, cv::Rect{0, options_.height, width(), strip_height_}, kPaper,
                  cv::FILLED);
    double scale = text_scale(width());
    const int row = row_height(width());
    const int margin = row / 4;
    const int inner = width() - 2 * margin;
    const bool is_one_row = rows(width()) == 1;
    const int left = is_one_row ? 3 * inner / 5 : inner;
    const cv::Rect words{margin, options_.height, left - 2 * margin, row};
    if (const int wanted = text_width(caption, scale); wanted > words.width) {
        scale *= static_cast<double>(words.width) / wanted;
    }
    write_text(picture, caption, words, scale);
    const int right = is_one_row ? inner - left : inner;
    const cv::Rect place{width() - margin - right, options_.height + (is_one_row ? 0 : row), right,
                         row};
    if (options_.key.classes.empty()) {
        draw_range(picture, options_.key, place, scale);
    } else {
        draw_classes(picture, options_.key, place, scale);
    }
}

const std::vector<std::uint8_t>& Overlay::draw(const Image& image, const Snapshot& snapshot,
                                               const std::vector<double>& values,
                                               const std::string& caption) {
    draw_background(image);
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        const double value = i < values.size() ? values[i] : std::nan("");
        draw_ring(on_picture(snapshot.position[i]), options_.key.colour_of(value), image.empty());
    }
    if (options_.trail > 0) draw_trails(snapshot);
    if (strip_height_ > 0) draw_strip(caption);
    ++frame_;
    return rgb_;
}

}  // namespace grainfield::report
