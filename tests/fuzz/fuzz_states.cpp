#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/support/snapshot_numbers.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"
#include "tracking/calibrate/illumination.h"
#include "tracking/layers/bilayer.h"
#include "tracking/synthesis/film_synthesis.h"
#include "tracking/tracker_state.h"

namespace grainfield::fuzz {

namespace {

// Restored, saved and restored once more.
template <class State>
void restore(const std::vector<double>& numbers) {
    NumberArchive archive(numbers);
    State state;
    archive(state);
    archive.require_end();
    NumberArchive saved;
    saved(state);
    const std::vector<double> again = saved.take_numbers();
    const auto is_same = [](double a, double b) {
        return a == b || static_cast<float>(a) == static_cast<float>(b) ||
               (std::isnan(a) && std::isnan(b));
    };
    promise(std::ranges::equal(again, numbers, is_same),
            "numbers that are restored are saved as they were");
}

constexpr std::array kinds{restore<Snapshot>,
                           restore<tracking::LinkState>,
                           restore<tracking::Located>,
                           restore<tracking::TrackSummary>,
                           restore<tracking::SynthesisedFrame>,
                           restore<tracking::Illumination>,
                           restore<tracking::Bilayer::Summary>};

}  // namespace

bool read_states(std::string_view bytes) {
    if (bytes.empty()) return false;
    const auto kind = static_cast<unsigned char>(bytes.front()) % kinds.size();
    bytes.remove_prefix(1);
    std::vector<double> numbers(bytes.size() / sizeof(double));
    if (!numbers.empty()) {
        std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(double));
    }
    return is_taken("stored numbers", [&] { kinds[kind](numbers); });
}

}  // namespace grainfield::fuzz
