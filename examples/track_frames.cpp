// Trajectories of spheres in frames from memory.
#include <cstdio>
#include <set>

#include <opencv2/imgproc.hpp>

#include "core/image_mat.h"
#include "core/memory_frames.h"
#include "tracking/tracking.h"

int main() {
    std::vector<grainfield::Image> images;
    for (int frame = 0; frame < 5; ++frame) {
        cv::Mat picture(240, 320, CV_8UC1, cv::Scalar(200));
        for (int i = 0; i < 20; ++i) {
            const cv::Point centre(35 + 60 * (i % 5) + 2 * frame, 30 + 55 * (i / 5) + frame);
            cv::circle(picture, centre, 12, cv::Scalar(60), cv::FILLED, cv::LINE_AA);
        }
        cv::GaussianBlur(picture, picture, {}, 1.2);
        images.push_back(grainfield::from_mat(picture));
    }
    grainfield::MemoryFrames frames(std::move(images), 100.0);
    const auto trajectory = grainfield::tracking::track(frames);
    std::set<std::int64_t> tracks;
    for (const auto& snapshot : trajectory.snapshots)
        tracks.insert(snapshot.id.begin(), snapshot.id.end());
    std::printf("%zu tracks in %zu frames\n", tracks.size(), trajectory.snapshots.size());
}
