#include "tracking/score/layer_score.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "tracking/point_grid.h"
#include "tracking/score/share.h"

namespace grainfield::tracking {

namespace {

/// The representative of each particle's cluster.
std::vector<std::uint32_t> clusters(const std::vector<Vec2>& points, double contact) {
    std::vector<std::uint32_t> parent(points.size());
    std::iota(parent.begin(), parent.end(), 0U);
    const auto root = [&](std::uint32_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    const PointGrid grid(points, contact);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        grid.around(points[i], [&](std::uint32_t j, Vec2 p) {
            if (j >= i || norm(p - points[i]) >= contact) return;
            const std::uint32_t a = root(i);
            const std::uint32_t b = root(j);
            parent[std::max(a, b)] = std::min(a, b);
        });
    }
    for (std::uint32_t i = 0; i < points.size(); ++i) parent[i] = root(i);
    return parent;
}

}  // namespace

double LayerScore::named() const {
    return share(labelled, matched);
}

double LayerScore::accuracy() const {
    return share(right, labelled);
}

double LayerScore::accuracy_up_to_flip() const {
    return share(right_up_to_flip, tested);
}

void LayerScore::add(const std::vector<Vec2>& truth, const std::vector<Layer>& true_layer,
                     const std::vector<Layer>& found_layer, const std::vector<int>& partner,
                     double contact) {
    if (true_layer.empty()) return;
    std::vector<Vec2> place;  // of those with a label
    std::vector<char> is_right;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (partner[i] < 0 || true_layer[i] == Layer::unknown) continue;
        ++matched;
        if (found_layer.empty()) continue;
        const Layer label = found_layer[static_cast<std::size_t>(partner[i])];
        if (label == Layer::unknown) continue;
        place.push_back(truth[i]);
        is_right.push_back(label == true_layer[i] ? 1 : 0);
    }
    const std::vector<std::uint32_t> cluster = clusters(place, contact);
    std::vector<std::int64_t> right_in(place.size(), 0);
    std::vector<std::int64_t> labelled_in(place.size(), 0);
    for (std::size_t i = 0; i < place.size(); ++i) {
        ++labelled_in[cluster[i]];
        right_in[cluster[i]] += is_right[i];
    }
    for (std::size_t c = 0; c < place.size(); ++c) {
        if (labelled_in[c] == 0) continue;
        labelled += labelled_in[c];
        right += right_in[c];
        tested += labelled_in[c] - 1;
        right_up_to_flip += std::max(right_in[c], labelled_in[c] - right_in[c]) - 1;
    }
}

}  // namespace grainfield::tracking
