// What averages over spheres amount to in radiative transfer, and what differences of them do.
#pragma once

#include <miebrdf/ensemble.h>

namespace miebrdf::mie {

/// Largest of the relative changes of extinction and albedo and the absolute ones of asymmetry and
/// moments.
double largest_change(const EnsembleOptics& a, const EnsembleOptics& b);

/// What the change of the absorption does to the albedo of a half-space; 0 without absorption.
/// A half-space of similar spheres has an albedo A with 1 - A about
/// sqrt(6 (1 - omega) / (1 - omega g)): d(1 - A) = (1 - A)/2 d ln(1 - omega), at most 0.15.
double change_by_absorption(const EnsembleOptics& a, const EnsembleOptics& b);

/// Spherical albedo of a half-space, by similarity (van de Hulst 1980, table 25).
double half_space_albedo(const EnsembleOptics& optics);

}  // namespace miebrdf::mie
