// How far two results for one ensemble, from fewer and more sizes, lie apart.
#pragma once

#include "mie/ensemble/ensemble.h"

namespace miebrdf::mie {

/// Largest of the relative changes of extinction and albedo and the absolute ones of asymmetry and
/// moments.
double largest_change(const EnsembleOptics& before, const EnsembleOptics& after);

/// What the change of the absorption does to the albedo of a half-space; 0 without absorption.
double change_by_absorption(const EnsembleOptics& before, const EnsembleOptics& after);

/// Largest relative change of the phase function at the angles asked for; 0 without angles.
double phase_change(const EnsembleOptics& before, const EnsembleOptics& after);

}  // namespace miebrdf::mie
