// Averages over sizes: the library against sphere-by-sphere sums.
#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <stdexcept>

#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>
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

// The textbook way to moments: intensities on Gauss angles, then projected on Legendre polynomials.
std::vector<double> moments_by_angles(std::complex<double> index, const math::Quadrature& sizes,
                                      int angles) {
    const auto rule = math::gauss_legendre(angles, -1.0, 1.0);
    std::vector<double> degrees, phase(rule.nodes.size(), 0.0);
    for (const double x : rule.nodes) degrees.push_back(std::acos(x) * 180 / M_PI);
    for (std::size_t i = 0; i < sizes.nodes.size(); ++i) {
        const double x = size_parameter(sizes.nodes[i]);
        const auto s = mie::scattering_amplitudes(index, x, degrees);
        for (std::size_t a = 0; a < phase.size(); ++a) {
            phase[a] += sizes.weights[i] / (x * x) * (std::norm(s.s1[a]) + std::norm(s.s2[a]));
        }
    }
    std::vector<double> sums(65, 0.0);
    for (std::size_t a = 0; a < phase.size(); ++a) {
        double before = 1, now = rule.nodes[a];
        for (std::size_t l = 0; l < sums.size(); ++l) {
            sums[l] += rule.weights[a] * phase[a] * before;
            const double next =
                ((2 * double(l) + 3) * rule.nodes[a] * now - (double(l) + 1) * before) /
                (double(l) + 2);
            before = now;
            now = next;
        }
    }
    std::vector<double> chi;
    chi.reserve(std::size(kMoments));
    for (const int l : kMoments) chi.push_back(sums[static_cast<std::size_t>(l)] / sums[0]);
    return chi;
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
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.number(row, "reff") == 50 && table.number(row, "lam") == 0.55 &&
            table.number(row, "n") == index.real() && table.number(row, "k") == index.imag()) {
            return row;
        }
    }
    throw std::logic_error("reference table lacks an ensemble");
}

constexpr char kTruth[] =
    "tests/reference/mie/poly_*.csv: 25,600 to 204,800 sizes, good to 1e-6 (k = 0) or 1e-12 (k > "
    "0); "
    "extinction at k = 0 by an integral off the real axis.";

BenchCase efficiencies(std::complex<double> index) {
    const ReferenceData table("mie/poly_summary.csv");
    const std::size_t row = row_of(table, index);
    BenchCase c;
    c.suite = "mie";
    c.name = fmt::format("n {} k {}, q_ext albedo g", index.real(), index.imag());
    c.quantity = "Extinction efficiency, albedo and g of spheres of 50 um at 550 nm.";
    c.truth = kTruth;
    const bool exact = index.imag() == 0;
    c.true_values = {table.number(row, exact ? "Qext_contour" : "Qext"),
                     table.number(row, "albedo"), table.number(row, exact ? "g_corr" : "g")};
    for (const double t : {1e-2, 1e-3, 1e-4, 1e-5}) {
        c.contenders.push_back({"miebrdf", fmt::format("tol={:.0e}", t), [=] {
                                    const auto optics = library(index, t, 1);
                                    return std::vector<double>{optics.q_ext,
                                                               optics.single_scattering_albedo,
                                                               optics.asymmetry};
                                }});
    }
    for (const int n : {20, 80, 320, 1280}) {
        c.contenders.push_back({"spheres, Gauss in ln r", fmt::format("{} sizes", n),
                                [=] { return sphere_by_sphere(index, radii(n, true)); }});
        c.contenders.push_back({"spheres, midpoints in r", fmt::format("{} sizes", n),
                                [=] { return sphere_by_sphere(index, radii(n, false)); }});
    }
    return c;
}

BenchCase moments(std::complex<double> index) {
    const ReferenceData summary("mie/poly_summary.csv"), table("mie/poly_moments.csv");
    const std::string which = summary.text(row_of(summary, index), "case");
    BenchCase c;
    c.suite = "mie";
    c.name = fmt::format("n {} k {}, moments", index.real(), index.imag());
    c.quantity = "Legendre moments 1, 2, 8, 32, 64 (of 64 computed) of spheres of 50 um at 550 nm.";
    c.truth = kTruth;
    for (const int l : kMoments) {
        for (std::size_t row = 0; row < table.size(); ++row) {
            if (table.text(row, "case") == which && table.number(row, "l") == l) {
                c.true_values.push_back(table.number(row, "chi_l"));
            }
        }
    }
    for (const double t : {1e-2, 1e-3, 1e-4, 1e-5}) {
        c.contenders.push_back({"miebrdf", fmt::format("tol={:.0e}", t), [=] {
                                    const auto optics = library(index, t, 64);
                                    std::vector<double> chi;
                                    chi.reserve(std::size(kMoments));
                                    for (const int l : kMoments)
                                        chi.push_back(optics.chi[static_cast<std::size_t>(l)]);
                                    return chi;
                                }});
    }
    for (const int n : {5, 20, 80}) {
        // Twice as many angles as partial waves of the largest sphere integrate |S|^2 exactly.
        c.contenders.push_back({"angles, midpoints in r", fmt::format("{} sizes", n),
                                [=] { return moments_by_angles(index, radii(n, false), 2400); }});
    }
    return c;
}

}  // namespace

std::vector<BenchCase> mie_suite() {
    return {efficiencies({2.6, 0.0}), efficiencies({3.3, 0.02}), moments({2.6, 0.0}),
            moments({3.3, 0.02})};
}

}  // namespace miebrdf::bench
