#include "core/snapshot_check.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace grainfield {

namespace {

constexpr std::int64_t most_counted = std::int64_t{1} << 22;

bool is_near(double x, double origin, double length) {
    return x >= origin - farthest_box * length && x <= origin + (1 + farthest_box) * length;
}

// The later of two places with the same identity, the first of them all.
std::optional<std::size_t> repeated_by_order(const std::vector<std::int64_t>& id) {
    std::vector<std::pair<std::int64_t, std::size_t>> sorted(id.size());
    for (std::size_t i = 0; i < id.size(); ++i) sorted[i] = {id[i], i};
    std::ranges::sort(sorted);
    std::optional<std::size_t> first;
    for (std::size_t i = 1; i < sorted.size(); ++i) {
        if (sorted[i].first != sorted[i - 1].first) continue;
        if (!first || sorted[i].second < *first) first = sorted[i].second;
    }
    return first;
}

}  // namespace

std::optional<std::size_t> SnapshotCheck::repeated(const std::vector<std::int64_t>& id) {
    if (id.empty()) return std::nullopt;
    const auto [low, high] = std::ranges::minmax(id);
    if (low < 0 || high >= most_counted) return repeated_by_order(id);
    if (static_cast<std::size_t>(high) >= seen_.size()) {
        seen_.resize(static_cast<std::size_t>(high) + 1, 0);
    }
    if (round_ == std::numeric_limits<std::uint32_t>::max()) {
        std::ranges::fill(seen_, 0);
        round_ = 0;
    }
    ++round_;
    for (std::size_t i = 0; i < id.size(); ++i) {
        if (std::exchange(seen_[static_cast<std::size_t>(id[i])], round_) == round_) return i;
    }
    return std::nullopt;
}

std::optional<SnapshotFlaw> SnapshotCheck::flaw_of(const Snapshot& snapshot) {
    const Box& box = snapshot.box;
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        const Vec2 p = snapshot.position[i];
        if (is_near(p.x, box.origin.x, box.length.x) && is_near(p.y, box.origin.y, box.length.y)) {
            continue;
        }
        if (!is_finite(p)) {
            return SnapshotFlaw{i, fmt::format("it is at ({}, {})", p.x, p.y),
                                "finite coordinates"};
        }
        return SnapshotFlaw{
            i,
            fmt::format("it is at ({:g}, {:g}), beside a box of {:g} × {:g}", p.x, p.y,
                        box.length.x, box.length.y),
            fmt::format("at most {} lengths of the box beside it; positions may be folded back "
                        "into a periodic box, and a box may be given",
                        farthest_box)};
    }
    if (const auto twice = repeated(snapshot.id)) {
        return SnapshotFlaw{*twice, "it stands there twice", "each particle once a frame"};
    }
    return std::nullopt;
}

std::optional<std::size_t> first_not_growing(std::span<const double> times) {
    for (std::size_t i = 1; i < times.size(); ++i) {
        if (!(times[i] > times[i - 1])) return i;
    }
    return std::nullopt;
}

std::string particle_name(const Snapshot& snapshot, std::size_t particle) {
    return snapshot.id.empty() ? fmt::format("particle number {}", particle)
                               : fmt::format("particle {}", snapshot.id[particle]);
}

}  // namespace grainfield
