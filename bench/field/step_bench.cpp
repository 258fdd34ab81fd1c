// Time of a step of each scheme, 512 x 512, b = 4, nu = 0.01, and of a line of 4,096 nodes: medians
// of short repetitions taken in turn, so that a change of the machine's load meets all alike.
//   bench.field.step [repetitions = 9]
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>

#include "bench/field/plain_paper_scheme.h"
#include "simulate/field/integrators/integrator_choice.h"

using namespace grainfield;
using namespace grainfield::simulate;

namespace {

struct Row {
    std::string name;
    std::function<void(int)> advance;
    int steps = 1;
    std::vector<double> ms;
};

Row row(const std::string& name, FieldScheme scheme, bool twofold, int threads, double dt,
        double k_cut, int hold, NoiseShape noise) {
    FieldSetup setup;
    setup.lattice = {2, 512, 512, 0.65};
    setup.scheme = scheme;
    setup.twofold = twofold;
    setup.dt = dt;
    setup.k_cut = k_cut;
    setup.hold = hold;
    setup.noise = noise;
    const std::shared_ptr<FieldIntegrator> fields = make_integrator(setup, threads);
    return {fmt::format("{:<42} {:<6} {}", name, twofold ? "double" : "float", threads),
            [fields](int steps) { fields->advance(steps); },
            12,
            {}};
}

Row line_row(bool twofold) {
    FieldSetup setup;
    setup.lattice = {1, 4096, 1, 0.25};
    setup.scheme = FieldScheme::lod;
    setup.twofold = twofold;
    setup.dt = 0.5;
    setup.k_cut = 1e9;
    const std::shared_ptr<FieldIntegrator> fields = make_integrator(setup, 1);
    return {fmt::format("{:<42} {:<6} {}", "line of 4096, LOD, all modes",
                        twofold ? "double" : "float", 1),
            [fields](int steps) { fields->advance(steps); },
            400,
            {}};
}

}  // namespace

int main(int argc, char** argv) {
    const int repetitions = argc > 1 ? std::atoi(argv[1]) : 9;
    constexpr double all = 1e9;
    std::vector<Row> rows;
    for (const bool twofold : {false, true}) {
        for (const int threads : {1, 2}) {
            rows.push_back(row("LM, k_cut 2.05", FieldScheme::explicit_lm, twofold, threads, 0.05,
                               2.05, 1, NoiseShape::uniform));
            rows.push_back(row("LOD, k_cut 2.05", FieldScheme::lod, twofold, threads, 0.5, 2.05, 1,
                               NoiseShape::uniform));
            rows.push_back(row("paper", FieldScheme::paper, twofold, threads, 0.05, all, 1,
                               NoiseShape::uniform));
        }
        rows.push_back(row("LM, hold 5", FieldScheme::explicit_lm, twofold, 1, 0.05, 2.05, 5,
                           NoiseShape::uniform));
        rows.push_back(row("LM, all modes", FieldScheme::explicit_lm, twofold, 1, 0.05, all, 1,
                           NoiseShape::uniform));
        rows.push_back(row("LM, all modes, Gaussian noise", FieldScheme::explicit_lm, twofold, 1,
                           0.05, all, 1, NoiseShape::normal));
        rows.push_back(
            row("LOD, all modes", FieldScheme::lod, twofold, 1, 0.5, all, 1, NoiseShape::uniform));
        rows.push_back(row("LOD, all modes, Gaussian noise", FieldScheme::lod, twofold, 1, 0.5, all,
                           1, NoiseShape::normal));
        rows.push_back(line_row(twofold));
    }
    const auto plain = std::make_shared<bench::PlainPaperScheme>(512, 0.65, 0.05, 0.01);
    rows.push_back({fmt::format("{:<42} {:<6} {}", "paper, plain C++, std::normal", "double", 1),
                    [plain](int steps) {
                        for (int i = 0; i < steps; ++i) plain->step();
                    },
                    3,
                    {}});
    for (int r = -1; r < repetitions; ++r) {
        for (Row& one : rows) {
            const auto start = std::chrono::steady_clock::now();
            one.advance(one.steps);
            const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
            if (r >= 0) one.ms.push_back(1e3 * took.count() / one.steps);
        }
    }
    fmt::print("{:<42} {:<6} {}  {:>8} {:>8}\n", "scheme", "", "thr.", "median", "least");
    for (Row& one : rows) {
        std::sort(one.ms.begin(), one.ms.end());
        fmt::print("{}  {:8.3f} {:8.3f} ms\n", one.name, one.ms[one.ms.size() / 2], one.ms.front());
    }
}
