#include "report/page/definitions.h"

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "report/text.h"

namespace grainfield::report {

namespace {

using Entry = std::pair<std::string_view, std::string_view>;

// A longer term stands before those that it contains.
constexpr std::array entries{
    Entry{"|Q₄|",
          "Bond-orientational order of a sphere: |⟨exp 4iθ⟩| over its near neighbours at "
          "angles θ. 1 in a perfect square lattice, about 0.3 in a liquid."},
    Entry{"σ²(ℓ)", "Variance of the number of spheres in square windows of side ℓ."},
    Entry{"σ²", "Variance of the number of spheres in a window."},
    Entry{"S₀/S₁",
          "S₀ over S₁ of the fit S(k) = S₀ + S₁ (ka)^α. It goes to zero at the critical "
          "point."},
    Entry{"S(k→0)", "What S(k) tends to at long waves, S₀ of the fit S₀ + S₁ (ka)^α."},
    Entry{"S at the lowest k",
          "S(k) of the longest waves that were measured. It is no limit k → 0. Between walls it is "
          "that of the modes that fit there: plane waves leak and give too little."},
    Entry{"S(k)",
          "Structure factor: the mean squared amplitude of density waves with wavevector "
          "k, over the number of spheres. 1 if spheres ignored one another."},
    Entry{"S₀",
          "S(k) at k → 0 by the fit S₀ + S₁ (ka)^α: fluctuations of density at the largest "
          "scale."},
    Entry{"S₁", "Prefactor of the fit S(k) = S₀ + S₁ (ka)^α at small k."},
    Entry{
        "MSD exponent",
        "Slope of ln MSD against ln t over the last decade of lag times. 1: diffusion, 2: flight, "
        "below 1: a cage, or an offset c of MSD = 4 D t + c, which only --localisation removes."},
    Entry{"MSD", "Mean squared displacement of a sphere in a lag time."},
    Entry{"Γ", "Acceleration of the vibration over gravity, A ω²/g."},
    Entry{"ε", "Distance to the critical acceleration, (Γc − Γ)/Γc: above zero in the liquid."},
    Entry{"ν", "Distance of the field model to its critical point."},
    Entry{"residual",
          "Root mean square of picture less image model, in units of the contrast "
          "between sphere and background. Camera noise alone gives 0.01 to 0.03."},
    Entry{"Bond-orientational order",
          "|Q₄| of a sphere: |⟨exp 4iθ⟩| over its near neighbours at angles θ."},
    Entry{"Mean squared displacement", "⟨|r(t₀ + t) − r(t₀)|²⟩ over spheres and times t₀."},
    Entry{"Structure factor",
          "S(k): the mean squared amplitude of density waves with wavevector k, over the number of "
          "spheres. 1 if spheres ignored one another."},
    Entry{"Number variance", "σ²(ℓ): variance of the number of spheres in windows of side ℓ."},
    Entry{"Diffusion coefficient", "D of MSD = 4 D t + c, fitted to the last decade of lag times."},
    Entry{"Lattice spacing",
          "Mean distance of the four neighbours in the solid, seen from above. "
          "Two layers of a bilayer interleave, so that it is below a."},
    Entry{"Phases",
          "Solid: |Q₄| averaged over the averaging time is 0.7 or more. Liquid: 0.4 or "
          "less. The rest lies between."},
    Entry{"Particle diameter a",
          "Diameter of a sphere: the true one if given, else the apparent one. It is the unit of "
          "all lengths."},
    Entry{"Frame rate", "Frames a second. Without it times are in frames."},
};

bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool stands_alone(std::string_view text, std::size_t at, std::string_view term) {
    const auto joins = [&](std::size_t place, char edge) {
        return is_letter(edge) && place < text.size() && is_letter(text[place]);
    };
    return !(at > 0 && joins(at - 1, term.front())) && !joins(at + term.size(), term.back());
}

}  // namespace

std::string_view definition_of(std::string_view term) {
    for (const auto& [name, meaning] : entries) {
        if (name == term) return meaning;
    }
    return {};
}

std::string defined(const std::string& shown, std::string_view definition) {
    if (definition.empty()) return shown;
    return "<span class=\"term\" tabindex=\"0\">" + shown +
           "<span class=\"meaning\" role=\"tooltip\">" + escape_html(definition) + "</span></span>";
}

std::string with_definitions(std::string_view text) {
    std::vector<bool> used(entries.size(), false);
    std::string out;
    std::size_t plain = 0;
    for (std::size_t at = 0; at < text.size();) {
        std::size_t found = entries.size();
        for (std::size_t e = 0; e < entries.size() && found == entries.size(); ++e) {
            const std::string_view term = entries[e].first;
            if (text.substr(at).starts_with(term) && stands_alone(text, at, term)) found = e;
        }
        if (found == entries.size()) {
            ++at;
            continue;
        }
        const std::string_view term = entries[found].first;
        if (!used[found]) {
            out += escape_html(text.substr(plain, at - plain));
            out += defined(escape_html(term), entries[found].second);
            plain = at + term.size();
        }
        used[found] = true;
        at += term.size();
    }
    return out + escape_html(text.substr(plain));
}

}  // namespace grainfield::report
