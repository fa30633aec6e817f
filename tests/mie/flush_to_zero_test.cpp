// The floating-point state of callers and of threads that lend a hand.
#include "mie/sphere/flush_to_zero.h"

#include <miebrdf/ensemble.h>

#include <cfenv>
#include <cstdint>
#include <functional>
#include <thread>

#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

double least() {
    volatile double smallest = 2.2250738585072014e-308;
    volatile double half = smallest / 2;
    return half;
}

// Without the flags that operations raise: those say what happened, not how to compute.
std::uint64_t modes() {
#if defined(__SSE2__)
    return mie::FlushToZero::state() & ~std::uint64_t(0x3f);
#else
    return mie::FlushToZero::state();
#endif
}

}  // namespace

TEST_CASE("denormal numbers are zero while they are flushed, and only then", "[mie][flush]") {
    REQUIRE(least() > 0);
    const std::uint64_t before = modes();
    {
        const mie::FlushToZero flush;
        if (modes() != before) CHECK(least() == 0);
    }
    CHECK(modes() == before);
    CHECK(least() > 0);
}

TEST_CASE("averages leave the floating-point state of every thread as it was", "[mie][flush]") {
    mie::EnsembleRequest request;
    request.sizes.effective_radius_um = 2;
    request.refractive_index = 2.6;
    request.highest_moment = 8;
    request.with_phase_table = true;
    request.phase_floor = 0.5;
    std::fesetround(FE_UPWARD);  // a mode of the caller's own
    const std::uint64_t before = modes();
    int jobs = 0, changed = 0;
    const auto other_threads = [&](int count, const std::function<void(int)>& job) {
        std::thread helper([&] {
            const std::uint64_t at_start = modes();
            for (int i = 0; i < count; ++i) {
                job(i);
                ++jobs;
                changed += modes() != at_start || !(least() > 0);
            }
        });
        helper.join();
    };
    mie::average_over_sizes(request, other_threads);
    CHECK(modes() == before);
    request.angles_deg = {30};
    mie::phase_at_angles(request, 0.0, other_threads);
    CHECK(modes() == before);
    request.sizes.effective_radius_um = -1;
    CHECK_THROWS(mie::average_over_sizes(request));
    CHECK(modes() == before);
    std::fesetround(FE_TONEAREST);
    CHECK(least() > 0);
    CHECK(jobs > 0);
    CHECK(changed == 0);
}
