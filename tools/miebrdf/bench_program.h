// The second program, miebrdf-bench: the reference methods, tables of truth and cases that
// `miebrdf bench` and `miebrdf stress` need, and nobody else.
#pragma once

#include "tools/miebrdf/command.h"

namespace miebrdf::program {

inline constexpr char kBenchHelp[] = "error against run time of every method";
inline constexpr char kStressHelp[] = "stiff and extreme cases, each with a bound that has a cause";

/// Makes a command of miebrdf that hands all its words to the command of the same name of
/// miebrdf-bench. That program is looked for beside this one, then in ../libexec/miebrdf, then
/// along PATH.
void forward_to_bench_program(CLI::App& command, Shell& shell);

}  // namespace miebrdf::program
