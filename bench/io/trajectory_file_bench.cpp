// How long does one frame of 11,704 particles take to write and to read? [ms per frame]
#include <cstdint>
#include <filesystem>
#include <string>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "core/support/random.h"
#include "io/h5/trajectory_file.h"
#include "io/text/export_files.h"
#include "io/text/points_csv.h"

namespace {

namespace fs = std::filesystem;
using namespace grainfield;

constexpr std::size_t particles = 11'704;
constexpr int frames = 50;

/// A path in the folder for temporary files, removed at the end of its scope.
class TemporaryPath {
 public:
    explicit TemporaryPath(const std::string& extension)
        : path_(fs::temp_directory_path() /
                ("grainfield-bench-" + std::to_string(getpid()) + extension)) {}
    ~TemporaryPath() {
        std::error_code ignored;
        fs::remove(path_, ignored);
    }
    TemporaryPath(const TemporaryPath&) = delete;
    TemporaryPath& operator=(const TemporaryPath&) = delete;
    const fs::path& path() const { return path_; }

 private:
    fs::path path_;
};

/// As the tracker hands them on: identity, error, quality.
Snapshot tracked(std::int64_t frame) {
    RandomStream random(1, "bench snapshot", static_cast<std::uint64_t>(frame));
    Snapshot s;
    s.frame = frame;
    s.time = static_cast<double>(frame);
    s.box = {{-0.5, -0.5}, {1012, 1012}};
    for (std::size_t i = 0; i < particles; ++i) {
        s.position.push_back({random.uniform(0, 1012), random.uniform(0, 1012)});
        s.id.push_back(static_cast<std::int64_t>(i));
        s.position_error.push_back({random.uniform(), random.uniform()});
        s.quality.push_back(random.uniform());
    }
    return s;
}

void write_file(const fs::path& path) {
    io::TrajectoryWriter writer(path, {}, Overwrite::force);
    for (int i = 0; i < frames; ++i) writer.write(tracked(i));
    writer.finish({});
}

// Opening, writing, bringing all to the disk and renaming, divided by the frames.
void write_trajectory(benchmark::State& state) {
    const TemporaryPath file(".h5");
    std::vector<Snapshot> snapshots;
    for (int i = 0; i < frames; ++i) snapshots.push_back(tracked(i));
    for (auto _ : state) {
        io::TrajectoryWriter writer(file.path(), {}, Overwrite::force);
        for (const Snapshot& snapshot : snapshots) writer.write(snapshot);
        writer.finish({});
    }
    state.counters["per_frame"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * frames,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["bytes_per_frame"] = static_cast<double>(fs::file_size(file.path())) / frames;
}
BENCHMARK(write_trajectory)->Unit(benchmark::kMillisecond)->UseRealTime();

void read_trajectory(benchmark::State& state) {
    const TemporaryPath file(".h5");
    write_file(file.path());
    io::TrajectoryFile trajectory(file.path());
    std::int64_t index = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(trajectory.read(index));
        index = (index + 1) % frames;
    }
}
BENCHMARK(read_trajectory)->Unit(benchmark::kMillisecond);

void export_points(benchmark::State& state) {
    const TemporaryPath file(".h5");
    const TemporaryPath table(".csv");
    write_file(file.path());
    io::TrajectoryFile trajectory(file.path());
    for (auto _ : state) io::export_csv(trajectory, table.path(), Overwrite::force);
    state.counters["per_frame"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * frames,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(export_points)->Unit(benchmark::kMillisecond)->UseRealTime();

// Checking the whole table, then reading it frame by frame.
void read_points(benchmark::State& state) {
    const TemporaryPath file(".h5");
    const TemporaryPath table(".csv");
    write_file(file.path());
    io::TrajectoryFile trajectory(file.path());
    io::export_csv(trajectory, table.path(), Overwrite::force);
    for (auto _ : state) {
        const auto points = io::open_points(table.path(), std::nullopt, {});
        for (std::int64_t i = 0; i < points->count(); ++i) {
            benchmark::DoNotOptimize(points->read(i));
        }
    }
    state.counters["per_frame"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * frames,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(read_points)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
