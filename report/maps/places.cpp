#include "report/maps/places.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace grainfield::report {

namespace {

constexpr double remarkable = 4;   // medians
constexpr std::size_t most = 400;  // spheres that are looked at

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

}  // namespace

std::vector<Place> places_to_look_at(const Snapshot& snapshot, double diameter) {
    std::vector<double> known;
    for (const double q : snapshot.quality) {
        if (std::isfinite(q)) known.push_back(q);
    }
    if (known.size() < 2 || snapshot.quality.size() != snapshot.size()) return {};
    const double threshold = remarkable * median(known);
    std::vector<std::size_t> worst;
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        const double q = snapshot.quality[i];
        if (std::isfinite(q) && q > threshold && q > 0) worst.push_back(i);
    }
    std::ranges::stable_sort(worst, [&](std::size_t a, std::size_t b) {
        return snapshot.quality[a] > snapshot.quality[b];
    });
    if (worst.size() > most) worst.resize(most);
    // Each place grows from its worst sphere through neighbours.
    std::vector<Place> places;
    std::vector<bool> taken(worst.size(), false);
    for (std::size_t i = 0; i < worst.size(); ++i) {
        if (taken[i]) continue;
        Place place{snapshot.position[worst[i]], snapshot.quality[worst[i]], 0};
        std::vector<std::size_t> edge{i};
        taken[i] = true;
        while (!edge.empty()) {
            const Vec2 here = snapshot.position[worst[edge.back()]];
            edge.pop_back();
            ++place.spheres;
            for (std::size_t j = i + 1; j < worst.size(); ++j) {
                if (taken[j] || norm(snapshot.position[worst[j]] - here) > 2 * diameter) continue;
                taken[j] = true;
                edge.push_back(j);
            }
        }
        places.push_back(place);
    }
    return places;
}

}  // namespace grainfield::report
