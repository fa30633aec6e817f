#include "pipeline/solve/parallel.h"

#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "rte/math/interruption.h"
#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("every job runs exactly once on any number of threads", "[pipeline][parallel]") {
    const int threads = GENERATE(0, 1, 2, 7);
    std::vector<std::atomic<int>> calls(1000);
    run_parallel("count", calls.size(), {.threads = threads}, [&](std::size_t i) { ++calls[i]; });
    for (const auto& count : calls) CHECK(count == 1);
}

TEST_CASE("every piece of every job runs exactly once on any number of threads",
          "[pipeline][parallel]") {
    const Control control{.threads = GENERATE(0, 1, 2, 7)};
    const std::size_t jobs = GENERATE(1, 20);
    std::vector<std::atomic<int>> calls(jobs * 50);
    const auto pieces = pieces_of_job(control);
    run_parallel("count", jobs, control, [&](std::size_t job) {
        pieces(50, [&](int piece) { ++calls[job * 50 + static_cast<std::size_t>(piece)]; });
    });
    for (const auto& count : calls) CHECK(count == 1);
}

TEST_CASE("progress counts every job of its stage in order", "[pipeline][parallel]") {
    const int threads = GENERATE(1, 2);
    std::vector<std::size_t> seen;
    Control control{.threads = threads};
    control.progress = [&](const std::string& stage, std::size_t done, std::size_t total) {
        CHECK(stage == "count");
        CHECK(total == 50);
        seen.push_back(done);
    };
    run_parallel("count", 50, control, [](std::size_t) {});
    REQUIRE(seen.size() == 50);
    for (std::size_t i = 0; i < seen.size(); ++i) CHECK(seen[i] == i + 1);
}

TEST_CASE("a job tells when it begins, and each of its pieces that it is done",
          "[pipeline][parallel]") {
    const int threads = GENERATE(1, 2);
    std::atomic<int> begun = 0, pieces_done = 0;
    Control control{.threads = threads};
    control.job_begun = [&](const std::string& stage, std::size_t total) {
        if (stage == "count" && total == 3) ++begun;
    };
    control.piece_done = [&] { ++pieces_done; };
    const auto pieces = pieces_of_job(control);
    run_parallel("count", 3, control, [&](std::size_t) { pieces(50, [](int) {}); });
    CHECK(begun == 3);
    CHECK(pieces_done == 150);
}

TEST_CASE("what asks to be cancelled stops the jobs that have not begun", "[pipeline][parallel]") {
    const int threads = GENERATE(1, 2);
    std::atomic<bool> cancelled = false;
    std::atomic<int> calls = 0;
    const Control control{.threads = threads, .is_cancelled = [&] { return cancelled.load(); }};
    CHECK_THROWS_AS(run_parallel("count", 1000, control,
                                 [&](std::size_t) {
                                     ++calls;
                                     cancelled = true;
                                 }),
                    Cancelled);
    CHECK(calls <= threads);  // those that had passed the check on their thread
}

TEST_CASE("what asks to be cancelled stops a job between its steps, too", "[pipeline][parallel]") {
    const int threads = GENERATE(1, 2);
    std::atomic<int> asked = 0;
    const Control control{.threads = threads, .is_cancelled = [&] { return ++asked > 20; }};
    CHECK_THROWS_AS(run_parallel("count", 1, control,
                                 [](std::size_t) {
                                     for (;;) math::interruption_point();
                                 }),
                    Cancelled);
    asked = 0;
    const auto pieces = pieces_of_job(control);
    CHECK_THROWS_AS(
        run_parallel("count", 1, control, [&](std::size_t) { pieces(1000, [](int) {}); }),
        Cancelled);
    CHECK(asked <= 20 + 2 * threads);
    CHECK_NOTHROW(math::interruption_point());  // outside of jobs nobody asks
}

TEST_CASE("a single wavelength is cancelled in the middle of its solution",
          "[pipeline][parallel]") {
    // Radiative transfer of many orders, and Mie theory of large spheres: each asks often.
    std::atomic<int> asked = 0;
    const Control count{.threads = 1, .is_cancelled = [&] { return ++asked < 0; }};
    const Scene scene =
        GENERATE(Scene{.base = medium("hg:0.9,0.9")}, Scene{.base = medium("H2O_ice,radius=50")});
    const auto ask = [&](const Control& control) {
        (void)solve(scene, {550}, {.tolerance = 1e-2}, control).evaluate({{0.5}, {0.4}, {0, 90}});
    };
    ask(count);
    const int all = asked;
    CHECK(all > 10);
    asked = 0;
    const Control stop{.threads = 1, .is_cancelled = [&] { return ++asked > all / 2; }};
    CHECK_THROWS_AS(ask(stop), Cancelled);
}

TEST_CASE("when one job fails, no other goes on with pieces that were left out",
          "[pipeline][parallel]") {
    // TBB skips what belongs to a group that was stopped; Mie theory then read what was never
    // written.
    const int threads = GENERATE(1, 2);
    std::atomic<int> incomplete = 0;
    for (int repeat = 0; repeat < 20; ++repeat) {
        const Control control{.threads = threads};
        const auto pieces = pieces_of_job(control);
        CHECK_THROWS_WITH(
            run_parallel("fail", 8, control,
                         [&](std::size_t job) {
                             std::atomic<int> done = 0;
                             pieces(40, [&](int) {
                                 std::this_thread::sleep_for(std::chrono::microseconds(50));
                                 ++done;
                             });
                             if (done != 40) ++incomplete;
                             if (job == 1) throw std::runtime_error("job 1");
                         }),
            "job 1");
    }
    CHECK(incomplete == 0);
}

TEST_CASE("an exception of a job reaches the caller", "[pipeline][parallel][errors]") {
    const int threads = GENERATE(1, 2);
    CHECK_THROWS_WITH(run_parallel("fail", 100, {.threads = threads},
                                   [](std::size_t i) {
                                       if (i == 42) throw std::runtime_error("job 42");
                                   }),
                      "job 42");
}
