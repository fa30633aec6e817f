// The processor path of the arithmetic (<miebrdf/processor_path.h>): which there are in this copy,
// and how one of them is forced.
#pragma once

#include <string>
#include <vector>

namespace miebrdf::program {

/// The environment variable that forces a path.
constexpr char kPathVariable[] = "MIEBRDF_PROCESSOR_PATH";

/// One that this copy of the libraries was compiled for.
struct ProcessorPath {
    std::string name;    ///< as processor_path() gives it
    bool runs_here;      ///< whether this machine's processor has its instructions
    std::string folder;  ///< of its libraries
};

/// The one for every processor first; in a build for one path that one alone.
std::vector<ProcessorPath> processor_paths();

/// "processor path: x86-64-v3; here also: x86-64", and the paths that this processor lacks.
std::string processor_path_line();

/// To be called first in main(). Where the variable names another path than the loader took, begins
/// the program again with the libraries of that path.
/// @throws UsageError  for a path that is not here or that this processor lacks
void obey_processor_path(char** argv);

}  // namespace miebrdf::program
