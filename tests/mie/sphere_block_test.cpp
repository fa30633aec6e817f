#include "mie/sphere/sphere_block.h"

#include <cmath>
#include <vector>

#include <miebrdf/sphere.h>
#include "tests/support/catch.h"

using namespace miebrdf;
using Complex = std::complex<double>;

namespace {

struct Case {
    Complex m;
    double smallest, largest;
};

std::vector<double> sizes_of(const Case& c, int count) {
    std::vector<double> x;
    for (int i = 0; i < count; ++i)
        x.push_back(c.smallest + (c.largest - c.smallest) * i / (count - 1));
    return x;
}

}  // namespace

TEST_CASE("eight spheres at once equal one at a time", "[mie][sphere_block]") {
    // Upward and downward waves inside, damped ones, scale changes, masked lanes, small sizes.
    const Case c = GENERATE(
        Case{2.6, 234, 300}, Case{1.46, 5, 28}, Case{1.46, 600, 604}, Case{{3.3, 0.02}, 234, 1137},
        Case{{1.33, 1e-9}, 100, 130}, Case{{1.33, 1e-3}, 1000, 1003}, Case{{2.6, 1e-9}, 1000, 1003},
        Case{{4, 3}, 2, 1000}, Case{{0.05, 3}, 2, 400}, Case{{10, 10}, 2, 300},
        // Pigments and smaller ones, down to where eight at once begin.
        Case{2.6, 0.1, 2.2}, Case{1.01, 0.1, 1}, Case{0.7, 0.1, 2}, Case{100, 0.1, 2},
        Case{{1.5, 1e-3}, 0.1, 2}, Case{{0.05, 3}, 0.1, 4}, Case{{10, 10}, 0.1, 3},
        Case{{1.3, 1e-8}, 0.1, 1}, Case{{0.01, 1e-6}, 0.1, 3}, Case{{2, 5000}, 0.1, 3},
        Case{{1.5, 1000}, 1, 50}, Case{0.7, 1, 200}, Case{{1.5, 1}, 0.001, 0.3},
        // Weakly absorbing bubbles: absorption summed the wrong way gave 1e80 there.
        Case{{0.5, 1e-3}, 2, 90}, Case{{0.02, 1e-6}, 2, 30});
    const std::vector<double> x = sizes_of(c, 13);  // not a whole number of vectors
    std::vector<double> weights(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) weights[i] = 1 / (x[i] * x[i]);
    mie::SphereBlock block;
    const auto sums = mie::compute_spheres(c.m, x, weights, &block);

    double scattered = 0, absorbed = 0, asymmetric = 0, worst = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const auto sphere = mie::scatter_by_sphere(c.m, x[i]);
        scattered += sphere.q_sca / 2;
        absorbed += sphere.q_abs / 2;
        asymmetric += sphere.q_sca * sphere.asymmetry / 4;
        const auto single = mie::mie_coefficients(c.m, x[i]);
        const double root = std::sqrt(weights[i]);
        const auto column = static_cast<Eigen::Index>(i);
        for (int n = 1; n <= static_cast<int>(single.a.size()); ++n) {
            const Complex u(block.U(n, column), block.U(n, column + block.imaginary));
            const Complex v(block.V(n, column), block.V(n, column + block.imaginary));
            worst = std::max({worst, std::abs(u / root - single.a[n - 1] - single.b[n - 1]),
                              std::abs(v / root - single.a[n - 1] + single.b[n - 1])});
        }
    }
    CAPTURE(c.m, c.smallest, c.largest);
    CHECK(sums.scattered == Approx(scattered).epsilon(1e-12));
    CHECK(sums.asymmetric == Approx(asymmetric).epsilon(1e-12));
    if (c.m.imag() == 0) {
        CHECK(sums.absorbed == 0);
    } else {
        CHECK(sums.absorbed == Approx(absorbed).epsilon(1e-11));
    }
    // Narrow resonances of transparent spheres magnify rounding (1/width).
    CHECK(worst <= 1e-9);
    const auto without_waves = mie::compute_spheres(c.m, x, weights, nullptr);
    CHECK(without_waves.scattered == sums.scattered);
    CHECK(without_waves.absorbed == sums.absorbed);
}
