#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec2.h"

namespace grainfield::analysis {

/// A point of an integer grid.
struct GridPoint {
    std::int32_t x = 0;
    std::int32_t y = 0;
    friend bool operator==(const GridPoint&, const GridPoint&) = default;
};

/// The Delaunay triangulation of points of a grid: no circle through a triangle's corners holds
/// another point inside.
///
/// Points are inserted in random rounds, each along a Hilbert curve (`amenta2003`), and edges
/// flipped (`lawson1977`) until the triangulation is Delaunay again. Predicates are exact: the sign
/// of an area in 64 bits. The circle test is in doubles with a bound of their error, or in 128 bits
/// where that leaves it open. Beyond the hull lie triangles with a corner at infinity. Points at
/// one place are one point; points that all lie on a line have the next ones on it as neighbours.
/// Of points on one circle any triangulation is as good.
///
/// Cost about 0.4 µs a point, O(N) for patterns of bounded density; memory 70 B a point.
class Delaunay {
 public:
    static constexpr std::int32_t most = 1 << 29;  ///< of |x|, |y|

    explicit Delaunay(std::span<const GridPoint> points);

    /// A neighbour, and the triangles on both sides of the edge to it; none: −1.
    struct Spoke {
        int to = 0;      ///< index of the neighbour
        int right = -1;  ///< seen along the edge
        int left = -1;
    };

    /// The neighbours of point i, counterclockwise. Points at one place share theirs, one of them
    /// standing for all.
    void around(std::size_t i, std::vector<Spoke>& spokes) const;

    int triangles() const { return static_cast<int>(triangle_.size()); }

    /// The points at the corners of a triangle; −1 for one beyond the hull.
    std::array<int, 3> corners(int number) const;

    /// Centre of the circle through the corners of a triangle, a vertex of the Voronoi diagram, to
    /// a few roundings for flat triangles too.
    Vec2 centre(int number) const;

    /// Points in the order in which queries about them have the fewest cache misses.
    std::span<const int> order() const { return index_; }

 private:
    // Corners counterclockwise, −1 beyond the hull; neighbour k lies opposite to corner k.
    struct Triangle {
        std::array<int, 3> corner;
        std::array<int, 3> next;
    };
    struct Located {
        int triangle;
        bool is_taken;  // a corner of it is at the same place
        int corner;
    };
    const GridPoint& at(int vertex) const { return vertex_[static_cast<std::size_t>(vertex)]; }
    Triangle& triangle(int t) { return triangle_[static_cast<std::size_t>(t)]; }
    const Triangle& triangle(int t) const { return triangle_[static_cast<std::size_t>(t)]; }
    void sort(std::span<const GridPoint> points);
    bool start();
    void line_up();
    bool is_ghost(const Triangle& t) const;
    bool conflicts(int number, const GridPoint& p) const;
    Located locate(const GridPoint& p, int from) const;
    void split(int number, int vertex);
    void legalise(int vertex);
    void relink(int number, int from, int to);

    std::vector<GridPoint> vertex_;  // in the order of insertion
    std::vector<int> index_;         // original index of each vertex
    std::vector<int> of_point_;      // the vertex that stands for each point
    std::vector<int> triangle_of_;   // one at each vertex
    std::vector<Triangle> triangle_;
    std::vector<std::array<int, 2>> line_;  // neighbours of each vertex where all are on a line
    std::vector<int> stack_;
};

}  // namespace grainfield::analysis
