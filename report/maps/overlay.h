#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/frame.h"
#include "core/snapshot.h"
#include "report/figures/colours.h"

namespace grainfield::report {

/// What the colours of particles mean: a range of numbers, or classes.
struct ColourKey {
    std::string title = "|Q4|";             ///< with its unit; ASCII
    double low = 0, high = 1;               ///< shown as the ends of viridis
    std::vector<std::string> classes = {};  ///< not empty: values are 0, 1, … of these; ASCII
    std::string other = {};                 ///< name of what is no class; ASCII; empty: not shown

    /// NaN, and what is no class: grey.
    Colour colour_of(double value) const;
};

struct OverlayOptions {
    int trail = 25;                  ///< frames that a trail reaches back [-]; 0: none
    double diameter = 1;             ///< of a particle [length unit]
    std::array<double, 2> x{}, y{};  ///< what is shown [length unit]
    bool y_down = true;              ///< pixels: y grows downwards; simulations: upwards
    int width = 0;                   ///< of the picture [px]
    int height = 0;                  ///< of the picture without the strip [px]
    ColourKey key = {};              ///< of what draw() is given
    bool has_strip = false;          ///< below the picture: caption and colour key
};

/// Pictures of a film with what was found in it: the camera's frame (white where there is none),
/// each particle as a ring of 85 % of its diameter in the colour of its value, and its trail
/// through the frames before. A step of more than two diameters, a boundary crossed, leaves a gap
/// in the trail. Cost O(pixels + particles (area of a disc + trail)).
class Overlay {
 public:
    explicit Overlay(const OverlayOptions& options);

    /// Of what draw() gives, the strip included [px].
    int width() const { return options_.width; }
    int height() const { return options_.height + strip_height_; }

    /// Frames in order of time. `values` is empty or has one number a particle. `caption`, ASCII,
    /// stands in the strip. Gives red, green and blue of each pixel, row 0 on top.
    const std::vector<std::uint8_t>& draw(const Image& image, const Snapshot& snapshot,
                                          const std::vector<double>& values,
                                          const std::string& caption = "");

 private:
    struct Trace {
        std::deque<Vec2> points;
        std::int64_t last = 0;  ///< frame
    };

    void draw_background(const Image& image);
    void draw_strip(const std::string& caption);
    void draw_ring(Vec2 centre, Colour colour, bool filled);
    void draw_trails(const Snapshot& snapshot);
    void draw_line(Vec2 from, Vec2 to);
    void blend(int x, int y, Colour colour, double share);
    Vec2 on_picture(Vec2 position) const;

    OverlayOptions options_;
    int strip_height_ = 0;  ///< [px]
    std::vector<std::uint8_t> rgb_;
    std::unordered_map<std::int64_t, Trace> traces_;
    std::optional<std::array<double, 2>>
        range_;  ///< counts shown black and white, of the first frame
    std::int64_t frame_ = 0;
};

}  // namespace grainfield::report
