#pragma once

#include <vector>

#include "core/vec2.h"

namespace grainfield::simulate {

/// A filled disc in the frame [px].
struct Disc {
    Vec2 centre;
    double radius;
};

/// The exact area of every pixel of a disc, row by row.
///
/// With h(t) = √(R² − t²), t measured from the centre, the area of the pixel between the columns u
/// and u + 1 in the row [t0, t1] is F(u + 1) − F(u), where
///
///   F(u) = ∫_{t0}^{t1} min(max(u, −h), h) dt = u (b − a) + H(b') − H(b) + H(a) − H(a'),
///   H(t) = (t h(t) + R² asin(t/R))/2,
///
/// a, b: t0, t1 clipped to |t| ≤ √(R² − u²); a', b': clipped to |t| ≤ R. H is tabulated once per
/// row border and once per column border (arc_areas), so that a pixel costs a dozen operations.
/// Rounding error about 1e-15 R².
class DiscScan {
 public:
    /// Calls edge(x, y, area) for the pixels cut by the circle, with 0 < area ≤ 1, and
    /// full(y, x_first, x_end) for runs of covered pixels, within columns [0, width) and rows
    /// [y_first, y_end).
    template <class Edge, class Full>
    void scan(const Disc& disc, int width, int y_first, int y_end, Edge&& edge, Full&& full) {
        if (!prepare(disc, width, y_first, y_end)) return;
        for (int y = top_; y < bottom_; ++y) {
            const Row row = row_at(y);
            if (row.full_first >= row.full_end) {
                edges(row, row.first, row.end, y, edge);
                continue;
            }
            edges(row, row.first, row.full_first, y, edge);
            full(y, row.full_first, row.full_end);
            edges(row, row.full_end, row.end, y, edge);
        }
    }

 private:
    struct Row {
        double t0, t1;   // its borders, clipped to the disc
        double h0, h1;   // H there
        int first, end;  // pixels touched
        int full_first;  // covered ones; none if >= full_end
        int full_end;
    };
    struct Border {
        double u;  // |column border − centre|, at most R
        double k;  // half of the chord along it
        double h;  // H(k)
        double sign;
    };

    bool prepare(const Disc& disc, int width, int y_first, int y_end);
    Row row_at(int y) const;

    double area_left_of(const Row& row, const Border& border) const {
        const double k = border.k;
        double h_b = row.h1;
        double b = row.t1;
        if (b > k) {
            b = k;
            h_b = border.h;
        } else if (b < -k) {
            b = -k;
            h_b = -border.h;
        }
        double h_a = row.h0;
        double a = row.t0;
        if (a < -k) {
            a = -k;
            h_a = -border.h;
        } else if (a > k) {
            a = k;
            h_a = border.h;
        }
        return border.sign * (border.u * (b - a) + (row.h1 - h_b) + (h_a - row.h0));
    }

    template <class Edge>
    void edges(const Row& row, int first, int end, int y, Edge& edge) const {
        if (first >= end) return;
        const Border* border = columns_.data() + (first - left_);
        double before = area_left_of(row, *border);
        for (int x = first; x < end; ++x) {
            const double after = area_left_of(row, *++border);
            const double area = after - before;
            if (area > 0) edge(x, y, area < 1 ? area : 1.0);
            before = after;
        }
    }

    Disc disc_{};
    int left_ = 0;  // first column that the disc may touch, not clipped
    int top_ = 0;
    int bottom_ = 0;
    int first_ = 0;  // columns of the frame
    int end_ = 0;
    int row_origin_ = 0;
    std::vector<Border> columns_;
    struct RowBorder {
        double t, half_chord, h;
    };
    std::vector<RowBorder> rows_;
    std::vector<double> distance_;  // of the borders, and what arc_areas makes of them
};

}  // namespace grainfield::simulate
