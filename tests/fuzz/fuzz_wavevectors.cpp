#include <cmath>

#include "io/text/wavevector_csv.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"

namespace grainfield::fuzz {

bool read_wavevectors(std::string_view bytes) {
    const Input input(bytes, ".csv");
    return is_taken(input, [&] {
        const auto waves = io::read_wavevectors(input.path());
        promise(!waves.empty(), "there is a wavevector");
        for (const Vec2& k : waves) {
            promise(std::isfinite(k.x) && std::isfinite(k.y), "wavevectors are finite");
        }
    });
}

}  // namespace grainfield::fuzz
