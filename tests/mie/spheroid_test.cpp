// Spheroids in random orientation against spheres, closed forms, tables of other programs, and
// physics.
#include "mie/spheroid/orientation_average.h"
#include "mie/spheroid/t_matrix.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>
#include "rte/math/quadrature.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

using Complex = std::complex<double>;

}  // namespace

TEST_CASE("spheroids nearly round scatter as spheres do, with all of the matrix",
          "[mie][spheroid]") {
    const Complex index = GENERATE(Complex(1.5), Complex(1.33, 0.1), Complex(0.2, 3.0));
    const double x = GENERATE(0.1, 1.0, 5.0, 20.0);
    const mie::TMatrix T = mie::t_matrix({index, x, 1.0}, 1e-11);
    const mie::SphereOptics sphere = mie::scatter_by_sphere(index, x);
    CAPTURE(index, x, T.degree, T.error_estimate, T.q_ext, sphere.q_ext);
    CHECK(std::abs(T.q_ext / sphere.q_ext - 1) <= 1e-10);
    CHECK(std::abs(T.q_sca / sphere.q_sca - 1) <= 1e-10);
    const std::vector<double> angles = {0, 10, 60, 90, 140, 180};
    const mie::Amplitudes S = mie::scattering_amplitudes(index, x, angles);
    Eigen::VectorXd cosines(6);
    for (int i = 0; i < 6; ++i) cosines[i] = mie::cosine_of_scattering_angle(angles[i]);
    const Eigen::MatrixXd matrix = mie::orientation_average(T, cosines);
    const double scale = 2 * (std::norm(S.s1[0]) + std::norm(S.s2[0]));
    for (int i = 0; i < 6; ++i) {
        CAPTURE(angles[i], matrix.row(i));
        const double a1 = 2 * (std::norm(S.s1[i]) + std::norm(S.s2[i]));
        const double b1 = 2 * (std::norm(S.s2[i]) - std::norm(S.s1[i]));
        const Complex product = 4.0 * S.s1[i] * std::conj(S.s2[i]);
        const double a3 = product.real(), b2 = -product.imag();
        CAPTURE(a1, a3, a1 + a3, a1 - a3, b1, b2);
        CHECK(std::abs(matrix(i, 0) - a1) <= 1e-10 * scale);
        CHECK(std::abs(matrix(i, 1) - a3) <= 1e-10 * scale);
        CHECK(std::abs(matrix(i, 2) - a1 - a3) <= 1e-10 * scale);
        CHECK(std::abs(matrix(i, 3) - a1 + a3) <= 1e-10 * scale);
        CHECK(std::abs(matrix(i, 4) - b1) <= 1e-10 * scale);
        CHECK(std::abs(matrix(i, 5) - b2) <= 1e-10 * scale);
    }
}

TEST_CASE("an elongated spheroid has the cross-sections that SMARTIES prints", "[mie][spheroid]") {
    // Semi-axes 1 and 10, k = 1: output of ScriptTutorial in SMARTIES 1.1 (Somerville, Auguie & Le
    // Ru 2016, JQSRT 174, 39), whose two runs agree to 13 digits.
    const double x = std::cbrt(10.0), area = std::numbers::pi * x * x;
    const mie::TMatrix T = mie::t_matrix_of_degree({{1.5, 0.02}, x, 0.1}, 36, 130);
    CAPTURE(T.error_estimate, T.q_ext * area, T.q_sca * area);
    CHECK(std::abs(T.q_ext * area / 18.737732166309676 - 1) <= 1e-12);
    CHECK(std::abs(T.q_sca * area / 16.601204532914721 - 1) <= 1e-12);
}

TEST_CASE("the T-matrix of a spheroid is reciprocal and conserves energy", "[mie][spheroid]") {
    const double aspect = GENERATE(1.0 / 3, 0.5, 0.9, 1.5, 3.0);
    const double index = GENERATE(1.1, 1.33, 1.53, 2.5);
    const mie::TMatrix T = mie::t_matrix({index, 4.0, aspect}, 1e-9);
    CAPTURE(aspect, index, T.degree, T.error_estimate, T.q_ext, T.q_sca);
    CHECK(T.error_estimate <= 1e-9);
    CHECK(std::abs(T.q_sca / T.q_ext - 1) <= 1e-12);
}

