#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/lab_units.h"
#include "core/option_table.h"
#include "simulate/md/state/md_system.h"

namespace grainfield::simulate {

enum class Side { periodic, walls };
enum class InitialLayout { random, square };

struct CellOptions {
    std::int64_t grains = 9875;     ///< N
    double length_x = 100;          ///< [a]
    double length_y = 100;          ///< [a]
    double height = 1.84;           ///< L_z, between the plates [a]
    Side sides_x = Side::periodic;  ///< x boundaries
    Side sides_y = Side::periodic;  ///< y boundaries
    Vertical vertical = Vertical::plates;
    double gravity = 1;  ///< [g]
};

/// How the plates move, z = A sin ωt: in the units of the simulation, in those of a lab, or by Γ.
struct VibrationOptions {
    std::optional<double> amplitude;          ///< A [a]; empty: from what follows, or 0.08
    std::optional<double> angular_frequency;  ///< ω [sqrt(g/a)]; empty: from what follows, or 5
    LabUnits lab;

    struct Motion {
        double amplitude = 0;          ///< A [a]
        double angular_frequency = 0;  ///< ω [sqrt(g/a)]
    };
    /// A and ω. With Γ and one of them the other follows from Γ = Aω²/g; with Γ alone, A with ω
    /// = 5. Hz and mm count through lab.sphere_mm. `gravity`: of the cell [g]. Throws OptionError
    /// for statements that contradict each other, with both values, and for lab units without
    /// lab.sphere_mm, and where what follows is out of the range of its option.
    Motion motion(double gravity) const;

    /// How the option of this name is given where it wins over the values held here.
    enum class Given { no, as_auto, as_value };
    /// Empties what the options that are about to be set would contradict. Γ takes the place of
    /// the amplitude, or of the frequency where an amplitude is given with it.
    void make_room_for(const std::function<Given(const std::string& name)>& given);
};

struct InitialOptions {
    InitialLayout layout = InitialLayout::random;
    double temperature = 0.4;       ///< of the Maxwellian velocities [m g a]
    double crystal_spacing = 0.81;  ///< projected spacing of the square patch [a]
    double crystal_fraction = 0.2;  ///< of the area, taken by the patch [-]
    std::optional<double> melt;     ///< collisions per grain of elastic mixing; auto: as needed
};

struct RunOptions {
    double periods = 200;            ///< of the vibration; of sqrt(a/g) where nothing vibrates
    double discard = 0;              ///< periods before the first snapshot
    double snapshot_every = 10;      ///< periods
    double snapshot_phase = 0;       ///< [periods] 0 … 1
    std::int64_t sample_every = 1;   ///< periods between entries of the time series
    double contact_time = 0;         ///< TC model, 0: off [sqrt(a/g)]
    double plate_tolerance = 1e-15;  ///< [a]
    std::int64_t event_limit = 1'000'000;  ///< events of a grain in a window that mean collapse
    int tiles = 0;                         ///< strips worked on at a time, 0: as the threads need
};

/// Everything about a molecular-dynamics run; sections cell, vibration, grain, plate, initial, run.
struct MdOptions {
    CellOptions cell;
    VibrationOptions vibration;
    ContactLaw grain;
    ContactLaw plate;
    InitialOptions initial;
    RunOptions run;

    /// Throws OptionError if these cannot be simulated.
    MdSystem system() const;
};

std::vector<OptionTable> describe(MdOptions& options);

}  // namespace grainfield::simulate
