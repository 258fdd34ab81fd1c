#pragma once

#include <memory>

#include "analysis/observable.h"
#include "analysis/order/bond_order.h"

namespace grainfield::analysis {

/// Bond order of each snapshot, computed once for all observables that need it: with the options of
/// "q4". Gives no result of its own.
class SharedBondOrder final
    : public AccumulatorOf<SharedBondOrder, std::shared_ptr<const BondOrderField>> {
 public:
    static constexpr const char* name = "bond order";
    static constexpr bool has_result = false;
    static constexpr bool can_be_saved = true;

    explicit SharedBondOrder(const RunSetup& setup)
        : options_(setup.options.of<BondOrderOptions>()) {}
    Sample measure(const Moment& moment) const;
    void add(Sample& /*sample*/, const Moment& /*moment*/) {}
    void merge(const SharedBondOrder& /*later*/) {}

 private:
    BondOrderOptions options_;
};

/// The same with symmetry 4, as phases are classes of |Q4| whatever symmetry "q4" is asked for.
class SharedSquareOrder final
    : public AccumulatorOf<SharedSquareOrder, std::shared_ptr<const BondOrderField>> {
 public:
    static constexpr const char* name = "square order";
    static constexpr bool has_result = false;
    static constexpr bool can_be_saved = true;
    static std::vector<Observable> needs(const AnalysisOptions& options);

    explicit SharedSquareOrder(const RunSetup& setup)
        : options_(setup.options.of<BondOrderOptions>()) {}
    Sample measure(const Moment& moment) const;
    void add(Sample& /*sample*/, const Moment& /*moment*/) {}
    void merge(const SharedSquareOrder& /*later*/) {}

 private:
    BondOrderOptions options_;
};

}  // namespace grainfield::analysis
