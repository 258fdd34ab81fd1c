#include "tracking/model/known_models.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "tracking/model/blurred_union.h"
#include "tracking/model/tanh_edge.h"

namespace grainfield::tracking {
namespace {

constexpr std::array<const ProfileShape*, 1> kShapes{&kTanhEdge};
constexpr std::array<const OverlapRule*, 2> kRules{&kProductRule, &kBlurredUnion};

template <class List, class Part>
std::size_t number_in(const List& list, const Part& part) {
    const auto at = std::find(list.begin(), list.end(), &part);
    if (at == list.end()) throw std::out_of_range("not a listed part of an image model");
    return static_cast<std::size_t>(at - list.begin());
}

}  // namespace

std::span<const ProfileShape* const> profile_shapes() {
    return kShapes;
}

std::span<const OverlapRule* const> overlap_rules() {
    return kRules;
}

std::size_t number_of(const OverlapRule& rule) {
    return number_in(kRules, rule);
}

std::size_t number_of(const ProfileShape& shape) {
    return number_in(kShapes, shape);
}

}  // namespace grainfield::tracking
