#include "tracking/calibrate/illumination.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace grainfield::tracking {
namespace {

constexpr double kSample = 4e4;  // fewer, and the medians of whole counts jump by half a count
// Below this share of the pixels a level is not seen well enough to be followed.
constexpr double kLeastShare = 0.01;
// Ranks shift a little when spheres gather or leave; the fit settles what is smaller than this.
constexpr double kRankAccuracy = 0.01;
// Below this share of the first contrast a frame shows something else.
constexpr double kDimmest = 0.2;
constexpr float kClear = 0.995F;
constexpr float kCore = 0.005F;

/// The value of that rank; the order of the values is changed.
double at_rank(std::vector<float>& values, std::size_t rank) {
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(values.begin(), place, values.end());
    return static_cast<double>(*place);
}

double at_share(std::vector<float>& values, double share) {
    const double last = static_cast<double>(values.size() - 1);
    return at_rank(values, static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * last));
}

double median(std::vector<float>& values) {
    return at_rank(values, values.size() / 2);
}

}  // namespace

/// Once for each size of the frames: the background is a polynomial, and dear.
void IlluminationFollower::choose_pixels(const Image& counts) {
    if (counts.width() == width_ && counts.height() == height_) return;
    width_ = counts.width();
    height_ = counts.height();
    pixels_.clear();
    const double pixels = static_cast<double>(counts.size());
    const int stride = std::max(1, static_cast<int>(std::sqrt(pixels / kSample)));
    for (int y = stride / 2; y < height_; y += stride) {
        for (int x = stride / 2; x < width_; x += stride) {
            if (visible_(x, y)) pixels_.push_back({x, y, model_.darkness_of(x, y)});
        }
    }
}

std::vector<float> IlluminationFollower::sample_of(const Image& counts) {
    choose_pixels(counts);
    std::vector<float> values;
    values.reserve(pixels_.size());
    for (const Pixel& p : pixels_) values.push_back(p.darkness(counts(p.x, p.y)));
    return values;
}

Illumination IlluminationFollower::expected(const Image& counts) {
    std::vector<float> now = sample_of(counts);
    Illumination light = state_.last;
    if (!state_.sample.empty() && !now.empty()) {
        const auto below = [&](double darkness) {
            const auto value = static_cast<float>(state_.last.offset + state_.last.span * darkness);
            const auto count = std::count_if(state_.sample.begin(), state_.sample.end(),
                                             [value](float other) { return other < value; });
            return static_cast<double>(count) / static_cast<double>(state_.sample.size());
        };
        const double clear = below(0.25);
        const double core = 1 - below(0.75);
        const auto change = [&](double share) {
            const double difference = at_share(now, share) - at_share(state_.sample, share);
            return std::abs(difference) < kRankAccuracy ? 0 : difference;
        };
        const double clear_change = clear > kLeastShare ? change(clear / 4) : 0;
        const double core_change = core > kLeastShare ? change(1 - core / 4) : 0;
        light.offset += clear_change;
        light.span += core_change - clear_change;
        // Spheres that are all gone are not a change of the light.
        if (!(light.span > kDimmest)) light = state_.last;
    }
    state_.sample = std::move(now);
    return light;
}

Illumination IlluminationFollower::settled(const Image& counts, const Illumination& used,
                                           const PaddedImage& transmission) {
    std::vector<float> clear;
    std::vector<float> core;
    choose_pixels(counts);
    for (const Pixel& p : pixels_) {
        const float t = transmission(p.x, p.y);
        if (t <= kClear && t >= kCore) continue;
        const float d = p.darkness(counts(p.x, p.y));
        const auto offset = static_cast<float>(used.offset);
        (t > kClear ? clear : core).push_back((d - offset) / static_cast<float>(used.span));
    }
    const double least = kLeastShare * static_cast<double>(state_.sample.size());
    state_.last = used;
    const bool has_clear = static_cast<double>(clear.size()) > least;
    const bool has_core = static_cast<double>(core.size()) > least;
    if (!state_.has_reference) {
        if (has_clear) state_.clear_reference = median(clear);
        if (has_core) state_.core_reference = median(core);
        state_.has_reference = has_clear || has_core;
        return state_.last;
    }
    const double low = has_clear ? median(clear) - state_.clear_reference : 0;
    const double high = has_core ? median(core) - state_.core_reference : 0;
    const double span = 1 + (high - low) / (state_.core_reference - state_.clear_reference);
    if (used.span * span > kDimmest) {
        state_.last.offset = used.offset + used.span * (low - state_.clear_reference * (span - 1));
        state_.last.span = used.span * span;
    }
    return state_.last;
}

void transfer(NumberArchive& archive, Illumination& light) {
    auto& [offset, span] = light;
    archive.members<Illumination>(offset, span);
}

void IlluminationFollower::State::transfer(NumberArchive& archive) {
    auto& [values, light, is_compared, clear, core] = *this;
    archive.members<State>(values, light, is_compared, clear, core);
}

}  // namespace grainfield::tracking
