#pragma once

#include <vector>

#include "tracking/refine/joint_information.h"

namespace grainfield::tracking {

/// Covariance of one disc's position for unit noise [px²]: times σ² gives the real one. NaN where
/// the image says nothing about the disc.
struct PositionCovariance {
    double xx = 0, xy = 0, yy = 0;
};

/// The Cramér–Rao bound of every position with all other positions unknown too: the 2×2 diagonal
/// blocks of the inverse of the joint information matrix
///
///   A_ij = Σ_x J_i J_jᵀ,   J_i = ∂M/∂(x_i, y_i)   (JointInformation).
///
/// A disc without coupled neighbours has the inverse of its own block. For
/// the others the information of its neighbours is factorised, discs beyond them held fixed.
/// Where that raises the error by more than 17 %, their neighbours are unknown too, couplings among
/// these left out; if that changes the error by another 3 % (dense crystals), such discs are solved
/// together, by a sparse Cholesky factor and the recursion of `takahashi1973` for the entries of
/// the inverse. Discs that are all but hidden are left out and given NaN.
/// Independent of the number of threads. About 2 µs a disc in a liquid.
std::vector<PositionCovariance> joint_covariance(const JointInformation& info, int threads);

}  // namespace grainfield::tracking
