#include "analysis/spectra/spectrum_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

}  // namespace

SpectrumModel SpectrumModel::of_fit(const Line& fit, Tail tail) {
    SpectrumModel model;
    model.fit_ = fit;
    model.theta_ = {fit.s0, fit.s1};
    model.error_ = {fit.s0_error, fit.s1_error};
    const double left = 1 - fit.s0;
    // A fit that falls, or starts above one, is not continued beyond its range.
    model.k_max_ = fit.s1 > 0 && left > 0 ? std::pow(left / fit.s1, 1 / fit.alpha) : fit.k_end;
    if (tail == Tail::constant) {
        model.k_max_ = fit.k_end;
        model.tail_ = fit.s0 + fit.s1 * std::pow(fit.k_end, fit.alpha);
    }
    model.fit_->k_end = model.k_max_;
    model.corners_ = {0, model.k_max_};
    return model;
}

SpectrumModel SpectrumModel::of_measured(const Spectrum& spectrum, const std::optional<Line>& fit,
                                         Tail tail) {
    SpectrumModel model;
    model.fit_ = fit;
    if (fit) {
        model.theta_ = {fit->s0, fit->s1};
        model.error_ = {fit->s0_error, fit->s1_error};
    }
    model.corners_ = {0};
    if (fit) model.corners_.push_back(fit->k_end);
    model.k_max_ = model.corners_.back();
    for (std::size_t i = 0; i < spectrum.k.size(); ++i) {
        const double k = spectrum.k[i];
        if (!std::isfinite(spectrum.s[i]) || (fit && k <= fit->k_end)) continue;
        const double dof = i < spectrum.dof.size() ? spectrum.dof[i] : 0;
        double error = i < spectrum.error.size() ? spectrum.error[i] : undefined;
        if (!std::isfinite(error)) error = std::abs(spectrum.s[i]) / std::sqrt(dof);
        if (!std::isfinite(error)) continue;
        model.k_.push_back(k);
        model.theta_.push_back(spectrum.s[i]);
        model.error_.push_back(error);
        model.corners_.push_back(k);
        model.k_max_ = k;
    }
    if (tail == Tail::constant) model.tail_ = model.value(model.k_max_);
    return model;
}

std::array<SpectrumModel::Share, 2> SpectrumModel::shares(double k) const {
    if (fit_ && k <= fit_->k_end) return {Share{0, 1}, Share{1, std::pow(k, fit_->alpha)}};
    if (k > k_max_ || k_.empty()) return {};
    const std::size_t first = fit_ ? 2 : 0;
    const auto above = static_cast<std::size_t>(std::ranges::lower_bound(k_, k) - k_.begin());
    // Between the end of the fit and the first shell: the shell.
    if (above == 0) return {Share{first, 1}, Share{first, 0}};
    const double t = (k - k_[above - 1]) / (k_[above] - k_[above - 1]);
    return {Share{first + above - 1, 1 - t}, Share{first + above, t}};
}

double SpectrumModel::value(double k) const {
    if (k > k_max_) return tail_;
    double s = 0;
    for (const Share& share : shares(k)) {
        if (share.weight != 0) s += share.weight * theta_[share.parameter];
    }
    return s;
}

double SpectrumModel::variance(const std::vector<double>& jacobian) const {
    double variance = 0;
    for (std::size_t p = 0; p < error_.size(); ++p) {
        if (jacobian[p] != 0) variance += std::pow(jacobian[p] * error_[p], 2);
    }
    if (fit_ && jacobian[0] != 0 && jacobian[1] != 0) {
        variance += 2 * fit_->correlation * jacobian[0] * error_[0] * jacobian[1] * error_[1];
    }
    return variance < 0 ? 0 : variance;  // NaN stays: std::max would make it zero
}

}  // namespace grainfield::analysis
