#include "io/file_kind.h"
#include "io/open_snapshots.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/snapshots.h"

namespace grainfield::fuzz {

bool read_points(std::string_view bytes) {
    if (bytes.starts_with("\x89HDF")) return false;  // goes to the reader of trajectories
    const Input input(bytes, ".csv");
    const Box box{.origin = {0, 0}, .length = {20, 20}, .boundary = {}, .height = 0};
    is_taken(input, [&] { read_some(*io::open_snapshots(input.path(), box, {})); });
    return is_taken(input, [&] { read_some(*io::open_snapshots(input.path(), {}, {})); });
}

}  // namespace grainfield::fuzz
