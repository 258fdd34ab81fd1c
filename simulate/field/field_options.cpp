#include "simulate/field/field_options.h"

namespace grainfield::simulate {

namespace {

constexpr double largest = 1e12;

OptionTable describe(LatticeOptions& o) {
    OptionTable table("lattice");
    table.integer("dimension", o.dimension, "-", {1, 2}, "1: a line, 2: a plane");
    table.integer("nx", o.nx, "-", {1, 1 << 24}, "cells along x");
    table.integer("ny", o.ny, "-", {0, 1 << 24}, "cells along y, 0: as many as along x");
    table.number("spacing", o.spacing, "l", {1e-6, 1e6}, "lattice constant dx");
    return table;
}

OptionTable describe(ModelOptions& o) {
    OptionTable table("model");
    table.number("nu", o.nu, "1/t", {0, largest}, "distance nu to the critical point");
    table.integer("b", o.b, "-", {2, 16}, "order of the gradient term, even");
    table.number("mu", o.mu, "l^b/t", {0, largest}, "stiffness mu of the order field");
    table.number("lambda", o.lambda, "-", {0, largest}, "how strongly order slows diffusion");
    table.number("c1", o.c1, "-", {0, largest}, "strength C1 of the density noise");
    table.number("c2", o.c2, "-", {0, largest}, "strength C2 of the order noise");
    table.number("d0", o.d0, "l^2/t", {0, largest}, "diffusivity without order");
    table.choice("form", o.form,
                 {{"exponential", DiffusivityForm::exponential},
                  {"lorentzian", DiffusivityForm::lorentzian},
                  {"sech", DiffusivityForm::sech}},
                 "D(psi): D0 exp(-lambda psi^2), D0/(1 + lambda psi^2), "
                 "D0/cosh^2(sqrt(lambda) psi)");
    return table;
}

OptionTable describe(SchemeOptions& o) {
    OptionTable table("scheme");
    table.choice("scheme", o.scheme,
                 {{"auto", SchemeChoice::automatic},
                  {"lod", SchemeChoice::lod},
                  {"explicit", SchemeChoice::explicit_lm},
                  {"paper", SchemeChoice::paper},
                  {"adjoint", SchemeChoice::adjoint}},
                 "lod: implicit, any step; explicit: Leimkuhler-Matthews, small steps; paper: as "
                 "published; adjoint: S(k) of a few k without density noise; auto: explicit below "
                 "its bound, else lod");
    table.number("dt", o.dt, "t", {1e-12, 1e6}, "time step");
    table.choice("precision", o.precision,
                 {{"auto", Precision::automatic},
                  {"single", Precision::single},
                  {"double", Precision::twofold}},
                 "auto: single unless the tolerance is below 1e-4");
    table.choice("noise", o.noise,
                 {{"auto", NoiseShape::automatic},
                  {"uniform", NoiseShape::uniform},
                  {"gaussian", NoiseShape::normal}},
                 "of the density; auto: uniform unless fields are stored");
    table.number("tolerance", o.tolerance, "-", {0, 1},
                 "relative bias of S(k) that skips may cause");
    table.number("k-cut", o.k_cut, "1/l", {0, largest},
                 "the order field has no modes above; auto: from the tolerance");
    table.integer("hold", o.hold, "-", {0, 1 << 20},
                  "steps for which one order field serves; 0: from the tolerance");
    table.integers("waves", o.waves, "-", {1, 1e6},
                   "adjoint: multiples n of the smallest wavevector, as 1,2,4");
    return table;
}

OptionTable describe(RecordOptions& o) {
    OptionTable table("record");
    table.number("relax", o.relax, "t", {0, largest}, "time before recording");
    table.number("record", o.record, "t", {0, largest}, "time of recording");
    table.affects(Effect::extent);
    table.number("sample", o.sample, "t", {1e-12, largest}, "time between samples of S(k)");
    table.number("store", o.store, "t", {0, largest},
                 "time between stored fields, 0: only the last");
    table.integer("replicas", o.replicas, "-", {1, 255}, "densities that share one order field");
    return table;
}

}  // namespace

std::vector<OptionTable> describe(FieldOptions& options) {
    return {describe(options.lattice), describe(options.model), describe(options.scheme),
            describe(options.record)};
}

RunIdentity identity_of(const FieldOptions& options) {
    return {.origin = Origin::field,
            .control = ControlValue{.parameter = ControlParameter::critical_distance,
                                    .value = options.model.nu},
            .dimension = options.lattice.dimension,
            .gradient_order = options.model.b};
}

}  // namespace grainfield::simulate
