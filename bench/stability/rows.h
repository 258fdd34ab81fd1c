#pragma once

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace grainfield::bench {

/// One point of a plot: plot,series,x,y. What cannot be drawn (inf, nan) is printed as such.
inline void print_row(std::string_view plot, std::string_view series, double x, double y) {
    fmt::print("{},{},{:.9g},{:.9g}\n", plot, series, x, y);
    std::fflush(stdout);
}

/// A plot and what measures it.
struct StabilityPlot {
    std::string name;
    std::function<void()> measure;
};

/// Measures the plots named by the arguments of the program, or all of them.
inline int print_plots(int argc, char** argv, const std::vector<StabilityPlot>& plots) {
    fmt::print("plot,series,x,y\n");
    for (const StabilityPlot& plot : plots) {
        const auto is_asked = [&](const char* name) { return plot.name == name; };
        if (argc == 1 || std::any_of(argv + 1, argv + argc, is_asked)) plot.measure();
    }
    return 0;
}

}  // namespace grainfield::bench
