// The Mueller matrix of a scene as a table: miebrdf brdf --stokes 3, --stokes 4.
#pragma once

#include <miebrdf/brdf.h>

#include "tools/miebrdf/command.h"
#include "tools/miebrdf/reflection_options.h"

namespace miebrdf::program {

/// @throws UsageError  for what goes with intensities alone: components, colours, hdrf
int write_mueller(const Brdf& brdf, const BrdfQuestion& question, const Shell& shell);

}  // namespace miebrdf::program
