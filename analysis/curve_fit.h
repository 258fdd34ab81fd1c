#pragma once

#include "analysis/fit_result.h"
#include "core/results.h"

namespace grainfield::analysis {

/// The observable "fit" of a spectrum that is known by its curves only: S(k) = S0 + S1 (ka)^α over
/// 0 < k ≤ k_max (`fit_spectrum`, `whittle1953`), as for fields, whose run has kept no blocks.
///
/// Taken are the curves "sk" (k, s, s_err) and "sk_samples" (dof) of the given observable.
/// Measurements: s0_over_s1, s0, s1, alpha, k_fit, s0_over_s1_low and _high (68 % of the profile
/// likelihood), chi2_per_dof; curve "fit". Errors are those of the likelihood: shells and
/// frames as independent as their `dof` say. The range is `options.k_max`, else `options.range`
/// times the pre-peak; without either, without samples or with too few shells there is a reason.
/// Cost O(shells).
ObservableResult curve_fit(const ObservableResult& sk, const FitOptions& options);

}  // namespace grainfield::analysis
