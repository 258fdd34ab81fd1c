#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/unit.h"

namespace grainfield {

enum class Scale { linear, log };

/// The unit that a run has on an axis. Runs share an axis even where their units differ.
struct RunUnit {
    Unit unit;
    std::optional<TimeUnit> time{};  ///< of the run; empty where the unit has no time in it

    friend bool operator==(const RunUnit&, const RunUnit&) = default;
};

/// The unit with the time unit of a run, if it has time in it.
RunUnit run_unit(const Unit& unit, TimeUnit time);

/// An axis of a figure.
struct Axis {
    std::string name;   ///< column in the CSV: "k"
    std::string label;  ///< "Wavevector k"
    Unit unit{};
    Scale scale = Scale::linear;
    bool from_zero = false;        ///< a linear axis shows zero
    std::vector<RunUnit> units{};  ///< those of the runs, each once; empty: `unit`

    std::string unit_text() const;  ///< "1/a", "1/a or 1/l", empty if dimensionless
    std::string title() const;      ///< "Wavevector k [1/a]"
};

enum class Mark {
    line,   ///< points joined by a line, with error bars
    curve,  ///< a smooth line without points: a fit
    steps,  ///< a histogram's outline, x at the centres of the bins
    guide   ///< a line to compare slopes with; belongs to no run
};

/// Where the values of a series stand in the results.
struct CurveColumns {
    std::string observable, curve, x, y, error;
};

/// One kind of series in a figure; every run may have one.
struct SeriesHint {
    std::string label;  ///< with `by` and no `word`: what stands before the word
    Mark mark = Mark::line;
    bool shown = true;  ///< false: on the page only after a click, not in the SVG
    CurveColumns from;
    std::string by{};           ///< text column whose words tell series apart; empty: one series
    std::string word{};         ///< the word of `by` that is drawn; empty: each its own series
    double negligible_end = 0;  ///< a last value below this share of the largest is left out
};

/// A line y ∝ x^exponent to compare slopes with.
struct GuideHint {
    enum class Place { lowest_corner, above_the_end };
    std::string label;
    double exponent = 1;
    Place place = Place::lowest_corner;
    struct OnALine {
        std::string label;
        double exponent = 0;
    };
    std::optional<OnALine> on_a_line{};  ///< instead, of a one-dimensional system
    std::string note{};                  ///< said once a guide is drawn
};

/// When a figure stands on the page.
enum class Presence {
    always,           ///< where no run has data it says why
    with_observable,  ///< if a run measured the observable
    with_curve,       ///< if a run has the curve
};

/// How an observable wants to be drawn. Written beside the observable, read by the report.
struct FigureHint {
    std::string name;   ///< file name of SVG and CSV, id on the page
    std::string title;  ///< for people
    std::string note;   ///< what to know when reading it; may be empty
    Axis x, y;
    /// The first one says which curve the figure is of: runs without it are listed with the reason.
    std::vector<SeriesHint> series;
    int place = 100;  ///< figures stand on the page by growing place
    Presence presence = Presence::with_curve;
    bool may_be_linear = false;          ///< a button switches the logarithmic axes to linear ones
    bool title_of_curve = false;         ///< the title is that of the first series' curve
    bool x_names_order = false;          ///< x is called |Q_k| after the symmetry that was measured
    std::string note_of_square_order{};  ///< said where that is |Q₄| in all runs
    bool one_time_unit = false;          ///< runs in another time unit than the first are left out
    bool panel_by_origin = false;        ///< also drawn for each origin alone
    bool half_of_periodic_box = false;   ///< x ends at half the shorter side of a periodic box
    std::string note_of_half_box{};      ///< said where that leaves something out
    std::size_t least_points = 1;        ///< of a series; shorter ones are left out
    std::optional<Axis> without_time{};  ///< x where the runs do not share a time unit
    std::vector<GuideHint> guides{};
    /// What it is, how to read it and what is usual, for somebody who sees it for the first time.
    /// Figures that have it stand first on the page.
    std::string reading{};
};

}  // namespace grainfield
