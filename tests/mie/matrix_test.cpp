// The scattering matrix of ensembles against amplitudes of single spheres, closed forms, a table
// of somebody else, and its own tolerance.
#include <miebrdf/ensemble.h>

#include <cmath>
#include <limits>
#include <numbers>

#include <miebrdf/sphere.h>
#include "rte/math/legendre.h"
#include "rte/math/wigner.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

using Complex = std::complex<double>;

constexpr double kRadian = std::numbers::pi / 180;

struct Elements {
    double a1, a2, a3, a4, b1, b2;
};

Elements at(const mie::MatrixOptics& matrix, double x) {
    const MatrixExpansion& e = matrix.expansion;
    std::vector<double> plus, minus;
    for (std::size_t l = 0; l < e.a2.size(); ++l) {
        plus.push_back(e.a2[l] + e.a3[l]);
        minus.push_back(e.a2[l] - e.a3[l]);
    }
    const double p = math::wigner_series(2, 2, plus, x), m = math::wigner_series(2, -2, minus, x);
    return {math::legendre_series(matrix.optics.chi, x),
            (p + m) / 2,
            (p - m) / 2,
            math::wigner_series(0, 0, e.a4, x),
            math::wigner_series(0, 2, e.b1, x),
            math::wigner_series(0, 2, e.b2, x)};
}

mie::EnsembleRequest sphere_of(double size_parameter, std::complex<double> index) {
    mie::EnsembleRequest request;
    request.sizes.kind = mie::SizeDistributionKind::mono;
    request.wavelength_nm = 550;
    request.sizes.effective_radius_um = size_parameter * 0.55 / (2 * std::numbers::pi);
    request.refractive_index = index;
    return request;
}

mie::EnsembleRequest gamma_of(double radius_um, double variance, std::complex<double> index) {
    mie::EnsembleRequest request;
    request.sizes.kind = mie::SizeDistributionKind::gamma;
    request.sizes.effective_radius_um = radius_um;
    request.sizes.effective_variance = variance;
    request.refractive_index = index;
    return request;
}

/// Largest difference of coefficients, without 2l + 1.
double difference(const mie::MatrixOptics& a, const mie::MatrixOptics& b) {
    double worst = 0;
    const auto compare = [&](const std::vector<double>& p, const std::vector<double>& q,
                             double two_l) {
        for (std::size_t l = 0; l < std::max(p.size(), q.size()); ++l) {
            const double of_p = l < p.size() ? p[l] : 0.0, of_q = l < q.size() ? q[l] : 0.0;
            worst = std::max(worst, std::abs(of_p - of_q) / (two_l * double(l) + 1.0));
        }
    };
    compare(a.optics.chi, b.optics.chi, 0.0);
    for (const auto& [name, list] : kMatrixLists)
        compare(a.expansion.*list, b.expansion.*list, 2.0);
    return worst;
}

}  // namespace

TEST_CASE("the series of one sphere gives back the products of its amplitudes", "[mie][matrix]") {
    const double x = GENERATE(0.05, 1.0, 5.0, 30.0, 200.0);
    const Complex m = GENERATE(Complex{1.5, 0}, Complex{1.33, 0.01}, Complex{0.3, 3.0});
    const auto request = sphere_of(x, m);
    const auto matrix = mie::average_matrix(request);
    CHECK(matrix.optics.converged);
    const std::vector<double> angles = {0, 0.5, 10, 37, 60, 90, 120.5, 150, 178, 180};
    const auto amplitudes = mie::scattering_amplitudes(m, x, angles);
    const double norm = 4 / (x * x * matrix.optics.q_sca);
    // Rounding of the amplitudes' sums, as that of the efficiencies, relative to what is forward.
    const double bound = 1e-11 * at(matrix, 1).a1;
    for (std::size_t i = 0; i < angles.size(); ++i) {
        const auto s1 = amplitudes.s1[i], s2 = amplitudes.s2[i];
        const Elements F = at(matrix, mie::cosine_of_scattering_angle(angles[i]));
        const double a1 = norm * (std::norm(s1) + std::norm(s2)) / 2;
        const double b1 = norm * (std::norm(s2) - std::norm(s1)) / 2;
        CAPTURE(x, m, angles[i]);
        CHECK(std::abs(F.a1 - a1) <= bound);
        CHECK(std::abs(F.a2 - a1) <= bound);
        CHECK(std::abs(F.b1 - b1) <= bound);
        CHECK(std::abs(F.a3 - norm * (s2 * std::conj(s1)).real()) <= bound);
        CHECK(std::abs(F.a4 - F.a3) <= bound);
        CHECK(std::abs(F.b2 - norm * (s2 * std::conj(s1)).imag()) <= bound);
        CHECK(std::abs(F.a3 * F.a3 + F.b1 * F.b1 + F.b2 * F.b2 - F.a1 * F.a1) <=
              4 * bound * at(matrix, 1).a1);
    }
}

