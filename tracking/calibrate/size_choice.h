#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tracking/calibrate/explained_share.h"
#include "tracking/model/image_model.h"

namespace grainfield::tracking {

/// One answer to what the spheres of a frame are.
struct SizeCandidate {
    Polarity polarity = Polarity::dark;
    double diameter = 0;         ///< apparent D [px]
    double edge_width = 0;       ///< w [px]
    std::int64_t spheres = 0;    ///< fitted, in the part of the frame that was looked at
    ExplainedShare explained;    ///< of that part
    std::vector<Vec2> position;  ///< of the spheres, in the frame [px]
    int x = 0, y = 0, width = 0, height = 0;  ///< that part [px]
};

/// Discs of any size explain up to 0.73 of smooth random textures, those of sharp images over 0.9.
inline constexpr double kLeastExplained = 0.8;
/// Two answers are close if the better one leaves more than this share of what the other leaves.
inline constexpr double kClose = 0.7;

/// Which of the candidates the frame speaks for, and how clearly.
struct SizeChoice {
    std::optional<std::size_t> best;   ///< largest charged share, then signal; empty: none is given
    std::optional<std::size_t> rival;  ///< another size or polarity that explains it about as well
    bool explains_enough = false;      ///< the best one: kLeastExplained of the signal
};

/// Judges by the share of the variance that the fit explains, charged for its coordinates
/// (ExplainedShare). A rival has to explain enough itself and leave 1 − charged of nearly the same
/// size; candidates of one polarity within 15 % in diameter are one answer.
SizeChoice choose_size(const std::vector<SizeCandidate>& candidates);

/// Whether they are one answer: of one polarity, and within 15 % in diameter.
bool is_same_size(const SizeCandidate& a, const SizeCandidate& b);

/// The best of the others that explains enough, where `given` does not; empty: none.
std::optional<SizeCandidate> better_than(const SizeCandidate& given,
                                         const std::vector<SizeCandidate>& candidates);

/// What to do about it: "bright discs of 12.0 px, as given, explain 8 % of the frame; dark discs of
/// about 8.9 px explain 97 %: give …".
std::string advice_on_size(const SizeCandidate& given, const SizeCandidate& better);

/// The three that are shown to people, the best first.
std::vector<std::size_t> named_candidates(const std::vector<SizeCandidate>& candidates);

/// "dark D = 28.1 px explains 91.7 % (91.3 % charged for 356 positions); …", of the named ones.
std::string in_words(const std::vector<SizeCandidate>& candidates);

}  // namespace grainfield::tracking
