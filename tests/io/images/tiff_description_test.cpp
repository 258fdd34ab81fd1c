#include "io/images/tiff_description.h"

#include <gtest/gtest.h>

#include "io/frame_scale.h"
#include "io/images/tiff_frames.h"
#include "tests/io/picture_files.h"

namespace grainfield::io {
namespace {

using namespace picture_files;

/// As Bio-Formats writes it, attributes of the first Pixels element replaced.
std::string ome(const std::string& attributes) {
    return R"(<?xml version="1.0" encoding="UTF-8"?><OME )"
           R"(xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06"><Image ID="Image:0">)"
           R"(<Pixels BigEndian="false" DimensionOrder="XYCZT" ID="Pixels:0" )" +
           attributes +
           R"( Type="uint16"><TiffData FirstT="0" IFD="0"/></Pixels></Image>)"
           R"(<Image ID="Image:1"><Pixels TimeIncrement="9" PhysicalSizeX="9"/></Image></OME>)";
}

TEST(TiffDescription, OfOmeHasFrameRateAndSizeOfAPixelInItsUnits) {
    const TiffDescription plain =
        tiff_description(ome(R"(PhysicalSizeX="6.5" PhysicalSizeY="6.5" SizeC="1" SizeT="4" )"
                             R"(SizeZ="1" TimeIncrement="0.02")"));
    EXPECT_DOUBLE_EQ(plain.frame_rate.value_or(0), 50);
    EXPECT_DOUBLE_EQ(plain.pixel_mm.value_or(0), 0.0065) << "micrometres, if nothing else is said";
    EXPECT_EQ(plain.channels, 1);
    const TiffDescription units =
        tiff_description(ome(R"(PhysicalSizeX="0.11" PhysicalSizeXUnit="mm" TimeIncrement="4" )"
                             R"(TimeIncrementUnit="ms" SizeC="2" SizeZ="3")"));
    EXPECT_DOUBLE_EQ(units.frame_rate.value_or(0), 250);
    EXPECT_DOUBLE_EQ(units.pixel_mm.value_or(0), 0.11);
    EXPECT_EQ(units.channels, 2);
    EXPECT_EQ(units.depths, 3);
    const TiffDescription micro =
        tiff_description(ome("PhysicalSizeX='65' PhysicalSizeXUnit='\xc2\xb5m' TimeIncrement='500' "
                             "TimeIncrementUnit='\xc2\xb5s'"));
    EXPECT_DOUBLE_EQ(micro.frame_rate.value_or(0), 2000);
    EXPECT_DOUBLE_EQ(micro.pixel_mm.value_or(0), 0.065);
}

TEST(TiffDescription, WithoutSenseSaysNothing) {
    for (const char* attributes :
         {"", R"(TimeIncrement="0" PhysicalSizeX="-1")", R"(TimeIncrement="1e-320")",
          R"(TimeIncrement="nan" PhysicalSizeX="inf")",
          R"(TimeIncrement="1s" PhysicalSizeX="1" PhysicalSizeXUnit="pixel")",
          R"(TimeIncrement="1" TimeIncrementUnit="fortnight" PhysicalSizeX="1" PhysicalSizeY="2")",
          R"(XTimeIncrement="1" NominalPhysicalSizeX="1")"}) {
        const TiffDescription found = tiff_description(ome(attributes));
        EXPECT_FALSE(found.frame_rate) << attributes;
        EXPECT_FALSE(found.pixel_mm) << attributes;
    }
    for (const char* text :
         {"", "a film", "<OME", "<OME><Pixels", "<?xml?><svg TimeIncrement=\"1\">"}) {
        EXPECT_FALSE(tiff_description(text).frame_rate) << text;
    }
}

TEST(TiffDescription, OfImageJHasPagesAndIntervalAndNotTheRateOfTheShow) {
    const TiffDescription found =
        tiff_description("ImageJ=1.53t\nimages=40\nslices=40\nunit=pixel\nfinterval=0.04\nfps=7\n");
    EXPECT_EQ(found.pages, 40U);
    EXPECT_DOUBLE_EQ(found.frame_rate.value_or(0), 25);
    EXPECT_FALSE(tiff_description("ImageJ=1.53t\nimages=40\nfps=7\n").frame_rate);
}

TEST(TiffDescription, IsReadFromTheFirstPageOfAFile) {
    const testing::ScratchFolder folder;
    write_tiff(folder / "x.tif", 40, 30,
               {.depth = 16,
                .pages = 4,
                .description = ome(R"(PhysicalSizeX="6.5" TimeIncrement="0.02")")});
    const auto frames = open_tiff(folder / "x.tif", {});
    EXPECT_DOUBLE_EQ(frames->frame_rate().value_or(0), 50);
    EXPECT_DOUBLE_EQ(frames->read(3).time, 0.06);
    const auto* scale = dynamic_cast<const FrameScale*>(frames.get());
    ASSERT_NE(scale, nullptr);
    EXPECT_DOUBLE_EQ(scale->pixel_mm().value_or(0), 0.0065);
    EXPECT_TRUE(frames->warnings().empty());
    EXPECT_DOUBLE_EQ(*open_tiff(folder / "x.tif", {.fps = 10})->frame_rate(), 10) << "as given";
}

TEST(TiffDescription, OfSeveralPagesATimeGivesNoFrameRate) {
    const testing::ScratchFolder folder;
    const std::vector<std::string> descriptions{
        ome(R"(TimeIncrement="0.02" SizeC="2")"), ome(R"(TimeIncrement="0.02" SizeZ="2")"),
        "ImageJ=1.53t\nimages=4\nchannels=2\nframes=2\nfinterval=0.02\n",
        "ImageJ=1.53t\nimages=4\nslices=2\nframes=2\nfinterval=0.02\n"};
    for (const std::string& said : descriptions) {
        write_tiff(folder / "x.tif", 40, 30, {.depth = 16, .pages = 4, .description = said});
        const auto frames = open_tiff(folder / "x.tif", {});
        EXPECT_FALSE(frames->frame_rate()) << said;
        EXPECT_DOUBLE_EQ(frames->read(3).time, 3) << "in frames";
        ASSERT_EQ(frames->warnings().size(), 2U) << said;
        EXPECT_NE(frames->warnings()[0].find("of each time"), std::string::npos);
        EXPECT_NE(frames->warnings()[1].find("50 times a second"), std::string::npos);
        EXPECT_NE(frames->warnings()[1].find("--fps"), std::string::npos);
        const auto given = open_tiff(folder / "x.tif", {.fps = 100});
        EXPECT_DOUBLE_EQ(given->frame_rate().value_or(0), 100);
        EXPECT_EQ(given->warnings().size(), 1U);
    }
}

TEST(TiffDescription, CountsColoursOfOnePageAsOneChannel) {
    std::string colour = ome(R"(TimeIncrement="0.02" SizeC="3")");
    colour.insert(colour.find("<TiffData"), R"(<Channel ID="Channel:0:0" SamplesPerPixel="3"/>)");
    EXPECT_EQ(tiff_description(colour).channels, 1);
}

}  // namespace
}  // namespace grainfield::io
