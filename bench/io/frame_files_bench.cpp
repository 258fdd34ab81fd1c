// How long does it take to read one camera frame? [ms per frame]
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <tiffio.h>
#include <unistd.h>

#include "core/support/random.h"
#include "io/frame_files.h"

namespace {

namespace fs = std::filesystem;

/// A grey TIFF of noise, removed at the end of its scope.
class NoiseTiff {
 public:
    NoiseTiff(int side, int depth, std::uint16_t compression)
        : path_(fs::temp_directory_path() /
                ("grainfield-bench-" + std::to_string(getpid()) + ".tif")) {
        grainfield::RandomStream random(1, "bench frame");
        TIFF* tiff = TIFFOpen(path_.c_str(), "w");
        if (tiff == nullptr) throw std::runtime_error("cannot write " + path_.string());
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(side));
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(side));
        TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, depth);
        TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 16);
        std::vector<std::uint8_t> row(static_cast<std::size_t>(side * depth / 8));
        for (int y = 0; y < side; ++y) {
            // Four random bits, as the noise of a camera leaves them.
            for (auto& byte : row) byte = static_cast<std::uint8_t>(random.uniform() * 16);
            TIFFWriteScanline(tiff, row.data(), static_cast<std::uint32_t>(y), 0);
        }
        TIFFClose(tiff);
    }
    NoiseTiff(const NoiseTiff&) = delete;
    NoiseTiff& operator=(const NoiseTiff&) = delete;
    ~NoiseTiff() {
        std::error_code ignored;
        fs::remove(path_, ignored);
    }
    const fs::path& path() const { return path_; }

 private:
    fs::path path_;
};

void read_tiff(benchmark::State& state, std::uint16_t compression) {
    const NoiseTiff file(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)),
                         compression);
    const auto frames = grainfield::io::open_frames({file.path()}, {});
    for (auto _ : state) benchmark::DoNotOptimize(frames->read(0));
}

BENCHMARK_CAPTURE(read_tiff, plain, COMPRESSION_NONE)
    ->ArgNames({"side", "bits"})
    ->ArgsProduct({{1012, 1600}, {8, 16}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_tiff, lzw, COMPRESSION_LZW)
    ->ArgNames({"side", "bits"})
    ->ArgsProduct({{1012, 1600}, {8, 16}})
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
