#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/option_table.h"
#include "core/run_identity.h"

namespace grainfield::simulate {

/// The periodic lattice. A line (dimension 1) has ny = 1.
struct LatticeOptions {
    int dimension = 2;
    int nx = 256;
    int ny = 0;             ///< 0: as nx (dimension 2), 1 (dimension 1)
    double spacing = 0.65;  ///< δx [model length]
};

/// How diffusion slows where the order field is large; all have D = D0 (1 − λψ² + …) and D → 0.
enum class DiffusivityForm {
    exponential,  ///< D0 exp(−λψ²) (`castillo2019`)
    lorentzian,   ///< D0 / (1 + λψ²)
    sech          ///< D0 / cosh²(√λ ψ)
};

/// ∂tψ = −(ν + μ(−∇²)^{b/2})ψ + ξ, ∂tρ = ∇·(D(ψ)∇ρ + η), ⟨ξξ⟩ = C2 δδ, ⟨η_iη_k⟩ = C1 δ_ik δδ.
struct ModelOptions {
    double nu = 0.01;  ///< ν, distance to the critical point
    int b = 4;         ///< order of the gradient term, even
    double mu = 1;
    double lambda = 1;
    double c1 = 1;
    double c2 = 1;
    double d0 = 1;  ///< not in the paper, which has 1
    DiffusivityForm form = DiffusivityForm::exponential;
};

enum class SchemeChoice { automatic, lod, explicit_lm, paper, adjoint };
enum class Precision { automatic, single, twofold };
enum class NoiseShape { automatic, uniform, normal };

struct SchemeOptions {
    SchemeChoice scheme = SchemeChoice::automatic;
    double dt = 0.5;  ///< time step
    Precision precision = Precision::automatic;
    NoiseShape noise = NoiseShape::automatic;  ///< of the density
    double tolerance = 0.005;                  ///< relative bias of S(k) that skips may cause
    std::optional<double> k_cut{};             ///< ψ has no modes above; auto: from the tolerance
    int hold = 0;  ///< steps for which one ψ serves; 0: from the tolerance
    std::vector<int> waves{1, 2, 3, 4, 6, 8};  ///< adjoint: k = 2π n/Lx, along x and y
};

struct RecordOptions {
    double relax = 1000;    ///< time before recording
    double record = 10000;  ///< time of recording
    double sample = 5;      ///< between samples of S(k)
    double store = 0;       ///< between stored fields, 0: none but the last
    int replicas = 1;       ///< densities that share one ψ
};

struct FieldOptions {
    LatticeOptions lattice;
    ModelOptions model;
    SchemeOptions scheme;
    RecordOptions record;
    std::uint64_t seed = 1;
    int threads = 1;
};

/// Sections lattice, model, scheme, record.
std::vector<OptionTable> describe(FieldOptions& options);

/// What a run of the model is: dimension, b and ν.
RunIdentity identity_of(const FieldOptions& options);

}  // namespace grainfield::simulate
