#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/option_table.h"
#include "core/snapshot.h"
#include "core/support/number_archive.h"
#include "tracking/layers/layer_labels.h"
#include "tracking/layers/overlap_graph.h"

namespace grainfield::tracking {

struct LayerOptions {
    std::optional<double> height;           ///< distance of the plates L_z [a]; empty: no layers
    std::optional<double> camera_distance;  ///< of a pinhole, Z [a]; 0 or empty: telecentric
};

OptionTable describe(LayerOptions& options);

/// Sets of spheres that no heights fit: pairs with δ > H, that is d < sqrt(a² − (L_z − a)²), and
/// triples whose two smaller δ add up to more than H (all sides below sqrt(1 − ((L_z − a)/2a)²) a,
/// for instance). Each ascending. O(pairs times neighbours).
std::vector<std::vector<std::uint32_t>> impossible_sets(const OverlapGraph& graph);

/// Share of the spheres that are in an impossible set, 0 … 1; 0 without spheres. It tells a
/// diameter that is too large, or a cell that is too low. Of 68 ray-traced cameras drawn at random
/// it is 0.002 at most with the right diameter. With one 10 % too large it is 0.059 in the median,
/// and above 0.006 for 62 of them.
double share_without_room(const OverlapGraph& graph);

/// The likeliest spheres without any impossible pair or triple among them:
///
///     maximise Σ_kept evidence   subject to   one of every impossible set is left out.
///
/// One value a sphere, 0: left out. `evidence` is what each sphere explains, any unit; it is exact
/// unless a group of conflicts needs too many branches (`is_exact`). No sphere of a scene that fits
/// between the plates is ever left out.
struct Admissible {
    std::vector<char> kept;
    std::int64_t pairs = 0, triples = 0;  ///< spheres left out, by the smallest set they were in
    bool is_exact = true;
};
Admissible admissible_spheres(const OverlapGraph& graph, const std::vector<double>& evidence);

/// What the height of the cell says about the spheres of a film: which cannot be there (admit), and
/// in which layer the others lie (label: label_layers; the sides of a cluster are kept from frame
/// to frame by the identities of its spheres).
class Bilayer {
 public:
    explicit Bilayer(const SphereCell& cell) : cell_(cell) {}

    /// Takes spheres without room out of the snapshot, which has positions, errors [px] and
    /// quality, and is not yet linked. `evidence`: one value a sphere.
    void admit(Snapshot& snapshot, const std::vector<double>& evidence);

    /// Takes a snapshot that has been through admit() before, in another run, as label() needs it.
    void take(const Snapshot& admitted);

    /// Fills `layer`; call after admit() or take(), and linking.
    void label(Snapshot& snapshot);

    struct Summary {
        std::int64_t rejected_pairs = 0, rejected_triples = 0;
        std::int64_t spheres = 0;        ///< kept, all frames
        std::int64_t labelled = 0;       ///< of those
        std::int64_t top = 0;            ///< of the labelled
        std::int64_t contradictory = 0;  ///< in rings that no heights fit
        bool is_exact = true;            ///< what is kept is proven to be the likeliest
    };
    const Summary& summary() const { return summary_; }

    /// Saves or restores what the next frame needs to know of those before it.
    void transfer(NumberArchive& archive);

 private:
    SphereCell cell_;
    std::optional<OverlapGraph> graph_;
    std::vector<char> kept_;
    std::unordered_map<std::int64_t, Layer> earlier_;  ///< by identity
    Summary summary_;
};

/// Saves or restores it.
void transfer(NumberArchive& archive, Bilayer::Summary& summary);

/// How many positions are in which layer, and in none that is known.
std::string in_words(const Bilayer::Summary& summary);

}  // namespace grainfield::tracking
