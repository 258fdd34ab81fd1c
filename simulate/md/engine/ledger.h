#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace grainfield::simulate {

__extension__ typedef __int128 WideInteger;

/// A sum that does not depend on the order of its terms, so that tiles and threads give the same
/// bits: fixed point in two words, quanta 2^-10 and 2^-72 = 2e-22.
///
/// A term must be below 2^52 = 4.5e15 in size: all permitted amplitudes, frequencies and
/// temperatures stay a factor 10 below. Beyond, or not finite, the sum is NaN from then on. 1e18
/// such terms fit.
class ExactSum {
 public:
    void add(double term) {
        if (!(std::abs(term) < most)) {
            is_lost_ = true;
            return;
        }
        const auto coarse = static_cast<std::int64_t>(term * coarse_scale);
        const double rest = term - static_cast<double>(coarse) / coarse_scale;  // exact
        coarse_ += coarse;
        fine_ += static_cast<std::int64_t>(rest * fine_scale);
    }
    void add(const ExactSum& other) {
        coarse_ += other.coarse_;
        fine_ += other.fine_;
        is_lost_ = is_lost_ || other.is_lost_;
    }
    double value() const {
        if (is_lost_) return std::numeric_limits<double>::quiet_NaN();
        return static_cast<double>(coarse_) / coarse_scale +
               static_cast<double>(fine_) / fine_scale;
    }

 private:
    static constexpr double most = 0x1p52;
    static constexpr double coarse_scale = 0x1p10;
    static constexpr double fine_scale = 0x1p72;
    WideInteger coarse_ = 0;
    WideInteger fine_ = 0;
    bool is_lost_ = false;
};

/// The deepest contact of a window, with whom and when.
struct Deepest {
    double depth = 0;
    std::int32_t first = -1;   ///< identity of the grain
    std::int32_t second = -1;  ///< of its partner; -1: a plate or wall
    double time = 0;           ///< of the window

    void add(const Deepest& other) {
        const bool deeper = other.depth != depth ? other.depth > depth : other.time < time;
        if (deeper) *this = other;
    }
};

/// What happened in a window: events by kind, energy that came and went, momentum handed over.
struct Ledger {
    std::int64_t pair = 0;
    std::int64_t low_plate = 0;
    std::int64_t high_plate = 0;
    std::int64_t wall = 0;
    std::int64_t sliding = 0;       ///< contacts that slid, of all that have friction
    std::int64_t contact_time = 0;  ///< collisions that the TC model made elastic
    std::int64_t resting = 0;       ///< rebounds from plates raised to the least speed (TC model)
    std::int64_t crossing = 0;      ///< into another cell
    std::int64_t outdated = 0;      ///< predictions that had to be made again

    ExactSum pair_loss;     ///< energy lost between grains [m g a]
    ExactSum plate_loss;    ///< energy lost at plates and walls
    ExactSum work;          ///< energy that the plates put in
    ExactSum low_impulse;   ///< on the grains, upwards [m sqrt(g a)]
    ExactSum high_impulse;  ///< on the grains, downwards
    ExactSum pair_virial;   ///< Σ r·J over pair collisions [m a sqrt(g a)]

    Deepest deepest_pair;   ///< greatest 1 − r² of two grains at their contact [a²]
    Deepest deepest_plate;  ///< greatest depth in a plate or wall at a contact [a]
    double backwards = 0;   ///< greatest step back from one event to the next [sqrt(a/g)]

    std::int64_t real_events() const { return pair + low_plate + high_plate + wall; }

    void add(const Ledger& other) {
        pair += other.pair;
        low_plate += other.low_plate;
        high_plate += other.high_plate;
        wall += other.wall;
        sliding += other.sliding;
        contact_time += other.contact_time;
        resting += other.resting;
        crossing += other.crossing;
        outdated += other.outdated;
        pair_loss.add(other.pair_loss);
        plate_loss.add(other.plate_loss);
        work.add(other.work);
        low_impulse.add(other.low_impulse);
        high_impulse.add(other.high_impulse);
        pair_virial.add(other.pair_virial);
        deepest_pair.add(other.deepest_pair);
        deepest_plate.add(other.deepest_plate);
        backwards = std::max(backwards, other.backwards);
    }
};

}  // namespace grainfield::simulate
