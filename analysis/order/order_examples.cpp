#include "analysis/order/order_examples.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "analysis/statistics/blocks.h"

namespace grainfield::analysis {
namespace {

struct Member {
    double mean = 0;
    std::int64_t id = 0;
};

std::optional<std::int64_t> typical(std::vector<Member> members) {
    if (members.empty()) return std::nullopt;
    std::ranges::sort(members, {}, [](const Member& m) { return std::pair(m.mean, m.id); });
    const double median = members[members.size() / 2].mean;
    return std::ranges::lower_bound(members, median, {}, &Member::mean)->id;
}

}  // namespace

void OrderExamples::add(PhaseHistory::Sample sample) {
    if (!wants_more() || too_large_) return;
    values_ += sample.id.size();
    if (values_ > most_values) {
        too_large_ = true;
        window_ = {};
        return;
    }
    window_.push_back(std::move(sample));
}

OrderExamples::Series OrderExamples::series_of(std::int64_t id) const {
    Series series{id, {}};
    for (const PhaseHistory::Sample& sample : window_) {
        const auto at = std::ranges::find(sample.id, id);
        const auto place = static_cast<std::size_t>(at - sample.id.begin());
        series.abs_q.push_back(static_cast<double>(sample.abs_q[place]));
    }
    return series;
}

void OrderExamples::close_window() {
    longest_ = std::max(longest_, window_.size());
    if (wants_more() && !too_large_ && window_.size() >= least_frames) {
        struct Sum {
            double sum = 0;
            std::size_t count = 0;
        };
        std::map<std::int64_t, Sum> sums;
        for (const PhaseHistory::Sample& sample : window_) {
            for (std::size_t i = 0; i < sample.id.size(); ++i) {
                if (!std::isfinite(sample.abs_q[i])) continue;
                Sum& sum = sums[sample.id[i]];
                sum.sum += static_cast<double>(sample.abs_q[i]);
                ++sum.count;
            }
        }
        std::vector<Member> solid, liquid;
        for (const auto& [id, sum] : sums) {
            if (sum.count != window_.size()) continue;
            const double mean = sum.sum / static_cast<double>(sum.count);
            if (mean >= options_.solid_above) solid.push_back({mean, id});
            if (mean <= options_.liquid_below) liquid.push_back({mean, id});
        }
        const auto of_solid = typical(std::move(solid));
        const auto of_liquid = typical(std::move(liquid));
        if ((of_solid && of_liquid) || (!chosen_ && (of_solid || of_liquid))) {
            Chosen chosen;
            for (const PhaseHistory::Sample& sample : window_) {
                chosen.time.push_back(sample.time - window_.front().time);
            }
            if (of_solid) chosen.solid = series_of(*of_solid);
            if (of_liquid) chosen.liquid = series_of(*of_liquid);
            chosen_ = std::move(chosen);
        }
    }
    window_.clear();
    values_ = 0;
}

void OrderExamples::merge(const OrderExamples& later) {
    longest_ = std::max(longest_, later.longest_);
    too_large_ = too_large_ || later.too_large_;
    if (!wants_more() || !later.chosen_) return;
    if (!chosen_ || !later.wants_more()) chosen_ = later.chosen_;
}

void OrderExamples::add_to(ObservableResult& result) const {
    if (!chosen_) {
        const std::string why =
            too_large_ ? fmt::format("a window holds more than {} positions", most_values)
            : longest_ < least_frames
                ? fmt::format("no window of the averaging time has {} frames", least_frames)
                : "no particle is solid or liquid through a window";
        result.measurements.push_back(missing("q4_examples", "-", why));
        return;
    }
    Curve curve{.name = "q4_examples",
                .title = "Order of a typical particle of each phase",
                .columns = {{"t", "time unit", "Time from the start of the window", {}},
                            {"q4", "-", "|Q4| of the particle", {}},
                            {"id", "-", "Identity of the particle", {}}},
                .text_columns = {}};
    const auto append = [&](const char* phase, const std::optional<Series>& series) {
        if (!series) return;
        for (std::size_t i = 0; i < series->abs_q.size(); ++i) {
            curve.columns[0].values.push_back(chosen_->time[i]);
            curve.columns[1].values.push_back(series->abs_q[i]);
            curve.columns[2].values.push_back(static_cast<double>(series->id));
            curve.text_columns["phase"].emplace_back(phase);
        }
    };
    append("solid", chosen_->solid);
    append("liquid", chosen_->liquid);
    result.curves.push_back(std::move(curve));
}

}  // namespace grainfield::analysis
