#include <algorithm>

#include "io/h5/field_file.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"

namespace grainfield::fuzz {

bool read_fields(std::string_view bytes) {
    const Input input(bytes, ".h5");
    return is_taken(input, [&] {
        io::FieldFile file(input.path());
        const std::int64_t count = std::min<std::int64_t>(file.count(), 8);
        for (std::int64_t i = 0; i < count; ++i) {
            const FieldFrame frame = file.read(i);
            promise(!frame.density.empty(), "there is a density");
            for (const DensityField& field : frame.density) {
                promise(field.nx > 0 && field.ny > 0 && field.spacing > 0 &&
                            field.value.size() == static_cast<std::size_t>(field.nx) *
                                                      static_cast<std::size_t>(field.ny),
                        "a field has all its cells");
            }
        }
    });
}

}  // namespace grainfield::fuzz
