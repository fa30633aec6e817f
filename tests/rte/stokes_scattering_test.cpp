#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include "rte/first_order/meridian_planes.h"
#include "rte/math/wigner.h"
#include "rte/phase/polarisation.h"
#include "rte/stack/stack_solver.h"
#include "rte/stokes/stokes_mode.h"
#include "tests/rte/stokes_media.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::siewert_optics;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Single scattering by the sum over Fourier orders of the functions of a block, (I, Q, U).
Eigen::Matrix3d fourier_sum(const rte::Optics& optics, int degrees, double mu_in, double mu_out,
                            double azimuth_deg) {
    // The nodes play no part but that order 0 must be left orthogonal by their rule.
    const rte::ZenithGrid grid = rte::make_gauss_grid(degrees + 2);
    const rte::RequestedDirections cosines = rte::collect({mu_in}, {mu_out});
    const rte::Stack stack{.base = optics};
    const auto strengths = rte::matrix_strengths(rte::scale_stack(stack, degrees, false).media[0]);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int m = 0; m < degrees; ++m) {
        rte::StokesTables tables;
        rte::make_stokes_tables(m, degrees, grid, cosines, tables);
        for (const rte::StokesBlock& block : rte::stokes_blocks(m, 3, false)) {
            const int c = int(block.size());
            rte::FourierMode mode;
            rte::FourierMedium medium;
            rte::make_block_mode(tables, block, strengths, rte::repeated(grid, c),
                                 rte::repeated(cosines, c), mode, medium);
            const rte::RequestedDirections requested = rte::repeated(cosines, c);
            Eigen::MatrixXd at_out, at_in;
            rte::gather_rows(mode.at_requested, requested.out, at_out);
            rte::gather_rows(mode.at_requested, requested.in, at_in);
            const Eigen::MatrixXd R =
                at_out * rte::alternating(medium.strengths).asDiagonal() * at_in.transpose();
            for (int row = 0; row < c; ++row) {
                for (int column = 0; column < c; ++column) {
                    const int r = int(block[std::size_t(row)]), k = int(block[std::size_t(column)]);
                    const double physical = k == 2 ? -R(row, column) : R(row, column);  // D4
                    const double angle = m * azimuth_deg * kDegree;
                    const bool is_diagonal = (r < 2) == (k < 2);
                    const double turn =
                        is_diagonal ? std::cos(angle) : (r > k ? 1.0 : -1.0) * std::sin(angle);
                    sum(r, k) += (m == 0 ? 1.0 : 2.0) * turn * physical;
                }
            }
        }
    }
    return sum;
}

}  // namespace

TEST_CASE("the sum over Fourier orders is the scattering matrix between meridian planes",
          "[rte][stokes]") {
    const rte::Optics optics = siewert_optics(false);
    const double mu_in = GENERATE(0.02, 0.3, 1.0), mu_out = GENERATE(0.3, 0.8, 1.0);
    for (const double azimuth_deg : {0.0, 40.0, 135.0, 180.0, 270.0}) {
        const double cosine =
            -mu_in * mu_out + std::sqrt((1 - mu_in * mu_in) * (1 - mu_out * mu_out)) *
                                  std::cos(azimuth_deg * kDegree);
        const Eigen::Matrix4d turned = rte::turned_to_meridians(
            rte::exact_matrix(optics, std::max(-1.0, cosine)), mu_in, mu_out, azimuth_deg);
        const Eigen::Matrix3d expected =
            optics.single_scattering_albedo * turned.topLeftCorner<3, 3>();
        const Eigen::Matrix3d sum = fourier_sum(optics, 12, mu_in, mu_out, azimuth_deg);
        CAPTURE(mu_in, mu_out, azimuth_deg);
        CHECK((sum - expected).cwiseAbs().maxCoeff() <= 1e-14 * 12);  // of terms up to 3.7
    }
}

TEST_CASE("turning keeps its digits next to backscattering", "[rte][stokes]") {
    // With b1 = 0 and a2 = -a3, as straight back, nothing depends on the plane of scattering.
    const rte::ScatteringMatrix back{.a1 = 1.0, .a2 = 0.7, .a3 = -0.7, .a4 = -0.4};
    const Eigen::Matrix4d there = rte::turned_to_meridians(back, 0.6, 0.6, 180.0);
    for (const double offset : {1e-15, 1e-12, 1e-9, 1e-7}) {
        const Eigen::Matrix4d beside =
            rte::turned_to_meridians(back, 0.6 + offset, 0.6, 180.0 + 37.0 * offset);
        CHECK((beside - there).cwiseAbs().maxCoeff() <= 1e-14 + 100.0 * offset);
    }
    CHECK((there.diagonal() - Eigen::Vector4d(1.0, 0.7, -0.7, -0.4)).cwiseAbs().maxCoeff() <=
          1e-15);
}

