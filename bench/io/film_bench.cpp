// bench.io.film FILE…: processor time of reading one frame of a film [ms], median of seven runs
// over all its frames, and the sum of the first and last counts, which says that they were read.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <vector>

#include "core/frame_source.h"
#include "io/frame_files.h"

int main(int argc, char** argv) {
    constexpr int runs = 7;
    try {
        const std::vector<std::filesystem::path> files(argv + 1, argv + argc);
        std::vector<double> ms;
        double sum = 0;
        for (int run = 0; run < runs; ++run) {
            const auto frames = grainfield::io::open_frames(files, {});
            const std::clock_t begin = std::clock();
            double counts = 0;
            for (std::int64_t i = 0; i < frames->count(); ++i) {
                const grainfield::Frame frame = frames->read(i);
                counts += static_cast<double>(frame.image.pixels().front()) +
                          static_cast<double>(frame.image.pixels().back());
            }
            const auto ticks = static_cast<double>(std::clock() - begin);
            ms.push_back(1e3 * ticks / CLOCKS_PER_SEC / static_cast<double>(frames->count()));
            sum = counts;
        }
        std::sort(ms.begin(), ms.end());
        std::printf("%.3f %.0f\n", ms[runs / 2], sum);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
