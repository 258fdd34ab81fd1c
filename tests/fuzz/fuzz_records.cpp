#include "io/h5/detail/run_record_json.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"

namespace grainfield::fuzz {

bool read_records(std::string_view bytes) {
    const std::string file = "a file.h5";
    nlohmann::json json;
    if (!is_taken(file, [&] { json = io::parse_json(std::string(bytes), file); })) return false;
    int taken = 0;
    taken += is_taken(file, [&] { io::to_json(io::record_from_json(json, file)); });
    taken += is_taken(file, [&] { io::to_json(io::info_from_json(json, file)); });
    taken += is_taken(file, [&] { io::to_json(io::identity_from_json(json, file)); });
    taken += is_taken(file, [&] { io::to_json(io::box_from_json(json, file)); });
    return taken > 0;
}

}  // namespace grainfield::fuzz
