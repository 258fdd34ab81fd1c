#include "report/page/paper_table.h"

#include <cmath>

#include <fmt/format.h>

#include "report/page/text.h"

namespace grainfield::report {

namespace {

constexpr double agreement = 2;          // standard errors
constexpr double least_resolved = 0.25;  // our error over the paper's value

bool is_known(const Measurement& m) {
    return m.value && m.error && std::isfinite(*m.value) && std::isfinite(*m.error) && *m.error > 0;
}

struct Found {
    const Measurement* measurement = nullptr;
    std::size_t run = 0;
};

// The measurement of the run with the largest control parameter; one with an error goes first.
Found find(const PaperValue& paper, const std::vector<Results>& runs,
           const std::vector<std::string>& labels, const std::vector<RunIdentity>& identities) {
    Found best;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        if (identities[r].origin != paper.origin) continue;
        if (!paper.label.empty() && labels[r] != paper.label) continue;
        const ObservableResult* observable = runs[r].find(paper.observable);
        const Measurement* m =
            observable == nullptr ? nullptr : observable->find_measurement(paper.measurement);
        if (m == nullptr) continue;
        if (best.measurement != nullptr && is_known(*best.measurement)) {
            const bool further =
                identities[r].value.value_or(0) > identities[best.run].value.value_or(0);
            if (!is_known(*m) || !further) continue;
        }
        best = {m, r};
    }
    return best;
}

}  // namespace

std::string verdict(const PaperValue& paper, const Measurement* ours) {
    const char* const unresolved = "not resolved at this scale";
    if (ours == nullptr || !is_known(*ours)) return unresolved;
    if (*ours->error > least_resolved * std::abs(paper.value)) return unresolved;
    const double apart =
        std::abs(*ours->value - paper.value) / std::hypot(*ours->error, paper.error);
    return apart <= agreement ? "agrees" : fmt::format("differs by {:.1f} σ", apart);
}

Table paper_table(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                  const std::vector<RunIdentity>& identities) {
    Table table;
    table.name = "paper";
    table.title = "The paper and this run";
    table.note =
        "Paper: Castillo et al., Phys. Rev. E 100, 032902 (2019). Molecular dynamics of its walled "
        "cell, rendered and tracked, stand in for the experiment. σ: standard errors of both "
        "together, of rounded values (≈) half of the last digit. What the text leaves open: "
        "docs/paper.md.";
    table.columns = {{"paper", "Paper", "", true},
                     {"ours", "Ours", "", true},
                     {"run", "Run", "", true},
                     {"verdict", "Verdict", "", true}};
    for (const PaperValue& paper : paper_values()) {
        const Found found = find(paper, runs, labels, identities);
        const Measurement* m = found.measurement;
        const double* error = paper.is_rounded ? nullptr : &paper.error;
        const auto words = [](const std::string& text) { return TableCell{.text = text}; };
        std::string ours = "not measured";
        if (m != nullptr && m->value) ours = with_error(*m->value, m->error ? &*m->error : nullptr);
        if (m != nullptr && !m->value && !m->reason.empty()) ours = m->reason;
        TableCell judged = words(verdict(paper, m));
        judged.failed = judged.text.starts_with("differs");
        table.rows.push_back(
            {paper.name,
             {words((error == nullptr ? "≈ " : "") + with_error(paper.value, error)), words(ours),
              words(m == nullptr ? "–" : labels[found.run]), judged}});
    }
    return table;
}

}  // namespace grainfield::report
