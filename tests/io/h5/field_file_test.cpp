#include "io/h5/field_file.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/random.h"
#include "io/file_kind.h"
#include "io/h5/field_log.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using ::testing::HasSubstr;

FieldFrame frame(std::int64_t step, int nx, int ny, int replicas, bool has_order) {
    FieldFrame frame;
    frame.dimension = ny == 1 ? 1 : 2;
    frame.mean_diffusivity = 0.1 * static_cast<double>(step);
    RandomStream random(5, "field file test", static_cast<std::uint64_t>(step));
    const auto make = [&] {
        DensityField field;
        field.step = step;
        field.time = 0.5 * static_cast<double>(step);
        field.nx = nx;
        field.ny = ny;
        field.spacing = 0.65;
        for (int i = 0; i < nx * ny; ++i) field.value.push_back(random.normal());
        return field;
    };
    for (int r = 0; r < replicas; ++r) frame.density.push_back(make());
    if (has_order) frame.order = make();
    return frame;
}

void expect_same(const FieldFrame& a, const FieldFrame& b) {
    EXPECT_EQ(a.dimension, b.dimension);
    EXPECT_EQ(a.mean_diffusivity, b.mean_diffusivity);
    ASSERT_EQ(a.density.size(), b.density.size());
    const auto same = [](const DensityField& x, const DensityField& y) {
        EXPECT_EQ(x.step, y.step);
        EXPECT_EQ(x.time, y.time);
        EXPECT_EQ(x.nx, y.nx);
        EXPECT_EQ(x.ny, y.ny);
        EXPECT_EQ(x.spacing, y.spacing);
        EXPECT_EQ(x.value, y.value);
    };
    for (std::size_t r = 0; r < a.density.size(); ++r) same(a.density[r], b.density[r]);
    EXPECT_EQ(a.order.value, b.order.value);
}

ObservableResult statistics() {
    ObservableResult result;
    result.name = "sk";
    result.measurements = {{"s_lowest_k", "-", 1.25, 0.1, 16, ""}};
    result.curves = {{"sk", "S(k)", {{"k", "1/a", "k", {1, 2}}, {"s", "-", "S", {0.5, 0.25}}}, {}}};
    return result;
}

TEST(FieldFile, GivesBackEveryBit) {
    const testing::ScratchFolder folder;
    for (const auto& [nx, ny, replicas, has_order] :
         {std::tuple{8, 6, 1, true}, {5, 7, 3, true}, {16, 1, 2, true}, {4, 4, 1, false}}) {
        const std::string path = folder / "f.h5";
        FieldWriter writer(path, Overwrite::force);
        for (const std::int64_t step : {3, 9, 10})
            writer.write(frame(step, nx, ny, replicas, has_order));
        EXPECT_THROW(FieldWriter(path, Overwrite::force), OutputError);  // two writers
        RunRecord record;
        record.command = "simulate field";
        record.seed = 7;
        const RunIdentity identity{
            .origin = Origin::field,
            .control = ControlValue{.parameter = ControlParameter::critical_distance, .value = 0.1},
            .dimension = 1,
            .gradient_order = 4};
        writer.finish({statistics()}, identity, record);
        EXPECT_EQ(identify(path), FileKind::field);
        FieldFile file(path);
        ASSERT_EQ(file.count(), 3);
        expect_same(file.read(1), frame(9, nx, ny, replicas, has_order));
        expect_same(file.read(2), frame(10, nx, ny, replicas, has_order));
        EXPECT_EQ(file.record().seed, 7U);
        EXPECT_EQ(file.identity(), identity);
        ASSERT_EQ(file.statistics().size(), 1U);
        EXPECT_EQ(file.statistics()[0].curves[0].columns[1].values,
                  (std::vector<double>{0.5, 0.25}));
        EXPECT_THROW(file.read(3), InputError);
    }
}

TEST(FieldFile, MayHaveNoFields) {
    const testing::ScratchFolder folder;
    FieldWriter(folder / "f.h5", Overwrite::refuse).finish({statistics()}, {}, {});
    EXPECT_EQ(FieldFile(folder / "f.h5").count(), 0);
}