TEST_CASE("spheres much smaller than the wavelength scatter as Rayleigh found", "[mie][matrix]") {
    // Corrections are of the order x^2; b2 of a sphere that does not absorb, x^5.
    const double x = 1e-3;
    const auto matrix = mie::average_matrix(sphere_of(x, {1.5, 0}));
    const auto& e = matrix.expansion;
    const auto& chi = matrix.optics.chi;
    REQUIRE(chi.size() >= 3);
    const double bound = 10 * x * x;
    CHECK(std::abs(5 * chi[2] - 0.5) <= bound);
    CHECK(std::abs(e.a2[2] - 3) <= bound);
    CHECK(std::abs(e.a3[2]) <= bound);
    CHECK(std::abs(e.a4[1] - 1.5) <= bound);
    CHECK(std::abs(e.b1[2] + std::sqrt(1.5)) <= bound);
    CHECK(std::abs(e.b2[2]) <= bound);
    CHECK(std::abs(3 * chi[1]) <= bound);
    CHECK(std::abs(e.a4[0]) <= bound);
    CHECK(chi.size() <= 8);  // the rest of the series is rounding
}

TEST_CASE("the haze of de Haan, Bosma & Hovenier has the coefficients of another Mie code",
          "[mie][matrix]") {
    // n(r) = r^2 exp(-15.1186 sqrt r), m 1.33, 700 nm: six decimals of a Mie code with 4000 sizes
    // up to 3 um and its own expansion.
    mie::EnsembleRequest request;
    request.sizes.kind = mie::SizeDistributionKind::tabulated;
    for (int i = 0; i <= 6000; ++i) {
        const double r = 1e-3 + (3.0 - 1e-3) * i / 6000;
        request.sizes.radii_um.push_back(r);
        request.sizes.number_density.push_back(r * r * std::exp(-15.1186 * std::sqrt(r)));
    }
    request.refractive_index = {1.33, 0};
    request.wavelength_nm = 700;
    request.tolerance = 1e-5;
    const auto matrix = mie::average_matrix(request);
    const double expected[8][6] = {{1.000000, 0.000000, 0.000000, 0.954624, 0.000000, 0.000000},
                                   {2.412641, 0.000000, 0.000000, 2.447874, 0.000000, 0.000000},
                                   {3.230501, 4.244978, 4.133648, 3.192437, -0.028646, -0.011997},
                                   {3.373012, 4.003682, 4.010572, 3.399214, 0.014105, 0.119000},
                                   {3.231491, 3.783165, 3.735791, 3.221254, 0.002445, 0.075940},
                                   {2.893465, 3.224800, 3.211539, 2.907310, 0.036476, 0.165319},
                                   {2.495852, 2.807025, 2.778232, 2.495180, 0.018636, 0.115099},
                                   {2.113515, 2.273155, 2.258164, 2.122620, 0.036382, 0.153261}};
    CAPTURE(matrix.optics.error_estimate, matrix.optics.size_nodes);
    const auto& e = matrix.expansion;
    for (int l = 0; l < 8; ++l) {
        const double found[6] = {
            (2 * l + 1) * matrix.optics.chi[l], e.a2[l], e.a3[l], e.a4[l], e.b1[l], e.b2[l]};
        for (int k = 0; k < 6; ++k) {
            CAPTURE(l, k, found[k], expected[l][k]);
            // Its largest radius and its sizes are not known.
            CHECK(std::abs(found[k] - expected[l][k]) <= 2e-3);
        }
    }
}

TEST_CASE("a1 of an ensemble is the phase function of the scalar average", "[mie][matrix]") {
    auto request = gamma_of(0.2, 0.1, {1.5, 0.002});
    request.tolerance = 1e-6;
    request.highest_moment = 400;
    request.angles_deg = {0, 30, 90, 150, 180};
    request.phase_tolerance = 1e-4;
    const auto scalar = mie::average_over_sizes(request);
    auto whole = request;
    whole.highest_moment = -1;
    const auto matrix = mie::average_matrix(whole);
    CHECK(matrix.optics.single_scattering_albedo ==
          Approx(scalar.single_scattering_albedo).epsilon(1e-6));
    for (std::size_t l = 0; l < matrix.optics.chi.size(); ++l)
        CHECK(std::abs(matrix.optics.chi[l] - scalar.chi[l]) <= 2e-6);
    for (std::size_t i = 0; i < request.angles_deg.size(); ++i) {
        const Elements F = at(matrix, std::cos(request.angles_deg[i] * kRadian));
        CHECK(std::abs(F.a1 - scalar.phase[i]) <= 1e-4 * scalar.phase[i]);
        CHECK(std::abs(F.b1) <= F.a1);
        // A mixture of spheres loses polarisation (Hovenier & van der Mee 1983).
        CHECK(F.a3 * F.a3 + F.b1 * F.b1 + F.b2 * F.b2 <= F.a1 * F.a1 * (1 + 1e-12));
    }
}

