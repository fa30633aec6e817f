// What the program prints, where it must succeed.
#pragma once

#include <string>

#include "tests/support/catch.h"
#include "tests/support/program.h"

namespace miebrdf::support {

/// @param arguments  as of run_program
inline CsvOutput csv_of(const std::string& arguments) {
    const auto run = run_program(arguments);
    CAPTURE(arguments, run.err);
    REQUIRE(run.exit_code == 0);
    return CsvOutput(run.out);
}

}  // namespace miebrdf::support
