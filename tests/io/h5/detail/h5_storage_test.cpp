#include "io/h5/detail/h5_storage.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/h5/detail/h5_group.h"
#include "tests/io/file_samples.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

enum class Packing { none, checksum, gzip, contiguous, compact };

constexpr std::array all_packings{Packing::none, Packing::checksum, Packing::gzip,
                                  Packing::contiguous, Packing::compact};

/// A file of the C library with /d = 0, 1, … 99 as [10, 10] in chunks of [4, 10]. Its headers have
/// no checksums, as those of old programs.
void make_file(const std::string& path, Packing packing) {
    const H5Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    const std::array<hsize_t, 2> extent{10, 10};
    const std::array<hsize_t, 2> chunk{4, 10};
    const H5Handle space(H5Screate_simple(2, extent.data(), nullptr));
    const H5Handle properties(H5Pcreate(H5P_DATASET_CREATE));
    if (packing == Packing::compact) {
        H5Pset_layout(properties.get(), H5D_COMPACT);
    } else if (packing != Packing::contiguous) {
        H5Pset_chunk(properties.get(), 2, chunk.data());
    }
    if (packing == Packing::gzip) {
        H5Pset_shuffle(properties.get());
        H5Pset_deflate(properties.get(), 1);
    }
    if (packing == Packing::gzip || packing == Packing::checksum) {
        H5Pset_fletcher32(properties.get());
    }
    const H5Handle data(H5Dcreate2(file.get(), "d", H5T_NATIVE_DOUBLE, space.get(), H5P_DEFAULT,
                                   properties.get(), H5P_DEFAULT));
    std::vector<double> values(100);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i);
    H5Dwrite(data.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

TEST(H5Storage, ThatIsSoundIsReadWhateverItsPacking) {
    const testing::ScratchFolder folder;
    for (const Packing packing : all_packings) {
        make_file(folder / "x.h5", packing);
        const H5File file = H5File::open(folder / "x.h5");
        const H5Dataset data = H5Group::root(file).dataset("d");
        const std::vector<double> values = data.read<double>();
        EXPECT_EQ(values.at(57), 57);
        EXPECT_EQ(data.read_row<double>(9).at(3), 93);
    }
}

TEST(H5Storage, OfAChunkThatIsShorterThanItShouldBeIsRefused) {
    const testing::ScratchFolder folder;
    for (const Packing packing : {Packing::none, Packing::checksum}) {
        make_file(folder / "x.h5", packing);
        std::string bytes = read_bytes(folder / "x.h5");
        // The index of chunks names the length of each in 4 bytes, before a filter mask of zeros
        // and the offset of the chunk.
        const unsigned length = packing == Packing::none ? 320 : 324;
        std::string key{static_cast<char>(length & 255U), static_cast<char>(length >> 8U)};
        key += std::string(6, '\0') + '\4' + std::string(7, '\0');
        const auto at = bytes.find(key);
        ASSERT_NE(at, std::string::npos);
        bytes[at] = 16;
        bytes[at + 1] = 0;
        write_bytes(folder / "x.h5", bytes);
        const H5File file = H5File::open(folder / "x.h5");
        const H5Dataset data = H5Group::root(file).dataset("d");
        EXPECT_EQ(data.read_row<double>(0).at(3), 3);
        const auto damaged = ThrowsMessage<InputError>(HasSubstr("/d is damaged"));
        EXPECT_THAT([&] { data.read_row<double>(5); }, damaged);
        EXPECT_THAT([&] { data.read<double>(); }, damaged);
    }
}

TEST(H5Storage, OfAnUnknownFilterIsRefused) {
    const testing::ScratchFolder folder;
    {
        const H5Handle file(
            H5Fcreate((folder / "x.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
        const std::array<hsize_t, 1> extent{100};
        const H5Handle space(H5Screate_simple(1, extent.data(), nullptr));
        const H5Handle properties(H5Pcreate(H5P_DATASET_CREATE));
        H5Pset_chunk(properties.get(), 1, extent.data());
        H5Pset_nbit(properties.get());
        const H5Handle data(H5Dcreate2(file.get(), "d", H5T_NATIVE_INT, space.get(), H5P_DEFAULT,
                                       properties.get(), H5P_DEFAULT));
        ASSERT_TRUE(data);
    }
    const H5File file = H5File::open(folder / "x.h5");
    EXPECT_THAT([&] { H5Group::root(file).dataset("d").read<double>(); },
                ThrowsMessage<InputError>(HasSubstr("filter 5")));
}

// Every byte of the headers takes two other values: values are read, or the file is refused.
// Under the address sanitizer, reading beyond a buffer counts as a crash.
TEST(H5Storage, WithAnyByteOfAHeaderChangedNeverCrashes) {
    const testing::ScratchFolder folder;
    for (const Packing packing : all_packings) {
        make_file(folder / "x.h5", packing);
        const std::string bytes = read_bytes(folder / "x.h5");
        const std::size_t headers = std::min<std::size_t>(bytes.size(), 2500);
        for (std::size_t at = 0; at < headers; ++at) {
            for (const int change : {1, 0x80}) {
                std::string changed = bytes;
                changed[at] = static_cast<char>(changed[at] ^ change);
                write_bytes(folder / "x.h5", changed);
                try {
                    const H5File file = H5File::open(folder / "x.h5");
                    const H5Dataset data = H5Group::root(file).dataset("d");
                    data.read<double>();
                    data.read_row<double>(0);
                } catch (const InputError&) {
                }
            }
        }
    }
}

}  // namespace
}  // namespace grainfield::io
