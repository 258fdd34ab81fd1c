#pragma once

#include "analysis/motion/height_series.h"
#include "analysis/observable.h"

namespace grainfield::analysis {

/// The observable "height": the layer's height against time (HeightSeries).
class HeightObservable final : public AccumulatorOf<HeightObservable, HeightSeries::Sample> {
 public:
    static constexpr const char* name = "height";
    static constexpr bool can_be_saved = true;
    static void plan(const PlanSetup& setup, RunPlan& plan);
    static std::vector<FigureHint> figures();
    static ObservableTitles titles();

    explicit HeightObservable(const RunSetup& setup) : series_(setup.info) {}
    Sample measure(const Moment& moment) const { return HeightSeries::measure(moment.pattern()); }
    void add(Sample& sample, const Moment& /*moment*/) { series_.add(sample); }
    void merge(const HeightObservable& later) { series_.merge(later.series_); }
    ObservableResult result(const Inputs& /*inputs*/) const override { return series_.result(); }
    void save(Checkpoint& checkpoint, const std::string& prefix) const override {
        series_.save(checkpoint, prefix);
    }
    void restore(const Checkpoint& checkpoint, const std::string& prefix) override {
        series_.restore(checkpoint, prefix);
    }

 private:
    HeightSeries series_;
};

}  // namespace grainfield::analysis
