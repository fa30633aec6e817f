// Sweeps as job arrays of Slurm.
#pragma once

#include <cstddef>
#include <string>

namespace miebrdf::sweep {

/// A script for sbatch: one task for each share of the sweep, `--part I/N` of all. Its comments say
/// how to submit it so that a last job merges the parts.
/// @param sweep_file, table  as typed
std::string slurm_script(const std::string& sweep_file, const std::string& table,
                         std::size_t parts);

}  // namespace miebrdf::sweep
