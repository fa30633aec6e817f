// Processes that one launcher started to work on a sweep together, such as `mpirun -n 4`.
//
// They share the folder of parts and nothing else: who is free takes the next chunk by making a
// file that only one process can make. So there is no message to pass and no library of MPI to link
// or to agree with, and a process that dies takes one chunk with it, not the sweep.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace miebrdf {
struct Control;
}

namespace miebrdf::sweep {

class Parts;
struct Layout;
struct RunReport;
struct Sweep;

struct Crew {
    std::string launch;      ///< names this start: the same for all of them, another one next time
    std::size_t number = 0;  ///< of this process, from 0; that one writes the table
    std::size_t size = 1;
};

/// From the environment that mpirun (Open MPI) or srun (Slurm) gives its processes; empty for a
/// process alone.
/// @param variable  std::getenv
std::optional<Crew> crew_of_environment(const std::function<const char*(const char*)>& variable);

/// Takes chunks until none is left to take, beginning at this process' share, and computes those
/// that are missing. Number 0 then computes what others have taken and not stored yet, from the
/// end, and drops a chunk as soon as its owner has stored it: when it returns, all chunks are
/// there, whoever died.
/// @param is_complete  whether the table is there already: nothing is left to do
/// @throws Cancelled; InputError  when a part cannot be written
RunReport run_crew(const Sweep& sweep, const Layout& layout, const Parts& parts, const Crew& crew,
                   const std::function<bool()>& is_complete, const Control& control);

}  // namespace miebrdf::sweep