TEST_CASE("spheroids small beside the wavelength have Gans's polarisabilities", "[mie][spheroid]") {
    // Bohren & Huffman 1983, eq. 5.32-5.34: q_abs = 4 x Im sum (m^2-1) / (3 + 3 L (m^2-1)) / 3,
    // q_sca = 8/3 x^4 times the mean of the squared moduli; the next order is x^2 smaller.
    const Complex index = GENERATE(Complex(1.5, 0.1), Complex(0.3, 2.5));
    const double aspect = GENERATE(0.3, 0.6, 1.7, 3.0);
    const double x = 1e-3, a = std::max(aspect, 1 / aspect);
    const double e = std::sqrt(1 - 1 / (a * a)), g = std::sqrt(1 - e * e) / e;
    const double polar = aspect < 1
                             ? (1 - e * e) / (e * e) * (std::atanh(e) / e - 1)
                             : 1 - g / (e * e) * (std::numbers::pi / 2 - std::atan(g)) + g * g;
    const double L = polar;
    Complex sum = 0;
    double squares = 0;
    for (const double l : {L, (1 - L) / 2, (1 - L) / 2}) {
        const Complex alpha = (index * index - 1.0) / (3.0 + 3.0 * l * (index * index - 1.0));
        sum += alpha;
        squares += std::norm(alpha) / 3;
    }
    const mie::TMatrix T = mie::t_matrix({index, x, aspect}, 1e-9);
    CAPTURE(index, aspect, T.degree, T.error_estimate);
    CHECK(std::abs((T.q_ext - T.q_sca) / (4 * x * sum.imag() / 3) - 1) <= 100 * x * x);
    CHECK(std::abs(T.q_sca / (8.0 / 3 * std::pow(x, 4) * squares) - 1) <= 100 * x * x);
}

namespace {

/// For radii of spheres of equal surface area, those of equal volume are smaller by this factor.
double volume_over_surface_radius(double aspect) {
    const double e = std::sqrt(1 - 1 / (aspect * aspect));  // oblate, polar axis 1
    const double area = 2 * std::numbers::pi * (aspect * aspect + std::atanh(e) / e);
    return std::cbrt(aspect * aspect) / std::sqrt(area / (4 * std::numbers::pi));
}

/// The accuracy of 1e-3 with which the program was run leaves this in coefficients.
constexpr double kPrinted = 5e-4;
/// One unit of the last of six digits.
constexpr double kLastDigit = 1e-6;

struct Row {
    double a1, a2, a3, a4, b1, b2;
};

}  // namespace

