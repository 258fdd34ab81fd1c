#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/frame.h"
#include "core/vec2.h"

namespace grainfield::report {

/// A quantity that a reader may choose a value of.
struct AlternativeAxis {
    std::string label;                ///< "Apparent diameter"
    std::vector<std::string> values;  ///< "11.2 px", in their order
    std::size_t chosen = 0;           ///< at first
};

/// What one choice of them gives.
struct Alternative {
    std::vector<Vec2> position;  ///< in the picture [px]
    double diameter = 0;         ///< [px]
    std::string words;           ///< "412 spheres; residual .059"
    std::string settings;        ///< to be copied
};

/// Part of a frame with what other settings find in it: a picture, a slider a quantity, and the
/// settings that go with them.
struct Alternatives {
    std::string title;
    Image picture;
    std::vector<AlternativeAxis> axes;
    std::vector<Alternative> tried;  ///< one for each choice; the last axis runs fastest

    bool empty() const { return tried.empty(); }
};

/// The section of the page, which its script fills; empty where there is nothing.
std::string alternatives_html(const Alternatives& alternatives);

/// What the script needs: picture as PNG, positions in tenths of a pixel; "null" where there is
/// nothing. Throws OutputError if the picture cannot be coded.
std::string alternatives_json(const Alternatives& alternatives);

}  // namespace grainfield::report
