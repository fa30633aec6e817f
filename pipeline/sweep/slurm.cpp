#include "pipeline/sweep/slurm.h"

#include <fmt/format.h>

#include <filesystem>

#include "materials/readers/text.h"

namespace miebrdf::sweep {
std::string slurm_script(const std::string& sweep_file, const std::string& table,
                         std::size_t parts) {
    const std::string stem = std::filesystem::path(table).stem().string();
    // A job that fails or is ended by its time limit loses one chunk: submitted again, it goes on.
    return fmt::format(R"(#!/bin/bash
# A sweep of miebrdf in {parts} parts. Submit it, and a job that merges them when all are done:
#   job=$(sbatch --parsable THIS)
#   sbatch --array=1 --dependency=afterok:$job THIS merge
# Submitted again after a failure or a time limit, it computes what is missing. Set the partition,
# time and processors of your cluster here; the folder of the table must be seen by all nodes.
#SBATCH --job-name={name}
#SBATCH --array=1-{parts}
#SBATCH --nodes=1
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=4
#SBATCH --time=12:00:00
#SBATCH --output=%x-%A_%a.log
set -eu
sweep={sweep}
table={table}
if [ "${{1:-}}" = merge ]; then
    exec miebrdf sweep "$sweep" -o "$table" --merge --threads "${{SLURM_CPUS_PER_TASK:-1}}"
fi
exec miebrdf sweep "$sweep" -o "$table" --part "$SLURM_ARRAY_TASK_ID/{parts}" \
    --threads "${{SLURM_CPUS_PER_TASK:-1}}"
)",
                       fmt::arg("parts", parts),
                       fmt::arg("name", materials::shell_quoted("sweep-" + stem)),
                       fmt::arg("sweep", materials::shell_quoted(sweep_file)),
                       fmt::arg("table", materials::shell_quoted(table)));
}

}  // namespace miebrdf::sweep
