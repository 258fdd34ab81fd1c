#include "analysis/density/field_statistics.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::analysis {

namespace {

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double mean_square_of(const std::vector<double>& values) {
    return std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
           static_cast<double>(values.size());
}

const std::vector<double>& series(const Checkpoint& checkpoint, const std::string& name) {
    const auto found = checkpoint.reals.find(name);
    if (found != checkpoint.reals.end()) return found->second;
    throw InputError(fmt::format("the checkpoint does not fit: '{}' is missing.", name));
}

BlockPlan plan_of(const Checkpoint& checkpoint) {
    const auto found = checkpoint.integers.find("statistics plan");
    if (found == checkpoint.integers.end() || found->second.size() != 2) {
        throw InputError({.problem = "the checkpoint does not fit",
                          .actual = "it does not say how long the run was to be",
                          .expected = "instants and blocks of the error estimate",
                          .suggestion = "begin the run anew"});
    }
    const auto [instants, blocks] = std::pair{found->second[0], found->second[1]};
    const BlockPlan longest = BlockPlan::of(instants);
    if (instants != longest.frames || blocks < 1 || blocks > longest.blocks) {
        throw InputError({.problem = "the checkpoint does not fit: 'statistics plan'",
                          .actual = fmt::format("{} instants in {} blocks", instants, blocks),
                          .expected = fmt::format("1 to {} blocks", longest.blocks),
                          .suggestion = "begin the run anew"});
    }
    return {instants, static_cast<int>(blocks)};
}

}  // namespace

void FieldStatistics::prepare(const FieldFrame& like) {
    if (sums_) return;
    const DensityField& field = like.density.front();
    const auto replicas = static_cast<std::int64_t>(like.density.size());
    std::optional<StructureFactor> order;
    if (!like.order.value.empty()) {
        StructureFactorOptions of_order = options_;
        of_order.k_max = std::min(options_.k_max, order_k_max_);
        order = StructureFactor::of_field(of_order, field, plan_);
    }
    sums_.emplace(Accumulators{StructureFactor::of_field(options_, field, plan_, replicas),
                               std::move(order),
                               FieldVariance(field, like.dimension, plan_, replicas)});
}

void FieldStatistics::write(const FieldFrame& frame) {
    prepare(frame);
    double mean = 0;
    for (const DensityField& field : frame.density) {
        sums_->density.add(sums_->density.measure(field, frame.dimension));
        sums_->variance.add(sums_->variance.measure(field));
        mean += mean_of(field.value) / static_cast<double>(frame.density.size());
    }
    mean_density_.add(mean);
    diffusivity_.add(frame.mean_diffusivity);
    if (!sums_->order) return;
    sums_->order->add(sums_->order->measure(frame.order, frame.dimension));
    order_squared_.add(mean_square_of(frame.order.value));
}

ObservableResult FieldStatistics::means() const {
    ObservableResult result;
    result.name = "field";
    const std::string one = "one field: no error from fluctuations";
    result.measurements = {
        sums_->order ? order_squared_.measurement("order_squared", "-", std::nullopt, one)
                     : missing("order_squared", "-", "there is no order field (lambda = 0)"),
        diffusivity_.measurement("mean_diffusivity", "l^2/t", std::nullopt, one),
        mean_density_.measurement("mean_density", "1/l^d", std::nullopt, one)};
    return result;
}

std::vector<ObservableResult> FieldStatistics::results() const {
    if (!sums_) {
        ObservableResult none;
        none.name = "sk";
        none.reason = "no fields";
        return {none};
    }
    std::vector<ObservableResult> results{sums_->density.result(), sums_->variance.result()};
    if (sums_->order) {
        ObservableResult order = sums_->order->result();
        order.name = "sk_order";
        std::erase_if(order.curves, [](const Curve& curve) { return curve.name != "sk"; });
        for (Curve& curve : order.curves) {
            curve.name = "sk_order";
            curve.title = "Structure factor of the order field";
        }
        for (Measurement& m : order.measurements) m.name = "order_" + m.name;
        results.push_back(std::move(order));
    }
    results.push_back(means());
    return results;
}

void FieldStatistics::save(Checkpoint& checkpoint) const {
    checkpoint.reals["statistics order squared"] = order_squared_.value;
    checkpoint.reals["statistics diffusivity"] = diffusivity_.value;
    checkpoint.reals["statistics mean density"] = mean_density_.value;
    checkpoint.integers["statistics plan"] = {plan_.frames, plan_.blocks};
    if (!sums_) return;
    sums_->density.save(checkpoint, "statistics sk ");
    sums_->variance.save(checkpoint, "statistics variance ");
    if (sums_->order) sums_->order->save(checkpoint, "statistics sk_order ");
}

void FieldStatistics::restore(const Checkpoint& checkpoint, const FieldFrame& like) {
    order_squared_.value = series(checkpoint, "statistics order squared");
    diffusivity_.value = series(checkpoint, "statistics diffusivity");
    mean_density_.value = series(checkpoint, "statistics mean density");
    if (diffusivity_.value.empty()) return;
    const BlockPlan wanted = plan_;
    plan_ = plan_of(checkpoint);
    prepare(like);
    sums_->density.restore(checkpoint, "statistics sk ");
    sums_->variance.restore(checkpoint, "statistics variance ");
    if (sums_->order) sums_->order->restore(checkpoint, "statistics sk_order ");
    plan_ = plan_.lengthened(wanted.frames);
    sums_->density.lengthen(plan_);
    sums_->variance.lengthen(plan_);
    if (sums_->order) sums_->order->lengthen(plan_);
}

std::vector<FigureHint> field_figures() {
    return {{.name = "sk_order",
             .title = "Structure factor of the order field",
             .note = "",
             .x = {"k", "Wavevector k", "1/l", Scale::log, false},
             .y = {"s", "S_ψ(k)", "", Scale::log, false},
             .series = {{.label = "S_ψ(k)", .from = {"sk_order", "sk_order", "k", "s", "s_err"}}},
             .place = 72}};
}

std::vector<ObservableTitles> field_titles() {
    return {{"sk_order",
             "Structure factor of the order field",
             {{"order_s_lowest_k", "S of the order at the lowest k"},
              {"order_s_raw_lowest_k", "S of the order at the lowest k, raw"},
              {"order_lowest_k", "Lowest k"},
              {"order_anisotropy_2", "Two-fold anisotropy of S of the order"},
              {"order_anisotropy_4", "Four-fold anisotropy of S of the order"}}},
            {"field",
             "Means of the fields",
             {{"order_squared", "Mean square of the order, ⟨ψ²⟩"},
              {"mean_diffusivity", "Mean diffusivity ⟨D⟩"},
              {"mean_density", "Mean density"}}}};
}

}  // namespace grainfield::analysis
