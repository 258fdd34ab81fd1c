#include "tracking/model/product_image.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/support/parallel.h"

namespace grainfield::tracking {

Image product_image(const Image& darkness, const std::vector<Vec2>& positions,
                    const DiscModel& model, int threads) {
    Image result;
    product_image(darkness, positions, model, threads, result);
    return result;
}

void product_image(const Image& darkness, const std::vector<Vec2>& positions,
                   const DiscModel& model, int threads, Image& result) {
    constexpr int kBand = 64;
    const double reach = model.disc.reach();
    const KernelProfile profile(model.disc);
    result = darkness;
    const int bands = (darkness.height() + kBand - 1) / kBand;
    // In order of index within each band: sums do not depend on the number of threads.
    std::vector<std::vector<Vec2>> members(static_cast<std::size_t>(bands));
    for (const Vec2 p : positions) {
        const int low = static_cast<int>(std::floor((p.y - reach) / kBand));
        const int high = static_cast<int>(std::floor((p.y + reach) / kBand));
        for (int b = std::max(0, low); b <= std::min(bands - 1, high); ++b) {
            members[static_cast<std::size_t>(b)].push_back(p);
        }
    }
    parallel_for(bands, threads, [&](std::int64_t band) {
        const int first = static_cast<int>(band) * kBand;
        const int last = std::min(darkness.height(), first + kBand);
        const std::vector<Vec2>& reaching = members[static_cast<std::size_t>(band)];
        thread_local BandSums sums;
        sums.assign(darkness.width(), first, last, reaching, profile);
        const DiscBand discs{.first = first,
                             .last = last,
                             .positions = reaching,
                             .sums = sums,
                             .disc = model.disc,
                             .profile = profile};
        model.overlap->add_to(discs, result);
        if (!model.correction.is_zero()) model.correction.add_to(discs, result);
    });
}

}  // namespace grainfield::tracking
