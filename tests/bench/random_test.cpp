#include "tools/bench/random.h"

#include <cmath>

#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("Philox4x32-10 gives the known answers of its authors", "[bench][random]") {
    // kat_vectors of the Random123 distribution (Salmon et al. 2011).
    CHECK(bench::philox({0, 0, 0, 0}, {0, 0}) ==
          bench::PhiloxCounter{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
    CHECK(
        bench::philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}) ==
        bench::PhiloxCounter{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
    CHECK(
        bench::philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
        bench::PhiloxCounter{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("streams are reproducible, different and uniform", "[bench][random]") {
    bench::RandomStream a(7, 1), again(7, 1), other(7, 2);
    double sum = 0, squares = 0, product = 0;
    const int n = 100000;
    for (int i = 0; i < n; ++i) {
        const double u = a.uniform(), v = other.uniform();
        REQUIRE(u == again.uniform());
        REQUIRE((u > 0 && u < 1));
        sum += u;
        squares += u * u;
        product += u * v;
    }
    // Five standard errors: sqrt(1/12), sqrt(4/45) and sqrt(7/144) over sqrt(n).
    CHECK(std::abs(sum / n - 0.5) <= 5 * std::sqrt(1.0 / 12 / n));
    CHECK(std::abs(squares / n - 1.0 / 3) <= 5 * std::sqrt(4.0 / 45 / n));
    CHECK(std::abs(product / n - 0.25) <= 5 * std::sqrt(7.0 / 144 / n));
}
