#pragma once

#include <string>
#include <utility>

#include <opencv2/core/mat.hpp>

#include "core/errors.h"
#include "core/frame.h"

namespace grainfield {

/// The pixels of an image as an OpenCV matrix of type CV_32FC1, without a copy: what writes to one
/// changes the other. Valid as long as the image lives and keeps its size.
///
/// Only users of this header need OpenCV (link `OpenCV::core`).
inline cv::Mat as_mat(Image& image) {
    if (image.empty()) return {};
    return {image.height(), image.width(), CV_32FC1, image.pixels().data()};
}

/// Same for reading. cv::Mat has no constant pixels: casting the const away changes the image.
inline const cv::Mat as_mat(const Image& image) {  // NOLINT(readability-const-return-type)
    return as_mat(const_cast<Image&>(image));      // NOLINT(cppcoreguidelines-pro-type-const-cast)
}

/// A copy of a grey matrix, counts as they are: CV_8UC1, CV_16UC1 or CV_32FC1, of any stride, so
/// also a region of interest. An empty matrix gives an empty image.
///
/// Throws InputError for more than one channel, more than two dimensions or another depth.
inline Image from_mat(const cv::Mat& mat) {
    if (mat.empty()) return {};
    const auto refuse = [](std::string actual, std::string suggestion) -> void {
        throw InputError({.problem = "this cv::Mat is not a grey picture",
                          .actual = std::move(actual),
                          .expected = "two dimensions, one channel of 8 bit, 16 bit or float",
                          .suggestion = std::move(suggestion)});
    };
    if (mat.dims != 2) refuse(std::to_string(mat.dims) + " dimensions", {});
    if (mat.channels() != 1) {
        refuse(std::to_string(mat.channels()) + " channels", "convert it with cv::cvtColor first");
    }
    if (mat.depth() != CV_8U && mat.depth() != CV_16U && mat.depth() != CV_32F) {
        refuse("depth code " + std::to_string(mat.depth()),
               "convert it with cv::Mat::convertTo first");
    }
    Image image(mat.cols, mat.rows);
    cv::Mat pixels = as_mat(image);
    mat.convertTo(pixels, CV_32F);
    return image;
}

}  // namespace grainfield
