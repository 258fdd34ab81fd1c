#include "io/file_kind.h"
#include "io/h5/fingerprint.h"
#include "io/h5/trajectory_file.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/snapshots.h"

namespace grainfield::fuzz {

bool read_trajectories(std::string_view bytes) {
    const Input input(bytes, ".h5");
    is_taken(input, [&] { io::identify(input.path()); });
    is_taken(input, [&] { io::fingerprint_of(input.path()); });
    return is_taken(input, [&] {
        io::TrajectoryFile file(input.path());
        read_some(file);
    });
}

}  // namespace grainfield::fuzz
