// Spheres in a cv::Mat from memory.
#include <cstdio>

#include <opencv2/imgproc.hpp>

#include "core/image_mat.h"
#include "tracking/tracking.h"

int main() {
    cv::Mat picture(300, 400, CV_8UC1, cv::Scalar(200));
    for (int row = 0; row < 9; ++row) {
        for (int column = 0; column < 12; ++column) {
            const cv::Point centre(30 + 31 * column, 25 + 31 * row);
            cv::circle(picture, centre, 12, cv::Scalar(60), cv::FILLED, cv::LINE_AA);
        }
    }
    cv::GaussianBlur(picture, picture, {}, 1.2);

    const auto found = grainfield::tracking::locate(grainfield::from_mat(picture));
    std::printf("%zu spheres\n", found.size());
    for (const auto& p : found.position) std::printf("%.2f %.2f\n", p.x, p.y);
}
