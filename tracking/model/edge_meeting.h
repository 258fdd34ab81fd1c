#pragma once

#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/padded_image.h"

namespace grainfield::tracking {

/// What the product of transmissions misses where blurred edges of several opaque discs meet.
///
/// A lens blurs the union of the discs, not each disc. Where two straight edges with outward
/// normals n_1, n_2 meet, the light that passes both is a bivariate normal probability of
/// correlation ρ = n_1 · n_2: the product T_1 T_2 where they cross at right angles, max(0, T_1 +
/// T_2 − 1) where discs touch face to face (darknesses add), min(T_1, T_2) where they coincide. To
/// first order in ρ
///
///   T = Π_j T_j · (1 + c),   c = κ Σ_{i<j} ρ_ij P_i P_j = κ/2 (|Σ_j P_j n_j|² − Σ_j P_j²),
///
/// κ = 3.5. At a contact the product displaces both discs by 0.4 % of D, this form by 0.15 % at
/// most at any distance from 0.5 D to 1.3 D (w = 0.075 D, D = 16 px; tests).
///
/// A profile other than tanh, with a correction C, passes Π_j (1 − P_j − C_j) instead of Π_j T_j.
///
/// Returns the darkness image that the product of tanh discs should be fitted to at these
/// positions,
///
///   I + c Π_j T_j + Π_j (1 − P_j − C_j) − Π_j T_j,
///
/// c limited to [−1, 2], and zero if transmissions multiply (EdgeMeeting::product). At rest the
/// residual of the whole model is orthogonal to the tanh derivatives, so that positions have no
/// bias. `transmission`: Π_j T_j. O(discs), about 5 µs each at D = 16 px; bands of rows in
/// parallel, the same bits for any number of threads.
Image as_product(const Image& darkness, const PaddedImage& transmission,
                 const std::vector<Vec2>& positions, const DiscProfile& disc, int threads,
                 EdgeMeeting meeting = EdgeMeeting::blurred_union,
                 const RadialCorrection& correction = {});

}  // namespace grainfield::tracking