TEST(FieldFile, AnUnfinishedOneLeavesNothing) {
    const testing::ScratchFolder folder;
    { FieldWriter(folder / "f.h5", Overwrite::refuse).write(frame(1, 4, 4, 1, true)); }
    EXPECT_EQ(folder.entries(), 0U);
}

TEST(FieldFile, RefusesFieldsOfAnotherShape) {
    const testing::ScratchFolder folder;
    FieldWriter writer(folder / "f.h5", Overwrite::refuse);
    writer.write(frame(1, 4, 4, 1, true));
    EXPECT_THROW(writer.write(frame(2, 4, 5, 1, true)), OutputError);
    EXPECT_THROW(writer.write(frame(2, 4, 4, 2, true)), OutputError);
    EXPECT_THROW(writer.write(frame(2, 4, 4, 1, false)), OutputError);
}

TEST(FieldFile, DamageIsAnInputErrorOrHarmless) {
    const testing::ScratchFolder folder;
    const std::string path = folder / "f.h5";
    {
        FieldWriter writer(path, Overwrite::refuse);
        writer.write(frame(1, 8, 8, 1, true));
        writer.finish({statistics()}, {}, {});
    }
    std::ifstream in(path, std::ios::binary);
    const std::string good((std::istreambuf_iterator<char>(in)), {});
    RandomStream random(1, "damage");
    for (int trial = 0; trial < 300; ++trial) {
        std::string bad = good;
        bad[random.below(bad.size())] = static_cast<char>(random.bits());
        std::ofstream(folder / "bad.h5", std::ios::binary | std::ios::trunc) << bad;
        try {
            FieldFile file(folder / "bad.h5");
            for (std::int64_t i = 0; i < std::min<std::int64_t>(file.count(), 3); ++i) file.read(i);
        } catch (const InputError&) {
        }
    }
    EXPECT_THROW(FieldFile(folder / "none.h5"), InputError);
}

TEST(FieldLog, KeepsFramesAndForgetsWhatCameAfterTheCheckpoint) {
    const testing::ScratchFolder folder;
    const std::string path = folder / "f.fields";
    std::int64_t noted = 0;
    {
        RecordLog store(path, 0);
        FieldLog log(store);
        log.write(frame(1, 4, 6, 2, true));
        log.write(frame(2, 4, 6, 2, true));
        store.sync();
        noted = store.bytes();
        EXPECT_EQ(store.bytes_of(2), noted);
        EXPECT_EQ(store.bytes_of(1), noted / 2);
        EXPECT_EQ(store.bytes_of(0), 0);
        log.write(frame(3, 4, 6, 2, true));
    }
    RecordLog store(path, noted);
    FieldLog log(store);
    ASSERT_EQ(log.count(), 2);
    expect_same(log.read(0), frame(1, 4, 6, 2, true));
    log.write(frame(4, 4, 6, 2, true));
    expect_same(log.read(2), frame(4, 4, 6, 2, true));
    EXPECT_THROW(RecordLog(path, store.bytes() + 1), InputError);
    store.remove();
    EXPECT_EQ(folder.entries(), 0U);
}

TEST(FieldLog, NoticesAFlippedBit) {
    const testing::ScratchFolder folder;
    const std::string path = folder / "f.fields";
    std::int64_t bytes = 0;
    {
        RecordLog store(path, 0);
        FieldLog log(store);
        log.write(frame(1, 4, 4, 1, true));
        bytes = store.bytes();
    }
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(100);
    file.put('x');
    file.close();
    RecordLog store(path, bytes);
    FieldLog log(store);
    EXPECT_THROW(log.read(0), InputError);
}

std::ptrdiff_t open_files() {
    const std::filesystem::directory_iterator descriptors("/proc/self/fd");
    return std::distance(begin(descriptors), end(descriptors));
}

TEST(FieldLog, ThatIsDamagedStaysNotOpen) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "f.fields") << "no record begins like this, of a length of many TB";
    const std::ptrdiff_t before = open_files();
    EXPECT_THROW(RecordLog(folder / "f.fields", 40), InputError);
    EXPECT_EQ(open_files(), before);
}

}  // namespace
}  // namespace grainfield::io
