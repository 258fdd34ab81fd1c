#include "analysis/order/shared_bond_order.h"

namespace grainfield::analysis {

namespace {

constexpr int square = 4;

}  // namespace

SharedBondOrder::Sample SharedBondOrder::measure(const Moment& moment) const {
    return std::make_shared<const BondOrderField>(bond_order(moment.pattern(), options_));
}

std::vector<Observable> SharedSquareOrder::needs(const AnalysisOptions& options) {
    if (options.of<BondOrderOptions>().symmetry != square) return {};
    return {observable_of<SharedBondOrder>()};
}

SharedSquareOrder::Sample SharedSquareOrder::measure(const Moment& moment) const {
    if (options_.symmetry == square) return moment.sample_of<SharedBondOrder>();
    BondOrderOptions options = options_;
    options.symmetry = square;
    return std::make_shared<const BondOrderField>(bond_order(moment.pattern(), options));
}

}  // namespace grainfield::analysis
