#include "simulate/field/integrators/integrator_choice.h"

#include "simulate/field/integrators/explicit_integrator.h"
#include "simulate/field/integrators/lod_integrator.h"
#include "simulate/field/integrators/paper_integrator.h"

namespace grainfield::simulate {

namespace {

template <class Real>
std::unique_ptr<FieldIntegrator> make(const FieldSetup& setup, int threads) {
    switch (setup.scheme) {
        case FieldScheme::explicit_lm:
            return std::make_unique<ExplicitIntegrator<Real>>(setup, threads);
        case FieldScheme::paper:
            return std::make_unique<PaperIntegrator<Real>>(setup, threads);
        case FieldScheme::lod:
            break;
    }
    return std::make_unique<LodIntegrator<Real>>(setup, threads);
}

}  // namespace

std::unique_ptr<FieldIntegrator> make_integrator(const FieldSetup& setup, int threads) {
    return setup.twofold ? make<double>(setup, threads) : make<float>(setup, threads);
}

}  // namespace grainfield::simulate