TEST_CASE("Rayleigh's coefficients add up to Rayleigh's matrix", "[rte][stokes]") {
    const double rho = GENERATE(0.0, 0.0279);
    const double strength = (1 - rho) / (1 + rho / 2), circular = (1 - 2 * rho) / (1 - rho);
    const rte::Optics optics = rte::rayleigh_optics(1.0, rho);
    for (const double x : {-1.0, -0.3, 0.0, 0.8, 1.0}) {
        const rte::ScatteringMatrix F = rte::exact_matrix(optics, x);
        CHECK(F.a1 == Approx(0.75 * strength * (1 + x * x) + 1 - strength).margin(1e-15));
        CHECK(F.a2 == Approx(0.75 * strength * (1 + x * x)).margin(1e-15));
        CHECK(F.a3 == Approx(1.5 * strength * x).margin(1e-15));
        CHECK(F.a4 == Approx(1.5 * strength * circular * x).margin(1e-15));
        CHECK(F.b1 == Approx(-0.75 * strength * (1 - x * x)).margin(1e-15));
        CHECK(F.b2 == 0.0);
    }
}

TEST_CASE("mixtures polarise by their shares of the scattering", "[rte][stokes]") {
    const rte::Optics mixture = rte::mix({{rte::rayleigh_optics(1.0), 1.0},
                                          {rte::isotropic_optics(0.5), 2.0},
                                          {siewert_optics(true), 0.0}});
    REQUIRE(mixture.polarisation);
    for (const double x : {-0.7, 0.2}) {
        const rte::ScatteringMatrix F = rte::exact_matrix(mixture, x);
        const rte::ScatteringMatrix rayleigh = rte::exact_matrix(rte::rayleigh_optics(1.0), x);
        CHECK(F.a1 == Approx(0.5 * (rayleigh.a1 + 1.0)));
        CHECK(F.b1 == Approx(0.5 * rayleigh.b1));
        CHECK(F.a3 == Approx(0.5 * rayleigh.a3));
        CHECK(F.b2 == Approx(0.0).margin(1e-15));
    }
}

TEST_CASE("coefficients that cannot be are refused by name", "[rte][stokes][errors]") {
    rte::Optics optics = rte::rayleigh_optics(0.5);
    rte::Polarisation wrong = *optics.polarisation;
    wrong.b1 = {0.0, 0.1};
    optics.polarisation = std::make_shared<const rte::Polarisation>(wrong);
    CHECK_THROWS_WITH(rte::validate(optics), Catch::Contains("b1[1]"));
    wrong.b1 = {0.0, 0.0, std::nan("")};
    optics.polarisation = std::make_shared<const rte::Polarisation>(wrong);
    CHECK_THROWS_WITH(rte::validate(optics), Catch::Contains("b1[2]"));
    CHECK_THROWS_AS(rte::rayleigh_optics(0.5, 0.9), UsageError);
}

TEST_CASE("Wigner's functions are orthogonal and known in closed form", "[rte][stokes]") {
    const rte::ZenithGrid half = rte::make_gauss_grid(40);
    Eigen::VectorXd x(80), w(80);
    x << half.mu, -half.mu;
    w << half.weights, half.weights;
    const struct { int m, n; } orders[] = {{0, 0}, {3, 2}, {2, -2}, {1, 2}, {25, 2}, {7, -2}};
    for (const auto& [m, n] : orders) {
        Eigen::MatrixXd table;
        math::wigner_functions(m, n, 30, x, table);
        const Eigen::MatrixXd norm = table.transpose() * w.asDiagonal() * table;
        const int first = std::max(std::abs(m), std::abs(n));
        CAPTURE(m, n);
        for (Eigen::Index j = 0; j < norm.cols(); ++j) {
            const double expected = 2.0 / (2.0 * double(first + j) + 1.0);
            for (Eigen::Index i = 0; i < norm.rows(); ++i)
                CHECK(std::abs(norm(i, j) - (i == j ? expected : 0.0)) <= 1e-14);
        }
    }
    const std::vector<double> second{0.0, 0.0, 1.0};
    CHECK(math::wigner_series(0, 2, second, 0.3) == Approx(std::sqrt(6.0) / 4.0 * (1 - 0.09)));
    CHECK(math::wigner_series(2, 2, second, 0.3) == Approx(0.25 * 1.3 * 1.3));
    CHECK(math::wigner_series(2, -2, second, 0.3) == Approx(0.25 * 0.7 * 0.7));
}
