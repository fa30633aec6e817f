// White paint as formulators compute it: coefficients, Kubelka and Munk's films, Saunderson's
// boundary, beside exact transfer (tests/reference/mixture/km.csv).
#include <miebrdf/brdf.h>

#include <Eigen/LU>
#include <cmath>

#include "rte/math/quadrature.h"
#include "tests/support/catch.h"
#include "tests/support/reference_table.h"

using namespace miebrdf;
using support::ReferenceTable;

namespace {

constexpr double kBinder = 1.5;

/// The table's carbon, of unknown index, as what it does: its absorption, K / 2, put into the
/// binder. (It also adds .07 % to mu_s', which changes no reflectance by more than 1e-4.)
Medium paint(double absorption_per_um) {
    const double k = absorption_per_um * 0.55 / (4 * M_PI) / 0.85;
    Medium paint = medium(
        "index:2.75,0,radius=0.13,distribution=log-normal,variance=0.05,volume=15% in index:1.5");
    paint.host->index = {kBinder, k};
    return paint;
}

/// The extinction of the pigment that the table has, in 1/um. Its own words give 3.4297 (sum over
/// 6,000 spheres; this library to 1e-5): films are thicker by that, and coefficients smaller.
constexpr double kExtinction = 3.4605;
constexpr double kThicker = kExtinction / 3.4297;

Scene film_of(const ReferenceTable& table, std::size_t row) {
    const double absorption = 0.5 * table.number(row, "k_km");
    Scene film;
    film.substrate = substrate("lambert:" + table.text(row, "ground"));
    film.layers = {{paint(absorption / kThicker),
                    Depth((kExtinction + absorption) * table.number(row, "thickness_um"))}};
    return film;
}

Brdf solved(const Scene& film, double tolerance) {
    // One Mie run for all films.
    static const Control control{.memo = make_optics_memo()};
    return solve(film, {550}, {.tolerance = tolerance}, control);
}

/// Fresnel's reflectance of unpolarised light, from the cosine in the air (mu_air) and in the
/// binder.
double fresnel(double mu_air, double mu) {
    const double s = (mu_air - kBinder * mu) / (mu_air + kBinder * mu);
    const double p = (kBinder * mu_air - mu) / (kBinder * mu_air + mu);
    return 0.5 * (s * s + p * p);
}
double inside(double mu) {
    const double squared = 1 - kBinder * kBinder * (1 - mu * mu);
    return squared <= 0 ? 1.0 : fresnel(std::sqrt(squared), mu);
}

/// 2 integral r mu dmu, of uniform light: from outside or from within.
double mean_reflectance(bool from_within) {
    const double critical = std::sqrt(1 - 1 / (kBinder * kBinder));
    const auto rule = math::gauss_legendre(200, from_within ? critical : 0.0, 1.0);
    double sum = from_within ? critical * critical : 0.0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double mu = rule.nodes[i];
        const double within = std::sqrt(1 - (1 - mu * mu) / (kBinder * kBinder));
        sum += 2 * rule.weights[i] * mu * (from_within ? inside(mu) : fresnel(mu, within));
    }
    return sum;
}

/// Kubelka and Munk's film over a ground.
double kubelka_munk(double s, double k, double h, double ground) {
    if (k == 0.0) return ((1 - ground) * s * h + ground) / ((1 - ground) * s * h + 1);
    const double a = 1 + k / s, b = std::sqrt(a * a - 1), coth = 1 / std::tanh(b * s * h);
    return (1 - ground * (a - b * coth)) / (a - ground + b * coth);
}
double saunderson(double film, double k1, double k2) {
    return k1 + (1 - k1) * (1 - k2) * film / (1 - k2 * film);
}

struct Albedos {
    double normal, diffuse;
};

