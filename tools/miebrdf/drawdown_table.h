// `albedo --over`: a film over a dark and a light ground.
#pragma once

#include "tools/miebrdf/command.h"
#include "tools/miebrdf/reflection_options.h"

namespace miebrdf::program {

/// Writes spectra over both grounds with their ratio, or with --colour colours, contrast ratio and
/// hiding power. @return the exit code
int write_drawdown(const AlbedoQuestion& question, const Shell& shell);

}  // namespace miebrdf::program
