#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec2.h"
#include "tracking/model/padded_image.h"
#include "tracking/refine/disc_stencil.h"

namespace grainfield::tracking {

/// Transmissions of one disc on its stencil, in half precision: t ∈ [1e-3, 1] to 2.4e-4 of its
/// value. What is stored is what multiplies the image, so that it divides out again.
using HalfFloat = std::uint16_t;

/// t of a disc somewhere in its window and −∂t/∂(x, y)/t, stencil.size() values each, in the order
/// of the stencil, and the pieces in which t differs from 1.
struct DiscTemplate {
    const HalfFloat* t = nullptr;
    const HalfFloat* x = nullptr;
    const HalfFloat* y = nullptr;
    const std::vector<DiscStencil::Piece>* pieces = nullptr;
};

/// A disc's window in the images of a scene, to be read. The images need the margin of
/// disc_kernel.h and the pitch of the stencil.
struct ConstStencilView {
    const DiscStencil& stencil;
    const PaddedImage& darkness;
    const PaddedImage& transmission;
    Anchor anchor;
    const HalfFloat* own;  ///< stencil.size() values, where t is kept when it is computed
    DiscTemplate shape{};  ///< what the disc is drawn from, if it is; then `own` is not read

    bool has_shape() const { return shape.t != nullptr; }
    const HalfFloat* kept() const { return has_shape() ? shape.t : own; }
};

/// The same, to be drawn in.
struct StencilView {
    const DiscStencil& stencil;
    const PaddedImage& darkness;
    PaddedImage& transmission;
    Anchor anchor;
    HalfFloat* own;
    DiscTemplate shape{};

    operator ConstStencilView() const {
        return {stencil, darkness, transmission, anchor, own, shape};
    }
};

/// The normal equations of one disc's position, all others fixed:
///   J = ∂M/∂(x, y) = T · (dt/dr)/t · (x − centre)/r,  A = Σ J Jᵀ,  b = Σ J (I − M).
struct NormalEquations {
    double xx = 0, xy = 0, yy = 0;  ///< A [1/px²]
    double bx = 0, by = 0;          ///< b [1/px]
    double misfit = 0;              ///< Σ (I − M)² over the edge
};

/// Σ J_a J_bᵀ over the pixels that both edges reach: what couples the positions of two discs.
struct CrossBlock {
    double xx = 0, xy = 0, yx = 0, yy = 0;  ///< [1/px²]
};

}  // namespace grainfield::tracking
