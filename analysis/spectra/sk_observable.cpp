#include "analysis/spectra/sk_observable.h"

#include <fmt/format.h>

namespace grainfield::analysis {

std::vector<Observable> SkObservable::needs(const AnalysisOptions& /*options*/) {
    return {observable_of<SharedSpectrum>()};
}

std::optional<OptionTable> SkObservable::describe(AnalysisOptions& options) {
    return analysis::describe(options.of<StructureFactorOptions>());
}

void SkObservable::plan(const PlanSetup& setup, RunPlan& plan) {
    const char* estimators = setup.first.box.is_periodic() ? "periodic box: raw estimator"
                             : setup.frames < 2            ? "one frame: raw estimator"
                                                : "walls: connected and cosine estimators";
    const StructureFactor sk(setup.options.of<StructureFactorOptions>(), setup.first.box,
                             setup.frames);
    plan.run("sk", fmt::format("{}; {}", estimators, sk.method(setup.first.size())));
    const auto& listed = setup.options.of<ListedWavevectors>().k;
    if (!listed.empty()) {
        plan.run("sk list", fmt::format("{} listed wavevectors by direct sums", listed.size()));
    }
}

std::vector<FigureHint> SkObservable::figures() {
    const auto harmonic = [](const char* label, const char* column, Mark mark) {
        return SeriesHint{
            .label = label, .mark = mark, .from = {"sk", "sk_anisotropy", "k", column, ""}};
    };
    return {
        {.name = "sk",
         .title = "Structure factor",
         .note = "",
         .x = {"k", "Wavevector k", "1/a", Scale::log, true},
         .y = {"s", "S(k)", "", Scale::log, true},
         .series = {{.label = "S(k)", .from = {"sk", "sk", "k", "s", "s_err"}},
                    {.label = "raw, ⟨|ρ|²⟩/N",
                     .shown = false,
                     .from = {"sk", "sk_raw", "k", "s", "s_err"}},
                    {.label = "modes of a walled box",
                     .shown = false,
                     .from = {"sk", "sk_neumann", "k", "s", "s_err"}},
                    {.label = "fit, S₀ + S₁ (ka)^α",
                     .mark = Mark::curve,
                     .from = {"fit", "fit", "k", "s", "s_err"}}},
         .place = 20,
         .presence = Presence::always,
         .may_be_linear = true,
         .title_of_curve = true,
         .reading = "How strongly density varies with wavelength 2π/k. The peak is the spacing of "
                    "neighbours; a liquid flattens to the left. The lower it falls there, the more "
                    "even the layer."},
        {.name = "sk_anisotropy",
         .title = "Anisotropy of S(k)",
         .note = "",
         .x = {"k", "Wavevector k", "1/a", Scale::log, true},
         .y = {"a4", "Amplitude of the harmonic", "", Scale::linear, true},
         .series = {harmonic("four-fold", "a4", Mark::line), harmonic("two-fold", "a2", Mark::line),
                    harmonic("four-fold by chance, if isotropic", "chance4", Mark::curve)},
         .place = 73},
    };
}

ObservableTitles SkObservable::titles() {
    return {name,
            "Structure factor",
            {
                {"s_lowest_k", "S at the lowest k"},
                {"s_raw_lowest_k", "S at the lowest k, raw"},
                {"s_neumann_lowest_k", "S at the lowest k, modes of a walled box"},
                {"lowest_k", "Lowest k"},
                {"anisotropy_2", "Two-fold anisotropy of S(k)"},
                {"anisotropy_4", "Four-fold anisotropy of S(k)"},
            }};
}

SkObservable::SkObservable(const RunSetup& setup) {
    const auto& listed = setup.options.of<ListedWavevectors>().k;
    if (!listed.empty()) listed_.emplace(listed, setup.box, setup.frames_of_run(), setup.first);
}

SkObservable::Sample SkObservable::measure(const Moment& moment) const {
    return listed_ ? listed_->measure(moment.pattern()) : Sample{};
}

void SkObservable::add(Sample& sample, const Moment& /*moment*/) {
    if (listed_) listed_->add(std::move(sample));
}

void SkObservable::merge(const SkObservable& later) {
    if (listed_) listed_->merge(*later.listed_);
}

ObservableResult SkObservable::result(const Inputs& inputs) const {
    ObservableResult result = inputs.of<SharedSpectrum>().sums().result();
    if (listed_) listed_->add_to(result);
    return result;
}

}  // namespace grainfield::analysis
