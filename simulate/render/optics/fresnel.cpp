#include "simulate/render/optics/fresnel.h"

#include <algorithm>
#include <cmath>

namespace grainfield::simulate {

double metal_reflectance(double cosine, double n, double k) {
    const double c = std::clamp(cosine, 0.0, 1.0);
    const double s2 = 1 - c * c;
    const double difference = n * n - k * k - s2;
    const double sum = std::sqrt(difference * difference + 4 * n * n * k * k);  // a² + b²
    const double a = std::sqrt(std::max(0.0, 0.5 * (sum + difference)));
    const double r_s = (sum - 2 * a * c + c * c) / (sum + 2 * a * c + c * c);
    const double r_p =
        r_s * (c * c * sum - 2 * a * c * s2 + s2 * s2) / (c * c * sum + 2 * a * c * s2 + s2 * s2);
    return 0.5 * (r_s + r_p);
}

double schlick_reflectance(double cosine, double straight) {
    return straight + (1 - straight) * std::pow(1 - std::clamp(cosine, 0.0, 1.0), 5);
}

double plate_reflectance(double cosine, double index) {
    const double c = std::clamp(cosine, 0.0, 1.0);
    const double inside = std::sqrt(1 - (1 - c * c) / (index * index));
    const double s = (c - index * inside) / (c + index * inside);
    const double p = (index * c - inside) / (index * c + inside);
    const double r_s = s * s;
    const double r_p = p * p;
    return r_s / (1 + r_s) + r_p / (1 + r_p);
}

}  // namespace grainfield::simulate
