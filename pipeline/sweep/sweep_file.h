// Sweep files: TOML with a scene, axes and outputs (docs/sweeps.md).
#pragma once

#include <string>

#include "pipeline/sweep/sweep.h"

namespace miebrdf::sweep {

/// Reads a whole file and checks it; materials are looked up, nothing is computed. The dimensions
/// are in the order in which the scenes are computed (order_for_sharing).
/// @throws UsageError  with file, line and column: unknown keys, words and axes, axes that nothing
///         uses, bad ranges, outputs without their axes, values that no scene can have
/// @throws InputError  the same: no TOML, values of the wrong kind, files that cannot be read
Sweep read_sweep_file(const std::string& path);

}  // namespace miebrdf::sweep
