#include "pipeline/parallel.h"

#include <atomic>
#include <stdexcept>
#include <vector>

#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("every job runs exactly once on any number of threads", "[pipeline][parallel]") {
    const int threads = GENERATE(0, 1, 2, 7);
    std::vector<std::atomic<int>> calls(1000);
    run_parallel(calls.size(), threads, [&](std::size_t i) { ++calls[i]; });
    for (const auto& count : calls) CHECK(count == 1);
}

TEST_CASE("an exception of a job reaches the caller", "[pipeline][parallel][errors]") {
    const int threads = GENERATE(1, 2);
    CHECK_THROWS_WITH(run_parallel(100, threads,
                                   [](std::size_t i) {
                                       if (i == 42) throw std::runtime_error("job 42");
                                   }),
                      "job 42");
}
