#include "simulate/md/md_series.h"

#include <algorithm>
#include <cmath>

namespace grainfield::simulate {

std::vector<double> sums_of(const Ledger& ledger) {
    std::vector<double> sums(sum_count);
    sums[sum_pair] = static_cast<double>(ledger.pair);
    sums[sum_low] = static_cast<double>(ledger.low_plate);
    sums[sum_high] = static_cast<double>(ledger.high_plate);
    sums[sum_wall] = static_cast<double>(ledger.wall);
    sums[sum_sliding] = static_cast<double>(ledger.sliding);
    sums[sum_contact_time] = static_cast<double>(ledger.contact_time);
    sums[sum_resting] = static_cast<double>(ledger.resting);
    sums[sum_pair_loss] = ledger.pair_loss.value();
    sums[sum_plate_loss] = ledger.plate_loss.value();
    sums[sum_work] = ledger.work.value();
    sums[sum_low_impulse] = ledger.low_impulse.value();
    sums[sum_high_impulse] = ledger.high_impulse.value();
    sums[sum_virial] = ledger.pair_virial.value();
    return sums;
}

MdSeries::MdSeries(const MdSystem& system, std::int64_t grains)
    : system_(system),
      grains_(static_cast<double>(std::max<std::int64_t>(grains, 1))),
      last_sums_(sum_count, 0) {
    curve_ = {.name = "md", .title = "Time series of the run", .columns = {}, .text_columns = {}};
    const auto column = [this](const char* name, const char* unit, const char* meaning) {
        curve_.columns.push_back({.name = name, .unit = unit, .meaning = meaning, .values = {}});
    };
    column("t", "periods", "time");
    column("energy_xy", "m g a", "horizontal kinetic energy per grain, at phase 0");
    column("energy_z", "m g a", "vertical kinetic energy per grain, at phase 0");
    column("energy_rotation", "m g a", "rotational energy per grain, at phase 0");
    column("energy_potential", "m g a", "potential energy per grain, at phase 0");
    column("pair", "1/period", "pair collisions over N");
    column("low_plate", "1/period", "low plate collisions over N");
    column("high_plate", "1/period", "high plate collisions over N");
    column("wall", "1/period", "side wall collisions over N");
    column("sliding", "-", "share of collisions that slid");
    column("contact_time", "1/period", "collisions over N that the TC model made elastic");
    column("resting", "1/period", "rebounds over N raised to the least speed (TC model)");
    column("work", "m g a", "energy put in by the plates per grain and period");
    column("loss_pair", "m g a", "energy lost between grains per grain and period");
    column("loss_plate", "m g a", "energy lost at plates and walls per grain and period");
    column("impulse_low", "m g", "mean force of the low plate per grain");
    column("impulse_high", "m g", "mean force of the high plate per grain");
    column("pressure", "m g/a^2", "kinetic and collisional pressure, mean since the last sample");
    column("audit", "m g a", "energy change + losses − work per grain, since the start");
}

void MdSeries::add(double periods, const Energies& energies, const std::vector<double>& sums,
                   double kinetic) {
    const double span = periods - last_periods_;
    const double per = span > 0 ? 1 / (span * grains_) : 0;
    const auto delta = [&](SumIndex i) { return sums[i] - last_sums_[i]; };
    const double time = span * system_.period();
    const double volume = system_.length.x * system_.length.y * system_.length.z;
    const double contacts = delta(sum_pair) + delta(sum_low) + delta(sum_high) + delta(sum_wall);
    const double pressure =
        (2 * kinetic / 3 + (time > 0 ? delta(sum_virial) / (3 * time) : 0)) / volume;
    const double balance =
        energies.total() + sums[sum_pair_loss] + sums[sum_plate_loss] - sums[sum_work];
    const double start = rows_ == 0 ? balance : audit_origin_;
    if (rows_ == 0) audit_origin_ = balance;
    const double values[] = {periods,
                             energies.horizontal / grains_,
                             energies.vertical / grains_,
                             energies.rotational / grains_,
                             energies.potential / grains_,
                             delta(sum_pair) * per,
                             delta(sum_low) * per,
                             delta(sum_high) * per,
                             delta(sum_wall) * per,
                             contacts > 0 ? delta(sum_sliding) / contacts : 0,
                             delta(sum_contact_time) * per,
                             delta(sum_resting) * per,
                             delta(sum_work) * per,
                             delta(sum_pair_loss) * per,
                             delta(sum_plate_loss) * per,
                             time > 0 ? delta(sum_low_impulse) / (time * grains_) : 0,
                             time > 0 ? delta(sum_high_impulse) / (time * grains_) : 0,
                             pressure,
                             (balance - start) / grains_};
    for (std::size_t i = 0; i < curve_.columns.size(); ++i) column(i).push_back(values[i]);
    ++rows_;
    last_periods_ = periods;
    last_sums_ = sums;
}

std::vector<double> MdSeries::numbers(std::size_t rows) const {
    std::vector<double> numbers{audit_origin_};
    for (const Column& c : curve_.columns) {
        numbers.insert(numbers.end(), c.values.begin(),
                       c.values.begin() + static_cast<std::ptrdiff_t>(std::min(rows, rows_)));
    }
    return numbers;
}

void MdSeries::restore(const std::vector<double>& numbers, const std::vector<double>& last_sums) {
    const std::size_t columns = curve_.columns.size();
    rows_ = (numbers.size() - 1) / columns;
    audit_origin_ = numbers.front();
    for (std::size_t i = 0; i < columns; ++i) {
        const auto first = numbers.begin() + 1 + static_cast<std::ptrdiff_t>(i * rows_);
        column(i).assign(first, first + static_cast<std::ptrdiff_t>(rows_));
    }
    last_periods_ = rows_ > 0 ? column(0).back() : 0;
    last_sums_ = last_sums;
}

double MdSeries::late_mean(const std::string& name) const {
    const Column* c = curve_.find(name);
    if (c == nullptr || rows_ == 0) return 0;
    const std::size_t first = rows_ / 2;  // as analyze takes it
    double sum = 0;
    for (std::size_t i = first; i < rows_; ++i) sum += c->values[i];
    return sum / static_cast<double>(rows_ - first);
}

}  // namespace grainfield::simulate
