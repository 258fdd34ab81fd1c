#pragma once

namespace grainfield::simulate {

/// Unpolarised reflectance of a metal of index n + ik at the angle of incidence acos(cosine):
///
///   R = (R_s + R_p)/2,  a² + b² = |(n + ik)² − sin²θ|,  2 a² = a² + b² + n² − k² − sin²θ,
///   R_s = (a² + b² − 2 a c + c²)/(a² + b² + 2 a c + c²),  c = cos θ,
///   R_p = R_s (c² (a² + b²) − 2 a c s² + s⁴)/(c² (a² + b²) + 2 a c s² + s⁴),  s = sin θ.
///
/// (`born1999`, chapter 14.) Defaults: iron at 590 nm, about the n and k of `johnson1974`; R(0) =
/// 0.56.
double metal_reflectance(double cosine, double n = 2.87, double k = 3.36);

/// Reflectance of a mirror that reflects the share `straight` of light that meets it straight on:
///
///   R = R_0 + (1 − R_0)(1 − cos θ)⁵
///
/// (`schlick1994`, eq. 15): Fresnel's equations for a mirror of which only R_0 is known.
double schlick_reflectance(double cosine, double straight);

/// Share of unpolarised light that a glass plate reflects, both faces and all inner reflections
/// added without interference: 2 r/(1 + r) averaged over the polarisations, r of one face. The rest
/// passes.
double plate_reflectance(double cosine, double index = 1.52);

}  // namespace grainfield::simulate
