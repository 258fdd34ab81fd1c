#include "simulate/field/model/diffusivity.h"

#include <cmath>

// The order of these matters.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulate/field/model/diffusivity.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace grainfield::simulate::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D, class V>
HWY_INLINE V apply(D d, DiffusivityForm form, V psi, V lambda, V d0) {
    const V x = hn::Mul(lambda, hn::Mul(psi, psi));
    const V one = hn::Set(d, hn::TFromD<D>{1});
    switch (form) {
        case DiffusivityForm::exponential:
            return hn::Mul(d0, hn::Exp(d, hn::Neg(x)));
        case DiffusivityForm::lorentzian:
            return hn::Div(d0, hn::Add(one, x));
        case DiffusivityForm::sech:
            break;
    }
    // 1/cosh²(y) = 4 e/(1 + e)², e = exp(−2|y|)
    const V e = hn::Exp(d, hn::Mul(hn::Set(d, hn::TFromD<D>{-2}), hn::Sqrt(x)));
    const V u = hn::Add(one, e);
    return hn::Div(hn::Mul(d0, hn::Mul(hn::Set(d, hn::TFromD<D>{4}), e)), hn::Mul(u, u));
}

template <class Real>
HWY_INLINE void fill(const DiffusivityLaw& law, const Real* psi, Real* out, std::size_t count) {
    const hn::ScalableTag<Real> d;
    const auto lambda = hn::Set(d, static_cast<Real>(law.lambda));
    const auto d0 = hn::Set(d, static_cast<Real>(law.d0));
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
        hn::StoreU(apply(d, law.form, hn::LoadU(d, psi + i), lambda, d0), d, out + i);
    }
    if (i == count) return;
    Real last[hn::MaxLanes(hn::ScalableTag<Real>())] = {};
    for (std::size_t j = 0; i + j < count; ++j) last[j] = psi[i + j];
    hn::StoreU(apply(d, law.form, hn::LoadU(d, last), lambda, d0), d, last);
    for (std::size_t j = 0; i + j < count; ++j) out[i + j] = last[j];
}

void fill_float(const DiffusivityLaw& law, const float* psi, float* out, std::size_t count) {
    fill<float>(law, psi, out, count);
}
void fill_double(const DiffusivityLaw& law, const double* psi, double* out, std::size_t count) {
    fill<double>(law, psi, out, count);
}

}  // namespace grainfield::simulate::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::simulate {

HWY_EXPORT(fill_float);
HWY_EXPORT(fill_double);

DiffusivityLaw DiffusivityLaw::of(const ModelOptions& model, double missing_variance) {
    DiffusivityLaw law{model.form, model.d0, model.lambda};
    if (model.form == DiffusivityForm::exponential) {
        const double widening = 1 + 2 * model.lambda * missing_variance;
        law.d0 /= std::sqrt(widening);
        law.lambda /= widening;
    }
    return law;
}

double DiffusivityLaw::operator()(double psi) const {
    const double x = lambda * psi * psi;
    switch (form) {
        case DiffusivityForm::exponential:
            return d0 * std::exp(-x);
        case DiffusivityForm::lorentzian:
            return d0 / (1 + x);
        case DiffusivityForm::sech:
            break;
    }
    const double e = std::exp(-2 * std::sqrt(x));
    return d0 * 4 * e / ((1 + e) * (1 + e));
}

template <>
void diffusivities(const DiffusivityLaw& law, const float* psi, float* out, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(fill_float)(law, psi, out, count);
}
template <>
void diffusivities(const DiffusivityLaw& law, const double* psi, double* out, std::size_t count) {
    HWY_DYNAMIC_DISPATCH(fill_double)(law, psi, out, count);
}

}  // namespace grainfield::simulate
#endif
