#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/results.h"
#include "report/maps/places.h"

namespace grainfield::report {

/// What a reader sees as "frame with detections": one preview of one run, its image as PNG.
struct ParticleMap {
    std::size_t run = 0;
    std::string name;   ///< file name of SVG and CSV, "map_run1_frame0"
    std::string title;  ///< "frame 0, 10,456 particles"
    std::int64_t frame = 0;
    std::array<double, 2> x{}, y{};      ///< what is shown [length unit]
    bool y_down = true;                  ///< pixels: y grows downwards; simulations: upwards
    bool is_field = false;               ///< a picture of a field, without particles
    std::string unit;                    ///< "px", "a" or "cells"
    double diameter = 1;                 ///< [length unit]
    std::vector<std::uint8_t> png;       ///< empty: the run has no image
    std::array<double, 2> image_size{};  ///< covered by the PNG [px], from the corner (-0.5, -0.5)
    int reduction = 1;                   ///< pixels of the camera per pixel of the PNG, per axis
    std::vector<Vec2> position;          ///< [length unit]
    std::vector<std::int64_t> id;        ///< empty: not linked
    std::vector<Layer> layer;            ///< empty: not known
    std::string order = "|Q₄|";          ///< what `abs_q4` is called
    std::vector<double> abs_q4;          ///< [-]; empty: not analysed; NaN: undefined
    double time = 0;                     ///< of the frame [time unit]
    std::optional<double> phase{};  ///< of the vibration, 0 … 1, where its frequency is known
    std::vector<Place> places{};    ///< places_to_look_at
    std::vector<double> z{};        ///< Snapshot::z; empty: of no particle known; NaN: of this one
    std::vector<double> z_error{};  ///< Snapshot::z_error; empty: heights are exact
    double height = 0;              ///< between the plates [length unit]; 0 if unknown

    bool has_heights() const { return !z.empty(); }
};

/// How much of the previews goes into a report.
struct MapBudget {
    std::size_t maps = 44;                ///< shared by the runs, at least one each, 20 at most
    std::size_t image_bytes = 6'000'000;  ///< of all PNGs; images are reduced to keep it
    int threads = 0;                      ///< that encode images; 0: all of the machine
};

/// The previews of all runs, as many as the budget allows, spread over each run: every run gets as
/// many as the others until it has no more, so that one film among single frames keeps its frames.
/// Previews whose snapshot is inconsistent or empty and without image are left out. Of a field the
/// previews are pictures of ρ and ψ.
std::vector<ParticleMap> make_maps(const std::vector<Results>& runs, const MapBudget& budget);

/// The map for the page: discs as base64 of little-endian uint16 x, y (65535 steps over `x` and
/// `y`, padded by half a diameter) and uint8 |Q4| (0 … 254, 255 undefined), the image as data URI;
/// with identities uint32 of each (its lowest bits), with layers uint8 (0, 1, 255 unknown). Only
/// where heights are known: uint16 z (65534 steps over `zRange`, 65535 unknown), its error in uint8
/// hundredths of a diameter (254 and more as 254, 255 unknown), and the distance of the plates.
/// Without image it is null: map_image() gives it.
std::string map_json(const ParticleMap& map, bool with_image = true);

/// The image of a map as data URI; empty without one.
std::string map_image(const ParticleMap& map);

/// frame, particle, x, y, abs_q4; with z after y where heights are known
std::string map_csv(const ParticleMap& map);

}  // namespace grainfield::report