TEST_CASE("oblate spheroids have the coefficients of Kuik, de Haan and Hovenier",
          "[mie][spheroid]") {
    // Problem IIA of Siewert 2000 (tests/reference/rte/stokes_siewert_2000.csv), after Kuik et al.
    // 1992 (JQSRT 47, 477): equatorial size parameter 3, aspect 1.999987, 1.53 + 0.006i; all of its
    // six digits.
    mie::EnsembleRequest request;
    request.sizes.kind = mie::SizeDistributionKind::mono;
    request.aspect = 1.999987;
    request.wavelength_nm = 1000;
    request.sizes.effective_radius_um = 3 / (2 * std::numbers::pi * std::cbrt(*request.aspect));
    request.refractive_index = {1.53, 0.006};
    request.tolerance = 1e-8;
    const mie::MatrixOptics spheroid = mie::average_matrix(request);
    CAPTURE(spheroid.optics.error_estimate, spheroid.optics.single_scattering_albedo);
    CHECK(spheroid.optics.converged);
    CHECK(std::abs(spheroid.optics.single_scattering_albedo - 0.973527) <= kLastDigit);
    const Row rows[] = {{1.000000, 0.000000, 0.000000, 0.915207, 0.000000, 0.000000},
                        {2.104031, 0.000000, 0.000000, 2.095727, 0.000000, 0.000000},
                        {2.095158, 3.726079, 3.615946, 2.008624, -0.116688, 0.065456},
                        {1.414939, 2.202868, 2.240516, 1.436545, -0.209370, 0.221658},
                        {0.703593, 1.190694, 1.139473, 0.706244, -0.227137, 0.097752},
                        {0.235001, 0.391203, 0.365605, 0.238475, -0.144524, 0.052458},
                        {0.064039, 0.105556, 0.082779, 0.056448, -0.052640, 0.009239},
                        {0.012837, 0.020484, 0.013649, 0.009703, -0.012400, 0.001411},
                        {0.002010, 0.003097, 0.001721, 0.001267, -0.002093, 0.000133},
                        {0.000246, 0.000366, 0.000172, 0.000130, -0.000267, 0.000011},
                        {0.000024, 0.000035, 0.000014, 0.000011, -0.000027, 0.000001},
                        {0.000002, 0.000003, 0.000001, 0.000001, -0.000002, 0.000000}};
    const MatrixExpansion& e = spheroid.expansion;
    for (std::size_t l = 0; l < std::size(rows); ++l) {
        const double a1 = (2.0 * double(l) + 1.0) * spheroid.optics.chi[l];
        CAPTURE(l, a1, e.a2[l], e.a3[l], e.a4[l], e.b1[l], e.b2[l]);
        CHECK(std::abs(a1 - rows[l].a1) <= kLastDigit);
        CHECK(std::abs(e.a2[l] - rows[l].a2) <= kLastDigit);
        CHECK(std::abs(e.a3[l] - rows[l].a3) <= kLastDigit);
        CHECK(std::abs(e.a4[l] - rows[l].a4) <= kLastDigit);
        CHECK(std::abs(e.b1[l] - rows[l].b1) <= kLastDigit);
        CHECK(std::abs(e.b2[l] - rows[l].b2) <= kLastDigit);
    }
}

TEST_CASE("spheroids of four sizes are those of Mishchenko's program", "[mie][spheroid]") {
    // Output printed at the head of tmd.lp.f (Mishchenko & Travis 1998, JQSRT 60, 309): oblate,
    // aspect 2, 1.53 + 0.008i at 0.5 um, n(r) ~ r^-3 from 0.273383 to 0.826617 um of the sphere of
    // equal surface, at four Gauss nodes. Its T-matrices are good to 1e-3, and so is the table.
    // There b1 and b2 have the other sign, as their functions do.
    const math::Quadrature sizes = math::gauss_legendre(4, 0.273383, 0.826617);
    const double shrink = volume_over_surface_radius(2);
    double weights = 0, extinction = 0, scattering = 0;
    std::vector<double> a1;
    MatrixExpansion sum;
    for (std::size_t i = 0; i < sizes.nodes.size(); ++i) {
        mie::EnsembleRequest request;
        request.sizes.kind = mie::SizeDistributionKind::mono;
        request.aspect = 2;
        request.wavelength_nm = 500;
        request.sizes.effective_radius_um = sizes.nodes[i] * shrink;
        request.refractive_index = {1.53, 0.008};
        request.tolerance = 1e-6;
        const mie::MatrixOptics one = mie::average_matrix(request);
        CHECK(one.optics.converged);
        const double number = sizes.weights[i] * std::pow(sizes.nodes[i], -3);
        const double area = std::numbers::pi * std::pow(sizes.nodes[i] * shrink, 2);
        const double scattered = number * one.optics.q_sca * area;
        weights += number;
        extinction += number * one.optics.q_ext * area;
        scattering += scattered;
        const auto add = [&](const std::vector<double>& list, double two_l,
                             std::vector<double>& all) {
            all.resize(std::max(all.size(), list.size()));
            for (std::size_t l = 0; l < list.size(); ++l)
                all[l] += scattered * (two_l * double(l) + 1.0) * list[l];
        };
        add(one.optics.chi, 2.0, a1);
        for (const auto& [name, list] : kMatrixLists) add(one.expansion.*list, 0.0, sum.*list);
    }
    CHECK(std::abs(extinction / weights - 1.78850) <= 1e-4);
    CHECK(std::abs(scattering / extinction - 0.928793) <= 1e-5);
    const struct {
        std::size_t l;
        Row row;
    } printed[] = {{0, {1.00000, .00000, .00000, .90379, .00000, .00000}},
                   {1, {2.13453, .00000, .00000, 2.15472, .00000, .00000}},
                   {2, {2.87891, 3.89769, 3.76504, 2.88912, -.03603, .17045}},
                   {5, {3.14764, 3.42234, 3.41522, 3.16433, -.04799, -.10996}},
                   {8, {2.28500, 2.47567, 2.43219, 2.28077, -.06222, -.17434}},
                   {12, {1.13893, 1.20071, 1.17446, 1.12740, -.02856, -.11926}},
                   {20, {.12695, .13414, .12897, .12323, -.00758, -.02154}}};
    for (const auto& [l, row] : printed) {
        CAPTURE(l, a1[l] / scattering, sum.b1[l] / scattering, sum.b2[l] / scattering);
        CHECK(std::abs(a1[l] / scattering - row.a1) <= kPrinted);
        CHECK(std::abs(sum.a2[l] / scattering - row.a2) <= kPrinted);
        CHECK(std::abs(sum.a3[l] / scattering - row.a3) <= kPrinted);
        CHECK(std::abs(sum.a4[l] / scattering - row.a4) <= kPrinted);
        CHECK(std::abs(sum.b1[l] / scattering + row.b1) <= kPrinted);
        CHECK(std::abs(sum.b2[l] / scattering + row.b2) <= kPrinted);
    }
}

