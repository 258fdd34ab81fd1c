#include "tracking/synthesis/bias_correction.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace grainfield::tracking {

BiasCorrector::BiasCorrector(BiasTerms terms, const BiasCorrection& correction, double diameter,
                             int width, int height)
    : terms_(std::move(terms)),
      weights_(correction.weights),
      diameter_(diameter),
      width_(width),
      height_(height) {}

BiasCorrector::BiasCorrector(const BiasCorrection& correction, const Image& darkness,
                             const Image& residual, const std::vector<Vec2>& discs, double diameter)
    : BiasCorrector(BiasTerms(darkness, residual, discs, diameter), correction, diameter,
                    darkness.width(), darkness.height()) {}

BiasCorrector::BiasCorrector(const BiasCorrection& correction, const PaddedImage& darkness,
                             const PaddedImage& transmission, const std::vector<Vec2>& discs,
                             double diameter)
    : BiasCorrector(BiasTerms(darkness, transmission, discs, diameter), correction, diameter,
                    darkness.width(), darkness.height()) {}

bool BiasCorrector::reaches(Vec2 place) const {
    const double inside = std::min({place.x, place.y, width_ - 1 - place.x, height_ - 1 - place.y});
    return inside >= BiasTerms::kReach * diameter_;
}

Vec2 BiasCorrector::corrected(Vec2 place) const {
    return reaches(place) ? corrected_within(place).position : place;
}

BiasCorrector::Corrected BiasCorrector::corrected_within(Vec2 place) const {
    const BiasTerms::Sum sum = terms_.weighted(place, weights_);
    return {place + diameter_ * sum.value, sum.nearest};
}

std::vector<double> numbers_of(const BiasCorrection& correction) {
    std::vector<double> numbers{correction.doubt};
    for (const std::vector<double>* part :
         {&correction.weights, &correction.quality, &correction.remaining, &correction.shares}) {
        numbers.push_back(static_cast<double>(part->size()));
        numbers.insert(numbers.end(), part->begin(), part->end());
    }
    return numbers;
}

std::size_t overlap_class(double nearest) {
    return static_cast<std::size_t>(
        std::upper_bound(std::begin(kOverlapBounds), std::end(kOverlapBounds), nearest) -
        std::begin(kOverlapBounds));
}

std::size_t class_of(const BiasCorrection& correction, double nearest, double residual) {
    const auto quality =
        std::upper_bound(correction.quality.begin(), correction.quality.end(), residual) -
        correction.quality.begin();
    return overlap_class(nearest) * kQualityClasses + static_cast<std::size_t>(quality);
}

}  // namespace grainfield::tracking
