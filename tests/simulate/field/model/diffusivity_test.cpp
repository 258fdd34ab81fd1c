#include "simulate/field/model/diffusivity.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace grainfield::simulate {
namespace {

constexpr DiffusivityForm forms[] = {DiffusivityForm::exponential, DiffusivityForm::lorentzian,
                                     DiffusivityForm::sech};

TEST(Diffusivity, VectorsAgreeWithTheFormula) {
    for (const DiffusivityForm form : forms) {
        const DiffusivityLaw law{form, 1.7, 0.6};
        std::vector<double> psi;
        for (int i = -100; i <= 101; ++i) psi.push_back(0.07 * i);
        std::vector<float> narrow(psi.begin(), psi.end());
        std::vector<double> wide = psi;
        diffusivities(law, psi.data(), wide.data(), psi.size());
        diffusivities(law, narrow.data(), narrow.data(), narrow.size());
        for (std::size_t i = 0; i < psi.size(); ++i) {
            EXPECT_NEAR(wide[i], law(psi[i]), 4e-16 * (1 + 1e3 * law(psi[i])));
            EXPECT_NEAR(narrow[i], law(psi[i]), 1e-5 * law(psi[i]) + 1e-9);
        }
    }
}

TEST(Diffusivity, AllFormsAreD0AtZeroOrderWithTheSameSlope) {
    for (const DiffusivityForm form : forms) {
        const DiffusivityLaw law{form, 2, 3};
        EXPECT_DOUBLE_EQ(law(0), 2);
        EXPECT_NEAR((law(1e-3) - 2) / 1e-6, -6, 1e-3);
        EXPECT_LT(law(100), 1e-3);
        EXPECT_GE(law(100), 0);
    }
}

TEST(Diffusivity, UnderflowIsZero) {
    const DiffusivityLaw law{DiffusivityForm::exponential, 1, 1};
    for (const double square : {700.0, 800.0, 1e6, 1e30}) {
        double wide = std::sqrt(square);
        auto narrow = static_cast<float>(wide);
        diffusivities(law, &wide, &wide, 1);
        diffusivities(law, &narrow, &narrow, 1);
        EXPECT_EQ(narrow, 0.0F) << square;
        EXPECT_GE(wide, 0.0);
        EXPECT_LT(wide, 1e-300);
    }
}

// ∫ exp(−λ(ψ + χ)²) over a Gaussian χ of variance v, by the trapezoidal rule (spectrally exact).
TEST(Diffusivity, MissingModesAreAveragedOver) {
    ModelOptions model;
    model.lambda = 1.3;
    const double v = 0.21;
    const DiffusivityLaw law = DiffusivityLaw::of(model, v);
    for (const double psi : {0.0, 0.4, 1.9}) {
        double sum = 0;
        const double step = 0.01;
        for (int i = -1000; i <= 1000; ++i) {
            const double chi = i * step;
            sum += step *
                   std::exp(-model.lambda * (psi + chi) * (psi + chi) - chi * chi / (2 * v)) /
                   std::sqrt(2 * std::numbers::pi * v);
        }
        EXPECT_NEAR(law(psi), sum, 1e-12);
    }
}

}  // namespace
}  // namespace grainfield::simulate
