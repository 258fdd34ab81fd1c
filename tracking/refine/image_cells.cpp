#include "tracking/refine/image_cells.h"

#include "core/support/parallel.h"

namespace grainfield::tracking {

void ImageCells::in_rounds(
    const std::vector<Vec2>& positions, const std::vector<std::uint32_t>& discs, int threads,
    const std::function<void(const std::vector<std::uint32_t>&)>& body) const {
    std::vector<std::vector<std::uint32_t>> members(count());
    for (const std::uint32_t j : discs) members[at(positions[j])].push_back(j);
    for (int colour = 0; colour < 4; ++colour) {
        std::vector<std::size_t> work;
        for (int r = colour / 2; r < rows; r += 2) {
            for (int c = colour % 2; c < columns; c += 2) {
                if (!members[index(c, r)].empty()) work.push_back(index(c, r));
            }
        }
        parallel_for(static_cast<std::int64_t>(work.size()), threads,
                     [&](std::int64_t i) { body(members[work[static_cast<std::size_t>(i)]]); });
    }
}

}  // namespace grainfield::tracking
