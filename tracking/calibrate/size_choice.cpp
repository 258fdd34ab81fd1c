#include "tracking/calibrate/size_choice.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

namespace grainfield::tracking {
namespace {

constexpr double kSameSize = 0.15;
constexpr std::size_t kNamed = 3;

std::vector<std::size_t> best_first(const std::vector<SizeCandidate>& candidates) {
    std::vector<std::size_t> order(candidates.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        const ExplainedShare& one = candidates[a].explained;
        const ExplainedShare& other = candidates[b].explained;
        return std::pair(one.charged, one.signal) > std::pair(other.charged, other.signal);
    });
    return order;
}

const char* polarity_of(const SizeCandidate& candidate) {
    return candidate.polarity == Polarity::dark ? "dark" : "bright";
}

double percent(const SizeCandidate& candidate) {
    return 100 * std::max(0.0, candidate.explained.signal);
}

}  // namespace

bool is_same_size(const SizeCandidate& a, const SizeCandidate& b) {
    return a.polarity == b.polarity &&
           std::abs(std::log(a.diameter / b.diameter)) < std::log(1 + kSameSize);
}

std::optional<SizeCandidate> better_than(const SizeCandidate& given,
                                         const std::vector<SizeCandidate>& candidates) {
    if (given.explained.signal >= kLeastExplained) return std::nullopt;
    for (const std::size_t i : best_first(candidates)) {
        const SizeCandidate& other = candidates[i];
        if (other.explained.signal < kLeastExplained || is_same_size(given, other)) continue;
        return other;
    }
    return std::nullopt;
}

std::string advice_on_size(const SizeCandidate& given, const SizeCandidate& better) {
    SizeCandidate other_size = given;
    other_size.diameter = better.diameter;
    std::string advice;
    if (given.polarity != better.polarity) {
        advice = fmt::format("give calibrate.polarity {}", polarity_of(better));
    }
    if (!is_same_size(given, other_size)) {
        advice += fmt::format("{}leave calibrate.disc-diameter out", advice.empty() ? "" : " and ");
    }
    return fmt::format(
        "with what is given, {} discs of {:.1f} px explain {:.0f} % of the frame; {} discs of "
        "about {:.1f} px explain {:.0f} %: {}",
        polarity_of(given), given.diameter, percent(given), polarity_of(better), better.diameter,
        percent(better), advice);
}

SizeChoice choose_size(const std::vector<SizeCandidate>& candidates) {
    SizeChoice choice;
    if (candidates.empty()) return choice;
    const std::vector<std::size_t> order = best_first(candidates);
    choice.best = order.front();
    const SizeCandidate& best = candidates[order.front()];
    choice.explains_enough = best.explained.signal >= kLeastExplained;
    for (const std::size_t i : order) {
        const SizeCandidate& other = candidates[i];
        if (is_same_size(best, other) || other.explained.signal < kLeastExplained) continue;
        if (1 - best.explained.charged > kClose * (1 - other.explained.charged)) {
            choice.rival = i;
            break;
        }
    }
    return choice;
}

std::vector<std::size_t> named_candidates(const std::vector<SizeCandidate>& candidates) {
    std::vector<std::size_t> named = best_first(candidates);
    if (named.size() > kNamed) named.resize(kNamed);
    return named;
}

std::string in_words(const std::vector<SizeCandidate>& candidates) {
    std::string words;
    for (const std::size_t i : named_candidates(candidates)) {
        const SizeCandidate& candidate = candidates[i];
        words += fmt::format(
            "{}{} D = {:.1f} px explains {:.1f} % ({:.1f} % charged for its {} positions)",
            words.empty() ? "" : "; ", polarity_of(candidate), candidate.diameter,
            percent(candidate), 100 * candidate.explained.charged, candidate.spheres);
    }
    return words;
}

}  // namespace grainfield::tracking
