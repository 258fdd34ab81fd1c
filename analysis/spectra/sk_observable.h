#pragma once

#include <optional>
#include <vector>

#include "analysis/observable.h"
#include "analysis/spectra/listed_modes.h"
#include "analysis/spectra/structure_factor.h"

namespace grainfield::analysis {

/// Wavevectors [1/a] at which "sk" measures S(k) besides its grid.
struct ListedWavevectors {
    std::vector<Vec2> k;
};

/// The density modes of each snapshot and their sums (StructureFactor), for "sk", "fit" and
/// "synthetic". Gives no result of its own.
class SharedSpectrum final : public AccumulatorOf<SharedSpectrum, StructureFactor::Sample> {
 public:
    static constexpr const char* name = "density modes";
    static constexpr bool has_result = false;
    static constexpr bool can_be_saved = true;

    explicit SharedSpectrum(const RunSetup& setup)
        : sums_(setup.options.of<StructureFactorOptions>(), setup.box, setup.frames_of_run(),
                setup.first) {}
    Sample measure(const Moment& moment) const { return sums_.measure(moment.pattern()); }
    void add(Sample& sample, const Moment& /*moment*/) { sums_.add(std::move(sample)); }
    void merge(const SharedSpectrum& later) { sums_.merge(later.sums_); }
    void save(Checkpoint& checkpoint, const std::string& prefix) const override {
        sums_.save(checkpoint, prefix);
    }
    void restore(const Checkpoint& checkpoint, const std::string& prefix) override {
        sums_.restore(checkpoint, prefix);
    }

    const StructureFactor& sums() const { return sums_; }

 private:
    StructureFactor sums_;
};

/// The observable "sk": structure factor on the grid of the box (StructureFactor) and at listed
/// wavevectors (ListedModes).
class SkObservable final : public AccumulatorOf<SkObservable, ListedModes::Sample> {
 public:
    static constexpr const char* name = "sk";
    static constexpr bool can_be_saved = true;
    static std::vector<Observable> needs(const AnalysisOptions& options);
    static std::optional<OptionTable> describe(AnalysisOptions& options);
    static void plan(const PlanSetup& setup, RunPlan& plan);
    static std::vector<FigureHint> figures();
    static ObservableTitles titles();

    explicit SkObservable(const RunSetup& setup);
    Sample measure(const Moment& moment) const;
    void add(Sample& sample, const Moment& moment);
    void merge(const SkObservable& later);
    void save(Checkpoint& checkpoint, const std::string& prefix) const override {
        if (listed_) listed_->save(checkpoint, prefix);
    }
    void restore(const Checkpoint& checkpoint, const std::string& prefix) override {
        if (listed_) listed_->restore(checkpoint, prefix);
    }
    ObservableResult result(const Inputs& inputs) const override;

 private:
    std::optional<ListedModes> listed_;
};

}  // namespace grainfield::analysis
