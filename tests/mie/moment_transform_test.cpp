#include "mie/ensemble/moment_transform.h"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <complex>
#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/sphere/radial_functions.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<60>,
                                           boost::multiprecision::et_off>;

namespace {

Real factorial(int n) {
    Real product = 1;
    for (int i = 2; i <= n; ++i) product *= i;
    return product;
}

// (n m l; 1 -1 0) by Racah's sum (Edmonds 1957, eq. 3.6.11 and 3.7.3), in 60 digits.
double three_j_squared(int n, int m, int l) {
    if (l < std::abs(n - m) || l > n + m) return 0;
    const Real triangle = factorial(n + m - l) * factorial(n - m + l) * factorial(m + l - n) /
                          factorial(n + m + l + 1);
    const Real projections = factorial(n + 1) * factorial(n - 1) * factorial(m - 1) *
                             factorial(m + 1) * factorial(l) * factorial(l);
    Real sum = 0;
    for (int t = 0; t <= n + m; ++t) {
        const int parts[] = {t, l - m + 1 + t, l - n + 1 + t, n + m - l - t, n - 1 - t, m - 1 - t};
        bool allowed = true;
        Real product = 1;
        for (const int part : parts) {
            allowed = allowed && part >= 0;
            if (part >= 0) product *= factorial(part);
        }
        if (allowed) sum += (t % 2 == 0 ? 1 : -1) / product;
    }
    return static_cast<double>(triangle * projections * sum * sum);
}

// One sphere whose only partial waves are U_n = u and U_m = v.
mie::BandCovariance two_waves(int terms, int width, int n, double u, int m, double v, bool minus) {
    mie::SphereBlock block;
    block.make_room(terms, 8);
    block.U.setZero();
    block.V.setZero();
    auto& waves = minus ? block.V : block.U;
    waves(n, 0) = u;
    waves(m, 0) = v;
    mie::BandCovariance covariance(terms, width);
    covariance.add(block);
    return covariance;
}

std::vector<double> moments_of(const mie::BandCovariance& covariance) {
    return mie::MomentTransform(covariance.terms(), covariance.width())(covariance);
}

}  // namespace

TEST_CASE("moments of two partial waves are 3j symbols by Racah's formula", "[mie][moments]") {
    const int n = GENERATE(1, 2, 5, 14), m = GENERATE(3, 6, 17);
    const bool minus = GENERATE(false, true);
    const double u = 0.7, v = -0.4;
    const int width = n + m;
    const auto sums = moments_of(two_waves(20, width, n, u, m, v, minus));
    const auto sign = [minus](int parity) { return minus && parity % 2 != 0 ? -1.0 : 1.0; };
    for (int l = 0; l <= width; ++l) {
        const double truth =
            sign(l) * ((2 * n + 1) * (2 * n + 1) * u * u * three_j_squared(n, n, l) +
                       (2 * m + 1) * (2 * m + 1) * v * v * three_j_squared(m, m, l)) +
            sign(n + m + l) * 2 * (2 * n + 1) * (2 * m + 1) * u * v * three_j_squared(n, m, l);
        CAPTURE(n, m, l, minus);
        // Recurrence in l: a rounding for each step, relative to the sum's parts.
        CHECK(std::abs(sums[l] - truth) <= 1e-12 * (2 * n + 1) * (2 * m + 1));
    }
}

TEST_CASE("3j symbols of the transform sum to one", "[mie][moments]") {
    // sum over l of (2l+1) f_l^2 = 1 for every pair of orders, so that the forward intensity
    // sum (2l+1) chi_l is the square of the sum of waves.
    const int n = GENERATE(1, 30, 300), m = GENERATE(2, 31, 320);
    const double u = 0.3, v = 0.5;
    const auto sums = moments_of(two_waves(320, n + m, n, u, m, v, false));
    double forward = 0;
    for (int l = 0; l <= n + m; ++l) forward += (2 * l + 1) * sums[l];
    // A pair of equal orders n = m reaches l = 2 n, beyond n + m when that is the larger one.
    const int width = 2 * std::max(n, m);
    const auto all = moments_of(two_waves(320, width, n, u, m, v, false));
    double whole = 0;
    for (int l = 0; l <= width; ++l) whole += (2 * l + 1) * all[l];
    const double amplitude = (2 * n + 1) * u + (2 * m + 1) * v;
    CHECK(whole == Approx(amplitude * amplitude).epsilon(1e-11));
    CHECK(forward <= whole * (1 + 1e-11));  // no term is negative
}

TEST_CASE("the first moment is the asymmetry that products of coefficients give",
          "[mie][moments]") {
    // Two ways: 3j symbols of the covariance; Bohren & Huffman's sum over neighbouring orders.
    mie::EnsembleRequest request;
    request.sizes.effective_radius_um = GENERATE(0.02, 0.5, 3.0);
    request.refractive_index =
        GENERATE(std::complex<double>(1.46, 0), std::complex<double>(3.3, 0.02));
    request.highest_moment = 4;
    request.tolerance = 1e-8;  // double precision bands
    const auto optics = mie::average_over_sizes(request);
    CHECK(std::abs(optics.chi[1] - optics.asymmetry) <= 1e-12);
}
