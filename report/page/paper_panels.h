#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/figure_hint.h"
#include "core/results.h"
#include "core/run_identity.h"
#include "report/figures/figure.h"
#include "report/maps/particle_map.h"
#include "report/page/paper_table.h"

namespace grainfield::report {

/// A number of the paper beside ours, as one line under a panel.
struct PaperLine {
    std::string words;  ///< "Γc: paper 4.730 ± 0.150, ours 3.62 ± 0.22"
    Agreement agreement = Agreement::unresolved;
    std::string verdict;  ///< "differs by 4.2 σ"; empty where the paper gives no number
};

/// A panel of a figure of `castillo2019`, made from the runs that stand for it.
struct PaperPanel {
    std::string number;              ///< "2a"
    std::string title;               ///< "S/S₁"
    std::string claim;               ///< what the paper says there
    std::optional<Figure> figure{};  ///< named "paper_2a"; nothing where no run has the curve
    std::string absent{};            ///< then why
    std::vector<PaperLine> lines{};
    std::optional<Origin> committed{};  ///< the figure is of committed results, made by this
};

/// The panels of Figs. 1b to 4b in the order of the paper: 1b, 2a … 2i, 3, 4a, 4b. Tracked films
/// stand for its experiment. The paper's numbers are marked in them by guides. Curves of 1b are
/// those of the run that `run_of_paper_map` shows. `committed`: kept results of one origin. A panel
/// of the experiment without a figure takes theirs, whose legend names them in full.
std::vector<PaperPanel> paper_panels(const std::vector<Results>& runs,
                                     const std::vector<std::string>& labels,
                                     const std::vector<FigureHint>& hints,
                                     const std::vector<Results>& committed = {});

/// The tracked run for the map of |Q4|, Fig. 1b: the one nearest to Γ = 4.5 that has |Q4| and a
/// preview.
std::optional<std::size_t> run_of_paper_map(const std::vector<Results>& runs);

/// "5 of 11 numbers of the paper agree, 1 differs, 5 are not resolved at this scale."
std::string paper_verdict(const std::vector<Results>& runs);

}  // namespace grainfield::report
