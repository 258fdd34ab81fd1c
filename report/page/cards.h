#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/results.h"
#include "report/maps/particle_map.h"

namespace grainfield::report {

/// What one run says on a card.
struct CardValue {
    std::string value;   ///< "10,314"; empty: the run has none
    std::string detail;  ///< "31 frames"; may be empty
};

/// A number that is read first.
struct Card {
    std::string title;              ///< "Lattice spacing"
    std::vector<CardValue> values;  ///< one a run
};

/// At most six cards that some run has a value for, in this order: spheres a frame, diameter, frame
/// rate, shares of the phases with the rest, lattice spacing, diffusion coefficient or S(k→0), or S
/// at the lowest k; then residual, mean order and number density for those that are missing.
/// `sphere_mm`: true diameter of the spheres [mm], for lengths in mm.
std::vector<Card> make_cards(const std::vector<Results>& runs, std::optional<double> sphere_mm);

/// The cards as HTML; with several runs each card has one line a run, in its colour.
std::string cards_html(const std::vector<Card>& cards, const std::vector<std::string>& labels);

/// One sentence: "10,314 spheres a frame; residual 0.059, good; 3 places to look at". The
/// residual is judged by fit_quality; only frames of a camera have one.
/// That no place stands out is said where the residual is not poor. A field run: "Field, 2D, b = 4,
/// ν = 0.01; S₀ = 0.0110 ± 0.0020", or its mean density.
/// `places`: of all maps of the run; where none was drawn they are not known, and not spoken of.
std::string verdict(const Results& run, std::optional<std::size_t> places);

/// "residual 0.130, noise 0.120, good"; both in units of the contrast. Noise 0: not known, not
/// said.
std::string residual_words(double residual, double noise);

/// Where S0/S1 vanishes: "Critical at ν = 0.0012 ± 0.0004.", with its interval where that is known,
/// or why it is not. Of results of `critical`.
std::string critical_sentence(const Results& run);

/// The file that the run began with: "layer.avi", "frame_0000.tif and 30 more".
std::string first_file(const Results& run);

}  // namespace grainfield::report
