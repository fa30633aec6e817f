// Runs of the program that must succeed.
#pragma once

#include <string>

#include "tests/support/catch.h"
#include "tests/support/program.h"

namespace miebrdf::support {

/// @param arguments, environment  as of run_program
inline ProgramRun run_ok(const std::string& arguments, const std::string& environment = {}) {
    ProgramRun run = run_program(arguments, environment);
    CAPTURE(arguments, run.err);
    REQUIRE(run.exit_code == 0);
    return run;
}

inline CsvOutput csv_of(const std::string& arguments) { return CsvOutput(run_ok(arguments).out); }

}  // namespace miebrdf::support
