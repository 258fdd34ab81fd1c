#include "core/image_mat.h"

#include <cstdint>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace grainfield {
namespace {

TEST(ImageMat, AMatrixSharesThePixelsOfTheImage) {
    Image image(3, 2);
    image(2, 1) = 7;
    cv::Mat mat = as_mat(image);
    EXPECT_EQ(mat.ptr<float>(), image.row(0));
    EXPECT_EQ(mat.rows, 2);
    EXPECT_EQ(mat.cols, 3);
    EXPECT_EQ(mat.at<float>(1, 2), 7);
    mat.at<float>(0, 1) = -0.5F;
    EXPECT_EQ(image(1, 0), -0.5F);

    const Image& constant = image;
    EXPECT_EQ(as_mat(constant).ptr<float>(), image.row(0));
}

TEST(ImageMat, AnEmptyImageIsAnEmptyMatrixAndBack) {
    Image image;
    EXPECT_TRUE(as_mat(image).empty());
    EXPECT_TRUE(from_mat(cv::Mat()).empty());
}

template <class Pixel>
cv::Mat ramp(int type) {
    cv::Mat mat(4, 5, type);
    for (int y = 0; y < mat.rows; ++y) {
        for (int x = 0; x < mat.cols; ++x) mat.at<Pixel>(y, x) = static_cast<Pixel>(10 * y + x);
    }
    return mat;
}

void expect_ramp(const Image& image, int x0, int y0, int width, int height) {
    ASSERT_EQ(image.width(), width);
    ASSERT_EQ(image.height(), height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            EXPECT_EQ(image(x, y), static_cast<float>(10 * (y0 + y) + x0 + x)) << x << ", " << y;
        }
    }
}

TEST(ImageMat, CountsOfEveryGreyDepthStayAsTheyAre) {
    expect_ramp(from_mat(ramp<std::uint8_t>(CV_8UC1)), 0, 0, 5, 4);
    expect_ramp(from_mat(ramp<std::uint16_t>(CV_16UC1)), 0, 0, 5, 4);
    expect_ramp(from_mat(ramp<float>(CV_32FC1)), 0, 0, 5, 4);
    const cv::Mat brightest(1, 1, CV_16UC1, cv::Scalar(65535));
    EXPECT_EQ(from_mat(brightest)(0, 0), 65535.0F);
    const cv::Mat tiny(1, 1, CV_32FC1, cv::Scalar(std::numeric_limits<float>::min()));
    EXPECT_EQ(from_mat(tiny)(0, 0), std::numeric_limits<float>::min());
}

TEST(ImageMat, ARegionOfInterestIsCutOutOfRowsThatAreNotContinuous) {
    const cv::Mat whole = ramp<std::uint8_t>(CV_8UC1);
    const cv::Mat region = whole(cv::Rect(1, 2, 3, 2));
    ASSERT_FALSE(region.isContinuous());
    expect_ramp(from_mat(region), 1, 2, 3, 2);

    Image image = from_mat(whole);
    expect_ramp(from_mat(as_mat(image)(cv::Rect(2, 1, 2, 3))), 2, 1, 2, 3);
}

TEST(ImageMat, RowsWithPaddingOfTheCallerAreRead) {
    std::uint16_t buffer[] = {0, 1, 999, 10, 11, 999};
    expect_ramp(from_mat(cv::Mat(2, 2, CV_16UC1, buffer, 3 * sizeof(std::uint16_t))), 0, 0, 2, 2);
}

TEST(ImageMat, TheImageIsACopyOfTheMatrix) {
    cv::Mat mat = ramp<float>(CV_32FC1);
    const Image image = from_mat(mat);
    mat.setTo(0);
    expect_ramp(image, 0, 0, 5, 4);
}

std::string refusal(const cv::Mat& mat) {
    try {
        from_mat(mat);
    } catch (const InputError& error) {
        return error.what();
    }
    return "taken";
}

TEST(ImageMat, ColourOtherDepthsAndVolumesAreRefusedWithAReason) {
    EXPECT_THAT(
        refusal(cv::Mat(2, 2, CV_8UC3, cv::Scalar(1, 2, 3))),
        ::testing::AllOf(::testing::HasSubstr("3 channels"), ::testing::HasSubstr("cv::cvtColor")));
    EXPECT_THAT(
        refusal(cv::Mat(2, 2, CV_64FC1, cv::Scalar(1))),
        ::testing::AllOf(::testing::HasSubstr("depth code 6"), ::testing::HasSubstr("convertTo")));
    const int sizes[] = {2, 2, 2};
    EXPECT_THAT(refusal(cv::Mat(3, sizes, CV_8UC1, cv::Scalar(1))),
                ::testing::HasSubstr("3 dimensions"));
}

}  // namespace
}  // namespace grainfield
