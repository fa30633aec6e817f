#include "pipeline/sweep/crew.h"

#include <miebrdf/error.h>

#include <algorithm>
#include <cstdlib>

#include "pipeline/cache/job_key.h"
#include "pipeline/sweep/layout.h"
#include "pipeline/sweep/run.h"

namespace miebrdf::sweep {
namespace {

/// Enough of a hash to tell launches apart.
constexpr std::size_t kLaunchLength = 12;

using Variables = std::function<const char*(const char*)>;

std::optional<std::size_t> number_in(const Variables& variable, const char* name) {
    const char* text = variable(name);
    if (text == nullptr || *text == '\0') return std::nullopt;
    char* end = nullptr;
    const unsigned long long number = std::strtoull(text, &end, 10);
    if (*end != '\0') return std::nullopt;
    return std::size_t(number);
}

std::optional<Crew> crew_of(const Variables& variable, const char* rank, const char* size,
                            std::initializer_list<const char*> launch) {
    const auto number = number_in(variable, rank), count = number_in(variable, size);
    if (!number || !count || *count < 2 || *number >= *count) return std::nullopt;
    JobKey key("launch");
    for (const char* name : launch) {
        const char* value = variable(name);
        key.add(value == nullptr ? "" : value);
    }
    return Crew{key.hash().substr(0, kLaunchLength), *number, *count};
}

}  // namespace

std::optional<Crew> crew_of_environment(const Variables& variable) {
    if (const auto crew =
            crew_of(variable, "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE",
                    {"PMIX_NAMESPACE", "OMPI_MCA_ess_base_jobid", "OMPI_MCA_orte_hnp_uri"}))
        return crew;
    return crew_of(variable, "SLURM_PROCID", "SLURM_NTASKS",
                   {"SLURM_JOB_ID", "SLURM_STEP_ID", "SLURM_RESTART_COUNT"});
}

RunReport run_crew(const Sweep& sweep, const Layout& layout, const Parts& parts, const Crew& crew,
                   const std::function<bool()>& is_complete, const Control& control) {
    ChunkWorker worker(sweep, layout, parts, Company::with_others, control);
    RunReport report;
    const std::size_t count = parts.chunks().size();
    // Chunks that follow each other share Mie theory: each process goes on from where it began.
    const std::size_t start = crew.number * count / crew.size;
    for (std::size_t i = 0; i < count; ++i) {
        if (control.is_cancelled && control.is_cancelled()) throw Cancelled();
        const Chunk chunk = parts.chunks()[(start + i) % count];
        try {
            if (!parts.take(chunk, crew.launch)) continue;
            if (is_complete()) return report;
            ++report.chunks;
            if (parts.read(chunk)) {
                ++report.found;
            } else {
                worker.compute(chunk, report);
            }
        } catch (const InputError&) {
            // Number 0 has seen all chunks, written the table and removed the folder.
            if (crew.number != 0 && is_complete()) return report;
            throw;
        }
    }
    for (std::size_t number = count; crew.number == 0 && number-- > 0;) {
        const Chunk chunk = parts.chunks()[number];
        const auto before = parts.time_of(chunk);
        if (parts.read(chunk)) continue;
        worker.compute_unless(chunk, report,
                              [&] { return parts.time_of(chunk) != before && parts.read(chunk); });
    }
    return report;
}

}  // namespace miebrdf::sweep
