// Tables of `albedo --over` and `brdf --stokes`.
#pragma once

#include <miebrdf/brdf.h>

#include "tools/miebrdf/command.h"
#include "tools/miebrdf/reflection_options.h"

namespace miebrdf::program {

/// A film over a dark and a light ground: writes spectra over both with their ratio, or with
/// --colour colours, contrast ratio and hiding power. @return the exit code
int write_drawdown(const AlbedoQuestion& question, const Shell& shell);

/// Writes the Mueller matrix of a scene.
/// @throws UsageError  for what goes with intensities alone: components, colours, hdrf
int write_mueller(const Brdf& brdf, const BrdfQuestion& question, const Shell& shell);

}  // namespace miebrdf::program
