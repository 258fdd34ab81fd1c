// How long does it take to read one camera frame? [ms per frame]
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>
#include <sys/stat.h>
#include <tiffio.h>
#include <unistd.h>

#include "core/support/random.h"
#include "io/frame_files.h"
#include "io/video/live_frames.h"

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

constexpr int kSide = 1600;

unsigned count_at(std::size_t pixel) {
    return static_cast<unsigned>(pixel * 2654435761U >> 7U) & 4095U;
}

/// How many pixels are not what was written.
double wrong_pixels(const grainfield::Image& image) {
    double wrong = 0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        wrong += image.pixels()[i] != static_cast<float>(count_at(i)) ? 1 : 0;
    }
    return wrong + static_cast<double>(std::size_t{kSide} * kSide - image.size());
}

/// Files that are removed at the end of their scope.
class ScratchFolder {
 public:
    ScratchFolder()
        : path_(fs::temp_directory_path() / ("grainfield-bench-" + std::to_string(getpid()))) {
        fs::create_directories(path_);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    ~ScratchFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    fs::path operator/(const std::string& name) const { return path_ / name; }

 private:
    fs::path path_;
};

void read_frames(benchmark::State& state, const fs::path& path, std::int64_t count) {
    const auto frames = grainfield::io::open_frames({path}, {});
    grainfield::Image last;
    std::int64_t next = 0;
    for (auto _ : state) last = frames->read(next++ % count).image;
    state.counters["wrong_pixels"] = wrong_pixels(last);
}

/// 1600 × 1600 px of 12 bit, packed as Photron does.
void read_mraw_12_bit(benchmark::State& state) {
    constexpr int count = 4;
    const ScratchFolder folder;
    std::string pixels;
    for (std::size_t i = 0; i < std::size_t{kSide} * kSide; i += 2) {
        const unsigned two = count_at(i) << 12U | count_at(i + 1);
        for (const unsigned shift : {16U, 8U, 0U})
            pixels.push_back(static_cast<char>(two >> shift));
    }
    {
        std::ofstream file(folder / "film.mraw", std::ios::binary);
        for (int f = 0; f < count; ++f) file << pixels;
    }
    std::ofstream(folder / "film.cih")
        << "#Camera Information Header\r\nRecord Rate(fps) : 500\r\nTotal Frame : " << count
        << "\r\nImage Width : 1600\r\nImage Height : 1600\r\nColor Type : Mono\r\n"
           "Color Bit : 12\r\nFile Format : MRaw\r\nEffectiveBit Depth : 12\r\n"
           "EffectiveBit Side : Lower\r\n\r\n";
    read_frames(state, folder / "film.cih", count);
}
BENCHMARK(read_mraw_12_bit)->Unit(benchmark::kMillisecond);

/// The same through a pipe, as `track --live` takes it: wall time.
void read_live_12_bit(benchmark::State& state) {
    const ScratchFolder folder;
    const fs::path fifo = folder / "camera";
    ::mkfifo(fifo.c_str(), 0600);
    std::string frame = "FRAME\n";
    for (std::size_t i = 0; i < std::size_t{kSide} * kSide; ++i) {
        frame.push_back(static_cast<char>(count_at(i)));
        frame.push_back(static_cast<char>(count_at(i) >> 8U));
    }
    ::signal(SIGPIPE, SIG_IGN);
    std::thread camera([&] {
        std::ofstream out(fifo, std::ios::binary);
        out << "YUV4MPEG2 W1600 H1600 F500:1 Cmono12\n";
        while (out << frame) {
        }
    });
    {
        grainfield::io::LiveOptions options;
        options.source = fifo.string();
        options.queue = 10;
        options.waits = true;
        const auto frames = grainfield::io::open_live(options);
        grainfield::Image last;
        std::int64_t next = 0;
        for (auto _ : state) last = frames->read(next++).image;
        state.counters["wrong_pixels"] = wrong_pixels(last);
    }
    camera.join();
}
BENCHMARK(read_live_12_bit)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(200);

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
