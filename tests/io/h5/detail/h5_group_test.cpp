#include "io/h5/detail/h5_group.h"

#include <array>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/io/file_samples.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Makes a file with the C library, so that it may hold what H5Group never writes.
template <class Fill>
void make_foreign(const std::string& path, Fill fill) {
    const H5Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    fill(file.get());
}

/// A dataset of doubles.
void make_dataset(hid_t file, const char* name, const H5Extent& extent,
                  hid_t properties = H5P_DEFAULT) {
    const H5Handle space(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr));
    const H5Handle data(H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space.get(), H5P_DEFAULT,
                                   properties, H5P_DEFAULT));
    EXPECT_TRUE(data);
}

/// The content of a file in which /e is an external link to "other.h5" and /s a symbolic link
/// through it. Made before the first H5File of the program, which disables such links permanently.
const std::string external_links = [] {
    const testing::ScratchFolder folder;
    const std::string path = folder / "e.h5";
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_external("other.h5", "/", file, "e", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/e/d", file, "s", H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(file);
    return read_bytes(path);
}();

TEST(H5Group, GivesBackArraysTextsAndAttributes) {
    const testing::ScratchFolder folder;
    {
        H5File file = H5File::create(folder / "x.h5", "x.h5");
        const H5Group group = H5Group::root(file).make_group("g");
        group.write<double>("numbers", std::array{1.0, 2.5, -3.0, 4.0, 5.0, 6.0}, {2, 3});
        group.write<std::uint8_t>("bytes", std::vector<std::uint8_t>(5000, 7), {5000},
                                  Compression::gzip);
        group.write<double>("none", {}, {0});
        group.write_text("text", "σ² <b>");
        group.write_text("empty", "");
        group.set_attribute("one", 2.5);
        group.set_attribute("names", std::array<std::string, 2>{"a", "longer"});
        group.link("again", group, "numbers");
        file.close();
    }
    const H5File file = H5File::open(folder / "x.h5");
    const H5Group group = H5Group::root(file).group("g");
    EXPECT_THAT(group.dataset("numbers").read<double>(), ElementsAre(1, 2.5, -3, 4, 5, 6));
    EXPECT_THAT(group.dataset("again").read_row<double>(1), ElementsAre(4, 5, 6));
    EXPECT_EQ(group.dataset("bytes").read<std::uint8_t>(), std::vector<std::uint8_t>(5000, 7));
    EXPECT_TRUE(group.dataset("none").read<double>().empty());
    EXPECT_EQ(group.text("text"), "σ² <b>");
    EXPECT_EQ(group.text("empty"), "");
    EXPECT_EQ(group.number_attribute("one"), 2.5);
    EXPECT_THAT(group.texts_attribute("names"), ElementsAre("a", "longer"));
    EXPECT_THAT(group.names(), ElementsAre("again", "bytes", "empty", "none", "numbers", "text"));
    EXPECT_THROW(group.dataset("numbers").read_row<double>(2), InputError);
}

TEST(H5Group, SeriesGrowInBothDirectionsAndHoldTheFillValueElsewhere) {
    const testing::ScratchFolder folder;
    {
        H5File file = H5File::create(folder / "x.h5", "x.h5");
        const H5Dataset data =
            H5Group::root(file).make_series<std::int64_t>("s", {0, 2}, {1, 4, 2}, -1);
        data.extend(1, 1);
        data.write_row<std::int64_t>(0, 1, std::array<std::int64_t, 2>{5, 6});
        data.extend(2, 3);
        data.write_row<std::int64_t>(1, 2, std::array<std::int64_t, 4>{1, 2, 3, 4});
        file.close();
    }
    const H5File file = H5File::open(folder / "x.h5");
    const H5Dataset data = H5Group::root(file).dataset("s");
    EXPECT_EQ(data.extent_text(), "[2, 3, 2]");
    EXPECT_THAT(data.read<std::int64_t>(), ElementsAre(5, 6, -1, -1, -1, -1, 1, 2, 3, 4, -1, -1));
}

TEST(H5Group, RefusesLinksToOtherFiles) {
    const testing::ScratchFolder folder;
    make_foreign(folder / "other.h5", [](hid_t file) { make_dataset(file, "d", {2}); });
    write_bytes(folder / "e.h5", external_links);
    const H5File file = H5File::open(folder / "e.h5");
    const H5Group root = H5Group::root(file);
    ASSERT_TRUE(root.has("e"));
    EXPECT_FALSE(root.has_group("e"));
    EXPECT_THAT([&] { root.group("e"); }, ThrowsMessage<InputError>(HasSubstr("another file")));
    EXPECT_THAT([&] { root.dataset("e"); }, ThrowsMessage<InputError>(HasSubstr("another file")));
    EXPECT_THROW(root.dataset("s"), InputError);
    EXPECT_THROW(root.dataset("e/d"), InputError);
}

TEST(H5Group, RefusesDataKeptInOtherFiles) {
    const testing::ScratchFolder folder;
    write_bytes(folder / "raw", std::string(16, 'x'));
    make_foreign(folder / "x.h5", [&](hid_t file) {
        const H5Handle outside(H5Pcreate(H5P_DATASET_CREATE));
        H5Pset_external(outside.get(), (folder / "raw").c_str(), 0, 16);
        make_dataset(file, "outside", {2}, outside.get());
        const H5Handle mosaic(H5Pcreate(H5P_DATASET_CREATE));
        const H5Extent extent{2};
        const H5Handle space(H5Screate_simple(1, extent.data(), nullptr));
        H5Pset_virtual(mosaic.get(), space.get(), "other.h5", "/d", space.get());
        make_dataset(file, "mosaic", extent, mosaic.get());
    });
    const H5File file = H5File::open(folder / "x.h5");
    const H5Group root = H5Group::root(file);
    for (const char* name : {"outside", "mosaic"}) {
        EXPECT_THAT([&] { root.dataset(name); },
                    ThrowsMessage<InputError>(HasSubstr("in another file")))
            << name;
    }
}

TEST(H5Group, RefusesSizesThatTheFileCannotHold) {
    const testing::ScratchFolder folder;
    make_foreign(folder / "x.h5", [](hid_t file) {
        const H5Handle chunked(H5Pcreate(H5P_DATASET_CREATE));
        const std::array<hsize_t, 2> chunk{1, 100};
        H5Pset_chunk(chunked.get(), 2, chunk.data());
        make_dataset(file, "huge", {1'000'000'000'000, 100'000'000}, chunked.get());
    });
    const H5File file = H5File::open(folder / "x.h5");
    const H5Dataset huge = H5Group::root(file).dataset("huge");
    EXPECT_THAT([&] { huge.read<double>(); }, ThrowsMessage<InputError>(HasSubstr("claims")));
    EXPECT_THAT([&] { huge.read_row<double>(3); }, ThrowsMessage<InputError>(HasSubstr("claims")));
}

TEST(H5Group, RefusesAnotherKindOfThingThanAskedFor) {
    const testing::ScratchFolder folder;
    {
        H5File file = H5File::create(folder / "x.h5", "x.h5");
        const H5Group root = H5Group::root(file);
        root.make_group("group").set_attribute("word", std::string("a"));
        root.write_text("text", "words");
        root.write<double>("numbers", std::array{1.0, 2.0}, {2});
        file.close();
    }
    const H5File file = H5File::open(folder / "x.h5");
    const H5Group root = H5Group::root(file);
    EXPECT_THROW(root.group("none"), InputError);
    EXPECT_THROW(root.group("numbers"), InputError);
    EXPECT_THROW(root.dataset("group"), InputError);
    EXPECT_THROW(root.dataset("text").read<double>(), InputError);
    EXPECT_THROW(root.text("numbers"), InputError);
    EXPECT_THROW(root.group("group").number_attribute("word"), InputError);
    EXPECT_THROW(root.group("group").number_attribute("none"), InputError);
    EXPECT_THROW(root.group("group").texts_attribute("none"), InputError);
}

TEST(H5File, SaysWhatAPathIsInsteadOfAFile) {
    const testing::ScratchFolder folder;
    EXPECT_THAT([&] { H5File::open(folder / "none"); },
                ThrowsMessage<InputError>(HasSubstr("no such file")));
    EXPECT_THAT([&] { H5File::open(folder.path()); },
                ThrowsMessage<InputError>(HasSubstr("a folder")));
    EXPECT_THAT([&] { H5File::open("/dev/null"); },
                ThrowsMessage<InputError>(HasSubstr("not a regular file")));
    EXPECT_THROW(H5File::create(folder / "none/x.h5", "x.h5"), OutputError);
}

}  // namespace
}  // namespace grainfield::io
