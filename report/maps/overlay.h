#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/frame.h"
#include "core/snapshot.h"

namespace grainfield::report {

struct OverlayOptions {
    int trail = 25;                  ///< frames that a trail reaches back [-]; 0: none
    double diameter = 1;             ///< of a particle [length unit]
    std::array<double, 2> x{}, y{};  ///< what is shown [length unit]
    bool y_down = true;              ///< pixels: y grows downwards; simulations: upwards
    int width = 0;                   ///< of the picture [px]
    int height = 0;                  ///< of the picture [px]
};

/// Pictures of a film with what was found in it: the camera's frame (white where there is none),
/// each particle as a ring of 85 % of its diameter in the colour of its |Q4| (viridis; grey where
/// unknown), and its trail through the frames before. A step of more than two diameters, a boundary
/// crossed, leaves a gap in the trail. Cost O(pixels + particles (area of a disc + trail)).
class Overlay {
 public:
    explicit Overlay(const OverlayOptions& options) : options_(options) {}

    /// Frames in order of time. `abs_q4` is empty or has one number a particle. Gives red, green
    /// and blue of each pixel, row 0 on top.
    const std::vector<std::uint8_t>& draw(const Image& image, const Snapshot& snapshot,
                                          const std::vector<double>& abs_q4);

 private:
    struct Trace {
        std::deque<Vec2> points;
        std::int64_t last = 0;  ///< frame
    };

    void draw_background(const Image& image);
    void draw_ring(Vec2 centre, std::array<std::uint8_t, 3> colour, bool filled);
    void draw_trails(const Snapshot& snapshot);
    void draw_line(Vec2 from, Vec2 to);
    void blend(int x, int y, std::array<std::uint8_t, 3> colour, double share);
    Vec2 on_picture(Vec2 position) const;

    OverlayOptions options_;
    std::vector<std::uint8_t> rgb_;
    std::unordered_map<std::int64_t, Trace> traces_;
    std::optional<std::array<double, 2>>
        range_;  ///< counts shown black and white, of the first frame
    std::int64_t frame_ = 0;
};

}  // namespace grainfield::report
