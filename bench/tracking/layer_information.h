#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tracking/synthesis/picture_information.h"

namespace grainfield::bench {

constexpr double kCellHeight = 1.94;  // [a]
constexpr auto kTop = static_cast<float>(kCellHeight - 1);
constexpr double kLayerFrame = 10;  // side of the picture of a layer [a]
/// Projected distance to the nearest neighbour: classes end here [a]. Two more classes hold the
/// upper and the lower of those nearer than 0.95 a.
constexpr std::array<double, 5> kClassEnds = {0.6, 0.8, 0.95, 1.02, 1.3};
constexpr std::size_t kClasses = kClassEnds.size() + 3;

/// How a layer is lit and seen.
struct View {
    std::string name;
    tracking::MirrorOptics optics;
};

/// A melted bilayer of 1.17 spheres per a² about the picture; `share` of it, moved on, if below 1.
std::vector<tracking::Point3> layer_of(std::uint64_t seed, double share);

double distance_in_plane(const tracking::Point3& p, const tracking::Point3& q);

/// A sphere at another height, where the camera sees its centre at the same place.
tracking::Point3 at_height(const tracking::Point3& p, float z,
                           const tracking::MirrorOptics& optics);

/// Bounds of the spheres of one class, all others known and all free [a].
struct ClassBounds {
    std::vector<double> plane_known, height_known, plane, height;
};

/// What a picture tells of a layer of which all is free that it shows. Spheres 1.5 a or more within
/// it are judged.
class LayerInformation {
 public:
    LayerInformation(std::vector<tracking::Point3> spheres, const View& view, int threads);

    void add_bounds(std::vector<ClassBounds>& classes) const;

    /// Exchanges the heights of each pair that differ by 0.3 a or more: standard deviations of the
    /// noise by which that is told once x and y of both have followed, by class of distance.
    void exchange(std::vector<std::vector<double>>& told) const;

    /// The same of all spheres at other heights once every x and y has followed, and RMS
    /// difference.
    struct Told {
        double rms = 0, noises = 0;
    };
    Told turned() const;              ///< upside down
    Told lifted(float height) const;  ///< [a]

 private:
    std::size_t index(std::size_t i) const { return static_cast<std::size_t>(free_[i]); }
    const tracking::Point3& of(std::size_t i) const { return spheres_[index(i)]; }
    bool is_judged(std::size_t i) const;
    std::size_t nearest(std::size_t i) const;
    Told told_from(const std::vector<tracking::Point3>& other) const;
    tracking::PictureInformation made(int threads);

    std::vector<tracking::Point3> spheres_;
    tracking::MirrorOptics optics_;
    std::vector<std::int32_t> free_;
    tracking::PictureInformation picture_;
};

}  // namespace grainfield::bench
