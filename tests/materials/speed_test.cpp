// A name resolved and 81 wavelengths evaluated: under 1 ms of processor time, database opened anew.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

#include "materials/database.h"
#include "tests/support/catch.h"

using namespace miebrdf::materials;

TEST_CASE("a name and 81 wavelengths take under a millisecond", "[materials][speed]") {
    std::vector<double> milliseconds;
    double sum = 0;
    for (int run = 0; run < 51; ++run) {
        const std::clock_t start = std::clock();
        const RefractiveIndex index = Database::embedded().refractive_index("titanium dioxide");
        for (int i = 0; i < 81; ++i) sum += index.at(380 + 5 * i).real();
        milliseconds.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    CHECK(sum > 0);
    std::nth_element(milliseconds.begin(), milliseconds.begin() + 25, milliseconds.end());
    std::printf("open, resolve, 81 wavelengths: median %.3f ms of processor time\n",
                milliseconds[25]);
#if defined(__SANITIZE_ADDRESS__)
    CHECK(milliseconds[25] <= 20.0);
#else
    CHECK(milliseconds[25] <= 1.0);
#endif
}