/// The film under a smooth boundary: its reflection at nodes within, and the light that the
/// boundary throws back, summed as a geometric series of matrices.
Albedos under_boundary(const Scene& film) {
    const double critical = std::sqrt(1 - 1 / (kBinder * kBinder));
    const auto flat = math::gauss_legendre(24, 0.0, critical);
    const auto steep = math::gauss_legendre(24, critical, 1.0);
    std::vector<double> mu = flat.nodes, weight = flat.weights;
    mu.insert(mu.end(), steep.nodes.begin(), steep.nodes.end());
    weight.insert(weight.end(), steep.weights.begin(), steep.weights.end());
    std::vector<double> in = mu;
    in.push_back(1.0);
    constexpr int kAzimuths = 16;  // of a phase function of few moments
    Directions directions{in, mu, {}};
    for (int a = 0; a < kAzimuths; ++a)
        directions.azimuth_deg.push_back((a + 0.5) * 180 / kAzimuths);
    const BrdfValues values = solved(film, 1e-3).evaluate(directions);
    const auto n = static_cast<Eigen::Index>(mu.size());
    Eigen::MatrixXd R = Eigen::MatrixXd::Zero(n, n + 1);  // row = outgoing
    for (Eigen::Index o = 0; o < n; ++o) {
        for (Eigen::Index i = 0; i <= n; ++i) {
            for (std::size_t a = 0; a < kAzimuths; ++a)
                R(o, i) += M_PI / kAzimuths * values.at(0, std::size_t(i), std::size_t(o), a);
        }
    }
    Eigen::VectorXd W(n), r(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        W[i] = 2 * weight[std::size_t(i)] * mu[std::size_t(i)];
        r[i] = inside(mu[std::size_t(i)]);
    }
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(n);
    const Eigen::MatrixXd square = R.leftCols(n) * W.asDiagonal();
    const auto series = (Eigen::MatrixXd::Identity(n, n) - square * r.asDiagonal()).partialPivLu();
    const auto leaving = [&](const Eigen::VectorXd& first) -> double {
        return W.dot((one - r).cwiseProduct(series.solve(first)));
    };
    const double at_normal = fresnel(1.0, 1.0);
    // pi times radiances of unit irradiance: a uniform sky's is n^2 times more within.
    const Eigen::VectorXd sky = kBinder * kBinder * (one - r);
    return {at_normal + leaving((1 - at_normal) * R.col(n)),
            mean_reflectance(false) + leaving(square * sky)};
}

}  // namespace

TEST_CASE("coefficients of white paint are those of the table", "[pipeline][mixture]") {
    const ReferenceTable table("mixture/km.csv");
    for (std::size_t r = 0; r < table.size(); r += 12) {
        CAPTURE(table.text(r, "carbon"));
        const LayerOptics layer = solved(film_of(table, r), 1e-4).layers()[0];
        const double mu_s = table.number(r, "reduced_scattering"), s = table.number(r, "s_km");
        CHECK(std::abs(*layer.scattering_per_um - 3.4297) <= 1e-4 * 3.4297);
        const double ours = kThicker * *layer.reduced_scattering_per_um;
        CHECK(std::abs(ours - mu_s) <= 1e-3 * mu_s);
        CHECK(std::abs(0.75 * ours - 0.25 * kThicker * *layer.absorption_per_um - s) <= 1e-3 * s);
        // Five and six decimals.
        CHECK(std::abs(kThicker * *layer.absorption_per_um - table.number(r, "absorption")) <=
              6e-6);
        CHECK(std::abs(kThicker * *layer.k_km - table.number(r, "k_km")) <= 1.1e-5);
    }
}

TEST_CASE("Kubelka and Munk's films with Saunderson's boundary are those of the table",
          "[pipeline][mixture]") {
    const ReferenceTable table("mixture/km.csv");
    const double r_out = mean_reflectance(false), r_in = mean_reflectance(true);
    // Duntley's closed form gives .0918 for index 1.5; r_in = 1 - (1 - r_out) / n^2.
    CHECK(std::abs(r_out - 0.0918) <= 5e-5);
    CHECK(std::abs(r_in - (1 - (1 - r_out) / (kBinder * kBinder))) <= 1e-6);
    for (std::size_t r = 0; r < table.size(); ++r) {
        CAPTURE(r);
        const LayerOptics layer = solved(film_of(table, r), 1e-4).layers()[0];
        const double s_km =
            0.75 * kExtinction * (1 - layer.asymmetry) - 0.25 * kThicker * *layer.absorption_per_um;
        const double film =
            kubelka_munk(s_km, kThicker * *layer.k_km, table.number(r, "thickness_um"),
                         table.number(r, "ground"));
        CHECK(std::abs(saunderson(film, 0.04, r_in) - table.number(r, "km_normal")) <= 1e-3);
        CHECK(std::abs(saunderson(film, r_out, r_in) - table.number(r, "km_diffuse")) <= 1e-3);
    }
}

TEST_CASE("films under a smooth boundary have the table's exact albedos", "[pipeline][mixture]") {
    const ReferenceTable table("mixture/km.csv");
    for (std::size_t r = 0; r < table.size(); ++r) {
        const Albedos ours = under_boundary(film_of(table, r));
        CAPTURE(r, ours.normal, ours.diffuse);
        CHECK(std::abs(ours.normal - table.number(r, "exact_normal")) <= 1e-3);
        CHECK(std::abs(ours.diffuse - table.number(r, "exact_diffuse")) <= 1e-3);
    }
}
