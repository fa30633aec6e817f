// Averages over sizes: the library against sphere-by-sphere sums.
#include <fmt/format.h>

#include <cmath>
#include <complex>

#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>
#include "rte/math/legendre.h"
#include "rte/math/quadrature.h"
#include "tools/bench/suites.h"
#include "tools/bench/truth.h"

namespace miebrdf::bench {
namespace {

constexpr double kWavelengthNm = 550;
const mie::SizeDistribution kSizes{};  // the paper's: power law, 50 um, 0.2

double size_parameter(double radius_um) { return 2 * M_PI * radius_um / (1e-3 * kWavelengthNm); }

// Radii and weights of n(r) pi r^2 dr ~ dr / r: Gauss nodes in ln r, or midpoints in r.
math::Quadrature radii(int count, bool gauss) {
    const auto range = mie::radius_range(kSizes);
    math::Quadrature rule;
    if (gauss) {
        rule = math::gauss_legendre(count, std::log(range.smallest_um), std::log(range.largest_um));
        for (double& r : rule.nodes) r = std::exp(r);
        return rule;
    }
    const double step = (range.largest_um - range.smallest_um) / count;
    for (int i = 0; i < count; ++i) {
        rule.nodes.push_back(range.smallest_um + (i + 0.5) * step);
        rule.weights.push_back(step / rule.nodes.back());
    }
    return rule;
}

std::vector<double> sphere_by_sphere(std::complex<double> index, const math::Quadrature& rule) {
    double area = 0, ext = 0, sca = 0, forward = 0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const auto sphere = mie::scatter_by_sphere(index, size_parameter(rule.nodes[i]));
        area += rule.weights[i];
        ext += rule.weights[i] * sphere.q_ext;
        sca += rule.weights[i] * sphere.q_sca;
        forward += rule.weights[i] * sphere.q_sca * sphere.asymmetry;
    }
    return {ext / area, sca / ext, forward / sca};
}

const std::vector<int> kMoments = {1, 2, 8, 32, 64};

std::vector<double> some_of(const std::vector<double>& chi) {
    std::vector<double> some;
    some.reserve(kMoments.size());
    for (const int l : kMoments) some.push_back(chi[std::size_t(l)] / chi[0]);
    return some;
}

// The textbook way to moments: intensities on Gauss angles, then projected on Legendre polynomials.
std::vector<double> moments_by_angles(std::complex<double> index, const math::Quadrature& sizes,
                                      int angles) {
    const auto rule = math::gauss_legendre(angles, -1.0, 1.0);
    std::vector<double> degrees, phase(rule.nodes.size(), 0.0);
    for (const double x : rule.nodes) degrees.push_back(std::acos(x) * 180 / M_PI);
    for (std::size_t i = 0; i < sizes.nodes.size(); ++i) {
        const double x = size_parameter(sizes.nodes[i]);
        const auto s = mie::scattering_amplitudes(index, x, degrees);
        for (std::size_t a = 0; a < phase.size(); ++a)
            phase[a] += sizes.weights[i] / (x * x) * (std::norm(s.s1[a]) + std::norm(s.s2[a]));
    }
    Eigen::MatrixXd legendre;
    math::legendre_functions(0, 65, Eigen::VectorXd::Map(rule.nodes.data(), angles), legendre);
    const Eigen::VectorXd sums =
        legendre.transpose() * Eigen::VectorXd::Map(phase.data(), angles)
                                   .cwiseProduct(Eigen::VectorXd::Map(rule.weights.data(), angles));
    return some_of({sums.begin(), sums.end()});
}

mie::EnsembleOptics library(std::complex<double> index, double tolerance, int highest_moment) {
    mie::EnsembleRequest request;
    request.sizes = kSizes;
    request.refractive_index = index;
    request.wavelength_nm = kWavelengthNm;
    request.highest_moment = highest_moment;
    request.tolerance = tolerance;
    return mie::average_over_sizes(request);
}

std::size_t row_of(const ReferenceData& table, std::complex<double> index) {
    return table.row({{"reff", 50.0}, {"lam", 0.55}, {"n", index.real()}, {"k", index.imag()}});
}

constexpr char kTruth[] =
    "tests/reference/mie/poly_*.csv: 25,600 to 204,800 sizes, good to 1e-6 (k = 0) or 1e-12 (k > "
    "0); "
    "extinction at k = 0 by an integral off the real axis.";

BenchCase efficiencies(std::complex<double> index) {
    const ReferenceData table("mie/poly_summary.csv");
    const std::size_t row = row_of(table, index);
    const bool exact = index.imag() == 0;
    BenchCase c{"mie",
                fmt::format("n {} k {}, q_ext albedo g", index.real(), index.imag()),
                "Extinction efficiency, albedo and g of spheres of 50 um at 550 nm.",
                kTruth,
                {table.number(row, exact ? "Qext_contour" : "Qext"), table.number(row, "albedo"),
                 table.number(row, exact ? "g_corr" : "g")}};
    c.add_each("miebrdf", "tol={:.0e}", {1e-2, 1e-3, 1e-4, 1e-5}, [=](double t) {
        const auto optics = library(index, t, 1);
        return std::vector{optics.q_ext, optics.single_scattering_albedo, optics.asymmetry};
    });
    c.add_each("spheres, Gauss in ln r", "{} sizes", {20, 80, 320, 1280},
               [=](int n) { return sphere_by_sphere(index, radii(n, true)); });
    c.add_each("spheres, midpoints in r", "{} sizes", {20, 80, 320, 1280},
               [=](int n) { return sphere_by_sphere(index, radii(n, false)); });
    return c;
}

BenchCase moments(std::complex<double> index) {
    const ReferenceData summary("mie/poly_summary.csv"), table("mie/poly_moments.csv");
    const std::string which = summary.text(row_of(summary, index), "case");
    BenchCase c{"mie", fmt::format("n {} k {}, moments", index.real(), index.imag()),
                "Legendre moments 1, 2, 8, 32, 64 (of 64 computed) of spheres of 50 um at 550 nm.",
                kTruth};
    for (const int l : kMoments)
        c.true_values.push_back(table.number("chi_l", {{"case", which}, {"l", double(l)}}));
    c.add_each("miebrdf", "tol={:.0e}", {1e-2, 1e-3, 1e-4, 1e-5},
               [=](double t) { return some_of(library(index, t, 64).chi); });
    // Twice as many angles as partial waves of the largest sphere integrate |S|^2 exactly.
    c.add_each("angles, midpoints in r", "{} sizes", {5, 20, 80},
               [=](int n) { return moments_by_angles(index, radii(n, false), 2400); });
    return c;
}

}  // namespace

std::vector<BenchCase> mie_suite() {
    return {efficiencies({2.6, 0.0}), efficiencies({3.3, 0.02}), moments({2.6, 0.0}),
            moments({3.3, 0.02})};
}

}  // namespace miebrdf::bench
