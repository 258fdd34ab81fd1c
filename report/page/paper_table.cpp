#include "report/page/paper_table.h"

#include <cmath>

#include <fmt/format.h>

#include "report/text.h"

namespace grainfield::report {

namespace {

constexpr double most_apart = 2;         // standard errors
constexpr double least_resolved = 0.25;  // our error over the paper's value

bool is_known(const Measurement& m) {
    return m.value && m.error && std::isfinite(*m.value) && std::isfinite(*m.error) && *m.error > 0;
}

}  // namespace

PaperMeasurement paper_measurement(const PaperValue& paper, const std::vector<Results>& runs) {
    PaperMeasurement best;
    const auto control = [&](std::size_t r) {
        const auto& known = runs[r].identity.control;
        return known ? known->value : 0;
    };
    for (std::size_t r = 0; r < runs.size(); ++r) {
        if (!same_series(runs[r].identity, paper.series)) continue;
        const ObservableResult* observable = runs[r].find(paper.observable);
        const Measurement* m =
            observable == nullptr ? nullptr : observable->find_measurement(paper.measurement);
        if (m == nullptr) continue;
        if (best.measurement != nullptr && is_known(*best.measurement)) {
            if (!is_known(*m) || !(control(r) > control(best.run))) continue;
        }
        best = {m, r};
    }
    return best;
}

std::string paper_text(const PaperValue& paper) {
    return paper.is_rounded ? "≈ " + with_error(paper.value, nullptr)
                            : with_error(paper.value, &paper.error);
}

std::string paper_text_with_error(const PaperValue& paper) {
    if (!paper.is_rounded) return paper_text(paper);
    return fmt::format("{}, taken as ± {:g}", paper_text(paper), paper.error);
}

std::string Verdict::text() const {
    switch (agreement) {
        case Agreement::agrees:
            return "agrees";
        case Agreement::differs:
            return fmt::format("differs by {:.1f} σ", apart);
        case Agreement::unresolved:
            break;
    }
    return "not resolved at this scale";
}

Verdict verdict(const PaperValue& paper, const Measurement* ours) {
    if (ours == nullptr || !is_known(*ours)) return {};
    if (*ours->error > least_resolved * std::abs(paper.value)) return {};
    const double apart =
        std::abs(*ours->value - paper.value) / std::hypot(*ours->error, paper.error);
    return {apart <= most_apart ? Agreement::agrees : Agreement::differs, apart};
}

Table paper_table(const std::vector<Results>& runs, const std::vector<std::string>& labels) {
    Table table;
    table.name = "paper";
    table.title = "The paper and this run";
    table.note =
        "Paper: Castillo et al., Phys. Rev. E 100, 032902 (2019). Molecular dynamics of its walled "
        "cell, rendered and tracked, stand in for the experiment. σ: standard errors of both "
        "together. What the text leaves open: docs/paper.md.";
    table.columns = {{"paper", "Paper", "", true},
                     {"ours", "Ours", "", true},
                     {"run", "Run", "", true},
                     {"verdict", "Verdict", "", true}};
    for (const PaperValue& paper : paper_values()) {
        const PaperMeasurement found = paper_measurement(paper, runs);
        const Measurement* m = found.measurement;
        const auto words = [](const std::string& text) { return TableCell{.text = text}; };
        std::string ours = "not measured";
        if (m != nullptr && m->value) ours = with_error(*m->value, m->error ? &*m->error : nullptr);
        if (m != nullptr && !m->value && !m->reason.empty()) ours = m->reason;
        const Verdict judgement = verdict(paper, m);
        TableCell judged = words(judgement.text());
        judged.failed = judgement.agreement == Agreement::differs;
        table.rows.push_back({paper.name,
                              {words(paper_text_with_error(paper)), words(ours),
                               words(m == nullptr ? "–" : labels[found.run]), judged}});
    }
    return table;
}

}  // namespace grainfield::report
