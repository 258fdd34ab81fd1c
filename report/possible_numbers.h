#pragma once

#include <vector>

#include "core/results.h"

namespace grainfield::report {

/// The run without numbers that its film cannot have; each gets the reason in place of its value:
///
/// - of one frame: phases, S at the lowest k, the fit of S(k), and curves of these fits;
/// - an averaging time of the phases that is longer than the film;
/// - diffusion coefficient and offset where the exponent of the MSD says flight or a cage
///   (judge_diffusion);
/// - number variance of other boxes where its error is half of it and more, and the whole of a box
///   of which less than half of the windows are left;
/// - a number of samples below 2, of which no error can be made.
///
/// Files written by `analyze` keep all of them.
Results with_possible_numbers(Results run);

/// By its time stamps [time unit]; by the frame rate in files that do not hold it, where every
/// frame of the film was taken. 0: not known.
double length_of_film(const Results& run);

/// Beside runs that have S(k), a walled run of one frame, whose mean density cannot be subtracted,
/// loses its own: that of the walls, which would stretch the axes a thousandfold.
void leave_out_incomparable(std::vector<Results>& runs);

}  // namespace grainfield::report
