#include <cstdint>
#include <vector>

#include "io/video/raw_stream.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"

namespace grainfield::fuzz {

bool read_streams(std::string_view bytes) {
    const Input input(bytes, ".y4m");
    const std::string path = input.path().string();
    const io::RawStream::IsStopped go_on = [] { return false; };
    return is_taken(input, [&] {
        io::RawStream stream({"cat", path}, path, 1 << 18, go_on);
        const io::RawFormat& format = stream.format();
        promise(format.width > 0 && format.height > 0 && format.bit_depth >= 8 &&
                    format.bit_depth <= 16 && (!format.fps || *format.fps > 0),
                "a format is one that frames can have");
        std::vector<std::uint8_t> counts;
        io::RawRead last = io::RawRead::frame;
        for (int i = 0; i < 8 && last == io::RawRead::frame; ++i) {
            last = stream.next(counts, go_on);
            promise(last != io::RawRead::frame || counts.size() == format.count_bytes(),
                    "a frame has all of its counts");
        }
        promise((last == io::RawRead::damaged) == !stream.damage().empty(), "damage says why");
    });
}

}  // namespace grainfield::fuzz
