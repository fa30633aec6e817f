#include "tools/bench/scattering_law.h"

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>

#include "tests/support/catch.h"

using namespace miebrdf;
using bench::ScatteringLaw;

namespace {

ScatteringLaw some_law(int which) {
    switch (which) {
        case 0:
            return ScatteringLaw::isotropic();
        case 1:
            return ScatteringLaw::rayleigh();
        case 2:
            return ScatteringLaw::henyey_greenstein(0.75);
        case 3:
            return ScatteringLaw::henyey_greenstein(-0.4);
        default:
            return ScatteringLaw::tabulated({-1, -0.5, 0.2, 0.9, 1}, {1, 0, 0.5, 2, 30});
    }
}

}  // namespace

TEST_CASE("sampling inverts the distribution of the phase function", "[bench][law]") {
    const int which = GENERATE(0, 1, 2, 3, 4);
    const auto law = some_law(which);
    const auto fraction_below = [&](double x) {
        double sum = 0;
        // Piecewise, because a table has kinks.
        const double kinks[] = {-1, -0.5, 0.2, 0.9, 1};
        for (int i = 0; i < 4; ++i) {
            const double from = kinks[i], to = std::min(x, kinks[i + 1]);
            if (to <= from) break;
            sum += boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
                [&](double t) { return law.value(t) / 2; }, from, to, 10, 1e-13);
        }
        return sum;
    };
    CAPTURE(which);
    CHECK(std::abs(fraction_below(1.0) - 1) <= 1e-12);
    for (const double u : {1e-6, 0.01, 0.2, 0.5, 0.77, 0.99, 1 - 1e-6}) {
        // Quadrature to 1e-13; the inverse of a steep distribution costs a digit or two.
        CHECK(std::abs(fraction_below(law.sample(u)) - u) <= 1e-11);
    }
}

TEST_CASE("the asymmetry of a law is the mean of its cosine", "[bench][law]") {
    CHECK(some_law(2).asymmetry() == 0.75);
    CHECK(some_law(1).asymmetry() == 0.0);
    // A straight line P = 1 + x: g = 1/3.
    CHECK(std::abs(ScatteringLaw::tabulated({-1, 0.3, 1}, {0, 1.3, 2}).asymmetry() - 1.0 / 3) <=
          1e-15);
}

TEST_CASE("laws that no light could follow are refused", "[bench][law][errors]") {
    CHECK_THROWS_WITH(ScatteringLaw::henyey_greenstein(1.0), Catch::Contains("(-1, 1)"));
    CHECK_THROWS_AS(ScatteringLaw::tabulated({-1, 1}, {1, -1}), std::invalid_argument);
    CHECK_THROWS_AS(ScatteringLaw::tabulated({-1, 0.5}, {1, 1}), std::invalid_argument);
    CHECK_THROWS_AS(ScatteringLaw::tabulated({-1, 1}, {0, 0}), std::invalid_argument);
}
