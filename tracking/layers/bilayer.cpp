#include "tracking/layers/bilayer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "tracking/layers/hitting_set.h"

namespace grainfield::tracking {
namespace {

constexpr double kTolerance = 1e-9;  // of a height [a]

/// Positive weights: what it costs to leave a sphere out.
std::vector<double> weights_of(const std::vector<double>& evidence, std::size_t n) {
    if (evidence.size() != n) {
        throw InputError(ErrorText{"spheres and their evidence differ in number",
                                   fmt::format("{} values", evidence.size()), fmt::format("{}", n),
                                   ""});
    }
    double sum = 0;
    for (const double e : evidence) {
        if (std::isfinite(e)) sum += std::max(e, 0.0);
    }
    // A small price for each sphere keeps as many as possible among sets of equal evidence.
    const double price = sum > 0 ? 1e-9 * sum / static_cast<double>(n) : 1;
    std::vector<double> weight(n);
    for (std::size_t i = 0; i < n; ++i) {
        weight[i] = (std::isfinite(evidence[i]) ? std::max(evidence[i], 0.0) : 0) + price;
    }
    return weight;
}

template <class T>
void keep_rows(std::vector<T>& column, const std::vector<char>& kept) {
    if (column.empty()) return;
    std::size_t n = 0;
    for (std::size_t i = 0; i < column.size(); ++i) {
        if (kept[i] != 0) column[n++] = column[i];
    }
    column.resize(n);
}

}  // namespace

OptionTable describe(LayerOptions& options) {
    OptionTable table("layers");
    table.number("height", options.height, "a", {1, 5},
                 "distance of the plates: rejects spheres without room and names layers");
    table.number("camera-distance", options.camera_distance, "a", {0, 1e9},
                 "distance of a lens with perspective from the spheres; 0: telecentric");
    return table;
}

std::vector<std::vector<std::uint32_t>> impossible_sets(const OverlapGraph& graph) {
    const double slack = graph.slack() + kTolerance;
    std::vector<std::vector<std::uint32_t>> sets;
    for (const OverlapPair& pair : graph.pairs()) {
        if (pair.rise > slack) sets.push_back({pair.first, pair.second});
    }
    std::vector<double> rise_to(graph.size(), 0);  // from i to each neighbour above i in index
    for (std::uint32_t i = 0; i < graph.size(); ++i) {
        for (const auto link : graph.links(i)) {
            if (link.sphere > i) rise_to[link.sphere] = graph.pairs()[link.pair].rise;
        }
        for (const auto link : graph.links(i)) {
            const std::uint32_t j = link.sphere;
            if (j < i) continue;
            const double ij = graph.pairs()[link.pair].rise;
            if (ij <= 0) continue;
            for (const auto far : graph.links(j)) {
                const std::uint32_t k = far.sphere;
                if (k < j || rise_to[k] <= 0) continue;
                const double jk = graph.pairs()[far.pair].rise;
                if (jk <= 0) continue;
                const double largest = std::max({ij, jk, rise_to[k]});
                if (largest <= slack && !three_fit(ij, jk, rise_to[k], slack)) {
                    sets.push_back({i, j, k});
                }
            }
        }
        for (const auto link : graph.links(i)) rise_to[link.sphere] = 0;
    }
    return sets;
}

double share_without_room(const OverlapGraph& graph) {
    std::vector<char> tight(graph.size(), 0);
    for (const auto& set : impossible_sets(graph)) {
        for (const auto i : set) tight[i] = 1;
    }
    const auto n = static_cast<double>(std::max<std::size_t>(1, graph.size()));
    return static_cast<double>(std::ranges::count(tight, 1)) / n;
}

Admissible admissible_spheres(const OverlapGraph& graph, const std::vector<double>& evidence) {
    const std::vector<double> weight = weights_of(evidence, graph.size());
    Admissible result;
    result.kept.assign(graph.size(), 1);
    const auto sets = impossible_sets(graph);
    const HittingSet out = minimum_hitting_set(sets, weight);
    result.is_exact = out.exact;
    std::vector<char> in_pair(graph.size(), 0);
    for (const auto& set : sets) {
        if (set.size() > 2) continue;
        for (const auto i : set) in_pair[i] = 1;
    }
    for (const auto i : out.members) {
        result.kept[i] = 0;
        ++(in_pair[i] != 0 ? result.pairs : result.triples);
    }
    return result;
}

void Bilayer::admit(Snapshot& snapshot, const std::vector<double>& evidence) {
    graph_.emplace(cell_, snapshot.position, snapshot.position_error);
    const Admissible admissible = admissible_spheres(*graph_, evidence);
    summary_.rejected_pairs += admissible.pairs;
    summary_.rejected_triples += admissible.triples;
    summary_.is_exact = summary_.is_exact && admissible.is_exact;
    if (admissible.pairs + admissible.triples > 0) {
        keep_rows(snapshot.position, admissible.kept);
        keep_rows(snapshot.position_error, admissible.kept);
        keep_rows(snapshot.quality, admissible.kept);
        graph_.emplace(cell_, snapshot.position, snapshot.position_error);
    }
    kept_.assign(snapshot.size(), 1);
}

void Bilayer::take(const Snapshot& admitted) {
    graph_.emplace(cell_, admitted.position, admitted.position_error);
    kept_.assign(admitted.size(), 1);
}

void Bilayer::label(Snapshot& snapshot) {
    if (!graph_) return;
    LayerLabels labels = label_layers(*graph_, kept_);
    std::vector<Layer> earlier(snapshot.size(), Layer::unknown);
    for (std::size_t i = 0; i < snapshot.id.size(); ++i) {
        const auto found = earlier_.find(snapshot.id[i]);
        if (found != earlier_.end()) earlier[i] = found->second;
    }
    keep_sides(labels, earlier);
    // A sphere that is unknown for a while keeps its vote.
    earlier_.clear();
    for (std::size_t i = 0; i < snapshot.id.size(); ++i) {
        const Layer now = labels.layer[i] != Layer::unknown ? labels.layer[i] : earlier[i];
        if (now != Layer::unknown) earlier_.emplace(snapshot.id[i], now);
    }
    summary_.spheres += static_cast<std::int64_t>(snapshot.size());
    summary_.labelled += std::count_if(labels.layer.begin(), labels.layer.end(),
                                       [](Layer layer) { return layer != Layer::unknown; });
    summary_.top += std::ranges::count(labels.layer, Layer::top);
    summary_.contradictory += labels.contradictory;
    snapshot.layer = std::move(labels.layer);
}

void transfer(NumberArchive& archive, Bilayer::Summary& summary) {
    auto& [rejected_pairs, rejected_triples, spheres, labelled, top, contradictory, is_exact] =
        summary;
    archive.members<Bilayer::Summary>(rejected_pairs, rejected_triples, spheres, labelled, top,
                                      contradictory, is_exact);
}

std::string in_words(const Bilayer::Summary& summary) {
    return fmt::format("{} bottom, {} top, {} unknown (overlaps do not tell)",
                       summary.labelled - summary.top, summary.top,
                       summary.spheres - summary.labelled);
}

void Bilayer::transfer(NumberArchive& archive) {
    std::vector<std::int64_t> ids;
    std::vector<Layer> layers;
    for (const auto& [id, layer] : earlier_) {
        ids.push_back(id);
        layers.push_back(layer);
    }
    archive(ids);
    archive(layers);
    earlier_.clear();
    for (std::size_t i = 0; i < std::min(ids.size(), layers.size()); ++i) {
        earlier_.emplace(ids[i], layers[i]);
    }
    archive(summary_);
}

}  // namespace grainfield::tracking