TEST_CASE("P beside a scattering matrix is a1 as a table, and its noise what that errs by",
          "[mie][matrix][honesty]") {
    auto request = gamma_of(GENERATE(0.3, 2.0), 0.05, GENERATE(Complex{1.33, 0}, Complex{2.6, 0}));
    request.tolerance = 1e-6;
    const auto truth = mie::average_matrix(request).optics;
    request.tolerance = 1e-3;
    const auto found = mie::average_matrix(request).optics;
    double squares = 0, stated = 0;
    int beyond = 0;
    constexpr int count = 721;
    for (int i = 0; i < count; ++i) {
        const double x = std::cos(0.25 * i * kRadian);
        const double series = math::legendre_series(found.chi, x);
        const double here = (*found.phase_table)(x), noise = found.phase_table->noise(x);
        CAPTURE(i, series, here, noise);
        // Eight nodes leave 1e-6 of the fastest wave, which is not brighter than the glory.
        CHECK(std::abs(here - series) <=
              2e-6 * std::max(series, math::legendre_series(found.chi, -1)));
        const double error = std::abs(here - math::legendre_series(truth.chi, x));
        squares += error * error;
        stated += noise * noise;
        if (!(error <= 3 * noise + 1e-5)) ++beyond;
    }
    CAPTURE(std::sqrt(squares / count), std::sqrt(stated / count), beyond);
    CHECK(squares <= 2 * stated);
    CHECK(beyond <= count / 50);
}

TEST_CASE("errors of scattering matrices are within what is stated", "[mie][matrix][honesty]") {
    const double radius_um = GENERATE(0.05, 0.3, 1.0, 3.0);
    const Complex m = GENERATE(Complex{1.33, 0}, Complex{1.5, 0.01}, Complex{2.6, 0});
    auto request = gamma_of(radius_um, 0.1, m);
    request.tolerance = 1e-5;
    const auto truth = mie::average_matrix(request);
    for (const double tolerance : {1e-3, 1e-4}) {
        request.tolerance = tolerance;
        const auto matrix = mie::average_matrix(request);
        const double error = difference(matrix, truth);
        CAPTURE(radius_um, m, tolerance, error, matrix.optics.error_estimate,
                truth.optics.error_estimate, matrix.optics.size_nodes);
        CHECK(matrix.optics.converged);
        // As for scalar moments: 95 % of errors are below twice the estimate.
        CHECK(error <= 3 * matrix.optics.error_estimate + truth.optics.error_estimate);
    }
}

TEST_CASE("where no point of P counts, series err within what is stated, of fewer sizes",
          "[mie][matrix][honesty]") {
    auto request = gamma_of(3.0, 0.1, {2.6, 0});
    request.tolerance = 1e-5;
    const auto truth = mie::average_matrix(request);
    request.tolerance = 1e-2;
    const auto whole = mie::average_matrix(request);
    request.phase_tolerance = std::numeric_limits<double>::infinity();
    const auto matrix = mie::average_matrix(request);
    const double error = difference(matrix, truth);
    CAPTURE(error, matrix.optics.error_estimate, matrix.optics.size_nodes);
    CHECK(matrix.optics.converged);
    CHECK(matrix.optics.size_nodes < whole.optics.size_nodes);
    CHECK(error <= 3 * matrix.optics.error_estimate + truth.optics.error_estimate);
}

TEST_CASE("a series that is cut short has the first coefficients of the whole", "[mie][matrix]") {
    auto request = gamma_of(0.5, 0.1, {1.5, 0});
    const auto whole = mie::average_matrix(request);
    request.highest_moment = 10;
    const auto cut = mie::average_matrix(request);
    REQUIRE(cut.optics.chi.size() == 11);
    REQUIRE(whole.optics.chi.size() > 40);
    for (int l = 0; l <= 10; ++l)
        CHECK(std::abs(cut.expansion.b1[l] - whole.expansion.b1[l]) <= 4e-4 * (2 * l + 1));
}

TEST_CASE("scattering matrices do not depend on who runs the pieces", "[mie][matrix]") {
    const auto request = gamma_of(0.5, 0.1, {1.5, 0});
    const auto backwards = [](int count, const std::function<void(int)>& job) {
        for (int i = count - 1; i >= 0; --i) job(i);
    };
    CHECK(difference(mie::average_matrix(request), mie::average_matrix(request, backwards)) == 0.0);
}

TEST_CASE("scattering matrices of large spheres are refused with their price",
          "[mie][matrix][errors]") {
    const auto request = gamma_of(500, 0.1, {1.5, 0});
    CHECK_THROWS_WITH(mie::average_matrix(request), Catch::Contains("1800") &&
                                                        Catch::Contains(" s and ") &&
                                                        Catch::Contains("0.3 %"));
    auto wrong = gamma_of(0.5, 0.1, {1.5, 0});
    wrong.wavelength_nm = -1;
    CHECK_THROWS_WITH(mie::average_matrix(wrong), Catch::Contains("wavelength_nm"));
}
