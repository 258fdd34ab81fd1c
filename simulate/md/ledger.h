#pragma once

#include <cmath>
#include <cstdint>

namespace grainfield::simulate {

/// A sum that does not depend on the order of its terms: fixed point, quantum 2^-40 = 9e-13, so
/// that tiles and threads give the same bits. Range ±8e6 in a window.
class ExactSum {
 public:
    void add(double term) { quanta_ += static_cast<std::uint64_t>(std::llrint(term * scale)); }
    void add(const ExactSum& other) { quanta_ += other.quanta_; }
    double value() const { return static_cast<double>(static_cast<std::int64_t>(quanta_)) / scale; }

 private:
    static constexpr double scale = 1099511627776.0;
    std::uint64_t quanta_ = 0;
};

/// What happened in a window: events by kind, energy that came and went, momentum handed over.
struct Ledger {
    std::int64_t pair = 0;
    std::int64_t low_plate = 0;
    std::int64_t high_plate = 0;
    std::int64_t wall = 0;
    std::int64_t sliding = 0;       ///< contacts that slid, of all that have friction
    std::int64_t contact_time = 0;  ///< collisions that the TC model made elastic
    std::int64_t crossing = 0;      ///< into another cell
    std::int64_t outdated = 0;      ///< predictions that had to be made again

    ExactSum pair_loss;     ///< energy lost between grains [m g a]
    ExactSum plate_loss;    ///< energy lost at plates and walls
    ExactSum work;          ///< energy that the plates put in
    ExactSum low_impulse;   ///< on the grains, upwards [m sqrt(g a)]
    ExactSum high_impulse;  ///< on the grains, downwards
    ExactSum pair_virial;   ///< Σ r·J over pair collisions [m a sqrt(g a)]

    std::int64_t real_events() const { return pair + low_plate + high_plate + wall; }

    void add(const Ledger& other) {
        pair += other.pair;
        low_plate += other.low_plate;
        high_plate += other.high_plate;
        wall += other.wall;
        sliding += other.sliding;
        contact_time += other.contact_time;
        crossing += other.crossing;
        outdated += other.outdated;
        pair_loss.add(other.pair_loss);
        plate_loss.add(other.plate_loss);
        work.add(other.work);
        low_impulse.add(other.low_impulse);
        high_impulse.add(other.high_impulse);
        pair_virial.add(other.pair_virial);
    }
};

}  // namespace grainfield::simulate
