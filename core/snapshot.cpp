#include "core/snapshot.h"

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield {

namespace {

template <class T>
void require_length(const Snapshot& snapshot, const char* column, const std::vector<T>& values) {
    if (values.empty() || values.size() == snapshot.size()) return;
    throw InputError(
        {.problem = fmt::format("frame {}: column '{}' is incomplete", snapshot.frame, column),
         .actual = fmt::format("{} entries", values.size()),
         .expected = fmt::format("{}, one per particle, or none", snapshot.size()),
         .suggestion = {}});
}

}  // namespace

void require_consistent(const Snapshot& snapshot) {
    require_length(snapshot, "id", snapshot.id);
    require_length(snapshot, "z", snapshot.z);
    require_length(snapshot, "velocity", snapshot.velocity);
    require_length(snapshot, "spin", snapshot.spin);
    require_length(snapshot, "position_error", snapshot.position_error);
    require_length(snapshot, "z_error", snapshot.z_error);
    require_length(snapshot, "quality", snapshot.quality);
    require_length(snapshot, "layer", snapshot.layer);
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        const Vec2 p = snapshot.position[i];
        if (is_finite(p)) continue;
        throw InputError(
            {.problem = fmt::format("frame {}: position of particle {} is not a number",
                                    snapshot.frame, i),
             .actual = fmt::format("({}, {})", p.x, p.y),
             .expected = "finite coordinates",
             .suggestion = {}});
    }
}

}  // namespace grainfield
