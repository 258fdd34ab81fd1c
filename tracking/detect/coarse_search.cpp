#include "tracking/detect/coarse_search.h"

#include <algorithm>
#include <cmath>

#include "tracking/detect/residual_blocks.h"

namespace grainfield::tracking {
namespace {

constexpr int kRowSpacing = 2;
constexpr double kFarthest = 0.3;   // [D]
constexpr double kMostWrong = 0.2;  // of the image
constexpr double kMostFar = 0.25;   // of the discs

int rows_of_blocks(int height, int factor, int spacing) {
    return (height / factor - 1) / spacing + 1;
}

/// The mean over whole blocks, of every spacing-th row of them.
void reduce(const PaddedImage& image, Binning blocks, int spacing, int threads, Image& result) {
    const int width = blocks.blocks(image.width());
    const int height = rows_of_blocks(image.height(), blocks.factor, spacing);
    if (result.width() != width || result.height() != height) result = Image(width, height);
    in_row_bands(image.width(), height, threads, [&](int first, int last) {
        std::vector<float> sums(static_cast<std::size_t>(image.width()));
        for (int y = first; y < last; ++y) {
            blocks.bin_row(image.row(y * spacing * blocks.factor), image.pitch(), sums,
                           result.row(y), width);
        }
    });
}

}  // namespace

CoarseSearch::CoarseSearch(int width, int height, const DiscProfile& disc, int factor, int threads)
    : blocks_{factor},
      threads_(threads),
      diameter_(disc.diameter),
      correlation_(width / factor, height / factor, blocks_.in_blocks(disc), 1),
      fit_(Image(width / factor, height / factor), blocks_.in_blocks(disc), threads),
      approach_(Image(width / factor, rows_of_blocks(height, factor, kRowSpacing)),
                blocks_.in_blocks(disc), threads, kRowSpacing) {}

bool CoarseSearch::suits(int width, int height, int factor) {
    return factor > 1 && width >= 2 * factor && height >= 2 * factor;
}

void CoarseSearch::set_visible(const VisiblePixels& visible) {
    const VisiblePixels blocks = visible.blocks(blocks_.factor);
    fit_.set_visible(blocks);
    correlation_.set_visible(blocks);
    approach_.set_visible(blocks.every_row(kRowSpacing));
}

void CoarseSearch::set_threads(int threads) {
    threads_ = threads;
    fit_.set_threads(threads);
    approach_.set_threads(threads);
}

StartingDiscs CoarseSearch::search(const PaddedImage& darkness, const DetectionOptions& detection,
                                   const RefinementOptions& rough) {
    reduce(darkness, blocks_, 1, threads_, image_);
    fit_.restart(image_);
    SphereSearch search(fit_, correlation_, detection);
    search.seed();
    search.run(in_blocks(rough, blocks_));
    summary_ = search.summary();
    StartingDiscs discs{{}, fit_.explained()};
    for (const Vec2 p : fit_.positions()) discs.position.push_back(blocks_.in_frame(p));
    for (double& e : discs.explained) e *= blocks_.factor * blocks_.factor;
    return discs;
}

CoarseSearch::Approach CoarseSearch::approach(const PaddedImage& darkness,
                                              const std::vector<Vec2>& start,
                                              const RefinementOptions& rough) {
    reduce(darkness, blocks_, kRowSpacing, threads_, image_);
    approach_.restart(image_);
    std::vector<Vec2> places;
    places.reserve(start.size());
    for (const Vec2 p : start) places.push_back(blocks_.in_blocks(p));
    approach_.add_all(places);
    Approach result;
    result.steps = approach_.refine(in_blocks(rough, blocks_), Drawing::roughly).steps;
    const ResidualBlocks residual(approach_.darkness(), approach_.transmission(),
                                  static_cast<int>(std::ceil(approach_.disc().reach())), threads_);
    const double wrong = area_of(residual.holding(0.5 * correlation_.full_gain() / kRowSpacing));
    result.is_near =
        wrong <= kMostWrong * approach_.darkness().width() * approach_.darkness().height();
    if (!result.is_near) return result;
    result.discs.explained = approach_.explained();
    for (double& e : result.discs.explained) e *= blocks_.factor * blocks_.factor * kRowSpacing;
    const double farthest = kFarthest * diameter_;
    std::size_t far = 0;
    for (std::size_t j = 0; j < places.size(); ++j) {
        const Vec2 p = blocks_.in_frame(approach_.positions()[j]);
        const bool is_near = squared_norm(p - start[j]) < farthest * farthest;
        if (!is_near) ++far;
        result.discs.position.push_back(is_near ? p : start[j]);
    }
    if (static_cast<double>(far) > kMostFar * static_cast<double>(places.size())) {
        result.is_near = false;
        result.discs = {};
    }
    return result;
}

}  // namespace grainfield::tracking