TEST_CASE("phase tables, angles and moments of spheroids are of one series", "[mie][spheroid]") {
    mie::EnsembleRequest request;
    request.aspect = 0.5;
    request.sizes.kind = mie::SizeDistributionKind::log_normal;
    request.sizes.effective_radius_um = 0.2;
    request.refractive_index = 1.5;
    request.highest_moment = 40;
    request.angles_deg = {0, 17, 90, 180};
    request.with_phase_table = true;
    request.sizes.effective_variance = 0.05;
    request.tolerance = 1e-3;
    const mie::EnsembleOptics o = mie::average_over_sizes(request);
    CAPTURE(o.error_estimate, o.size_nodes, o.phase_table->interpolation_error());
    CHECK(o.converged);
    CHECK(o.one_minus_albedo == 0);
    CHECK(o.chi.size() == 41);
    CHECK(std::abs(o.chi[1] - o.asymmetry) <= 1e-12);
    CHECK(std::abs(o.phase_table->mean() - 1) <= 1e-5);
    for (std::size_t i = 0; i < o.phase.size(); ++i) {
        const double x = mie::cosine_of_scattering_angle(request.angles_deg[i]);
        CHECK(std::abs((*o.phase_table)(x) / o.phase[i] - 1) <= 1e-5);
    }
    const auto moments = o.phase_table->moments(40);
    for (std::size_t l = 0; l < moments.size(); ++l) CHECK(std::abs(moments[l] - o.chi[l]) <= 1e-5);
}

TEST_CASE("spheroids beyond what the T-matrix can do are refused", "[mie][spheroid][errors]") {
    mie::EnsembleRequest request;
    request.sizes.kind = mie::SizeDistributionKind::mono;
    request.sizes.effective_radius_um = 50;
    request.refractive_index = 1.33;
    request.aspect = 0.5;
    CHECK_THROWS_WITH(mie::average_over_sizes(request),
                      Catch::Contains("corrections for the shape"));
    request.sizes.effective_radius_um = 0.1;
    request.aspect = 9;
    CHECK_THROWS_WITH(mie::average_matrix(request),
                      Catch::Contains("9") && Catch::Contains("aspect"));
    request.aspect = 2;
    request.coatings = {{1.5, 0.01}};
    CHECK_THROWS_WITH(mie::average_over_sizes(request), Catch::Contains("coatings"));
}
