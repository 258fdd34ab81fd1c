#include "io/h5/record_log.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"

namespace grainfield::fuzz {

bool read_logs(std::string_view bytes) {
    const Input input(bytes, ".snapshots");
    return is_taken(input, [&] {
        const io::RecordLog log(input.path(), static_cast<std::int64_t>(bytes.size()));
        for (std::int64_t i = 0; i < log.count(); ++i) log.read(i);
    });
}

}  // namespace grainfield::fuzz
