// How the program says no: one line on standard error, and nothing on standard output.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/program.h"

namespace miebrdf::support {

inline constexpr int kUsage = 2;
inline constexpr int kBadInput = 3;

inline void check_one_line(const ProgramRun& run, int exit_code,
                           const std::vector<std::string>& words) {
    CAPTURE(run.err, run.out);
    CHECK(run.exit_code == exit_code);
    CHECK(run.out.empty());
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK_THAT(run.err, Catch::StartsWith("miebrdf: error: "));
    for (const std::string& word : words) CHECK_THAT(run.err, Catch::Contains(word));
}

/// Arguments of the program, and words of its error.
struct Refusal {
    std::string arguments;
    std::vector<std::string> words;
};

inline void check_refused(int exit_code, const std::vector<Refusal>& refusals) {
    for (const Refusal& refusal : refusals) {
        CAPTURE(refusal.arguments);
        check_one_line(run_program(refusal.arguments), exit_code, refusal.words);
    }
}

}  // namespace miebrdf::support
