// Bias of S(k) against CPU time for every scheme and step, on the same paths of psi: the adjoint of
// the LOD scheme (no density noise) with psi carried through in steps of 0.05, whatever dt.
//   bench.field.error [nu = 0.01] [cells = 128] [time = 400] [seed = 1]
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>

#include "simulate/field/adjoint.h"

using namespace grainfield::simulate;

int main(int argc, char** argv) {
    const auto number = [&](int i, double otherwise) {
        return argc > i ? std::atof(argv[i]) : otherwise;
    };
    const double nu = number(1, 0.01);
    const int cells = static_cast<int>(number(2, 128));
    const double time = number(3, 400);
    constexpr double fine = 0.05;
    constexpr double all = 1e9;
    struct Case {
        double dt, k_cut;
        int hold;
    };
    std::vector<double> reference;
    fmt::print(
        "# nu {} cells {} time {}: dt k_cut hold ms_per_unit_time, then bias in % at each k\n", nu,
        cells, time);
    for (const Case& c : {Case{fine, all, 1},
                          {fine, 2.4, 1},
                          {fine, 2.05, 1},
                          {fine, 1.5, 1},
                          {fine, all, 2},
                          {fine, all, 4},
                          {fine, all, 10},
                          {0.1, all, 1},
                          {0.2, all, 1},
                          {0.5, all, 1},
                          {0.5, 2.05, 1},
                          {1, all, 1},
                          {2, all, 1},
                          {4, all, 1}}) {
        FieldSetup setup;
        setup.lattice = {2, cells, cells, 0.65};
        setup.dt = c.dt;
        setup.model.nu = nu;
        setup.k_cut = c.k_cut;
        setup.hold = c.hold;
        setup.substeps = static_cast<int>(std::lround(c.dt * c.hold / fine));
        setup.twofold = true;
        setup.seed = static_cast<std::uint64_t>(number(4, 1));
        const int unit = std::max(1, cells / 64);  // k = 0.151 for cells a multiple of 64
        std::vector<LatticeWave> waves{{unit, 0},      {0, unit},     {2 * unit, 0},
                                       {0, 2 * unit},  {8 * unit, 0}, {0, 8 * unit},
                                       {16 * unit, 0}, {0, 16 * unit}};
        AdjointEstimator adjoint(setup, waves, 1, 0);
        adjoint.advance(std::lround(time / c.dt));
        // What a step of the direct simulation of this setting costs.
        FieldSetup direct = setup;
        direct.substeps = 1;
        direct.twofold = false;
        const auto fields = make_integrator(direct, 1);
        fields->advance(10);
        const auto start = std::chrono::steady_clock::now();
        fields->advance(40);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        fmt::print("{:5g} {:8g} {:3d} {:9.3f}", c.dt, c.k_cut, c.hold,
                   1e3 * took.count() / 40 / c.dt);
        const bool first = reference.empty();
        for (std::size_t w = 0; w < waves.size(); w += 2) {
            const double s = (adjoint.under_way(w) + adjoint.under_way(w + 1)) / 2;
            if (first) reference.push_back(s);
            fmt::print("  k={:.2f} {:+.3f}", adjoint.wavenumber(w),
                       100 * (s / reference[w / 2] - 1));
        }
        fmt::print("\n");
    }
}
