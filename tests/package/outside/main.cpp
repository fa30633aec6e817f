// A program outside the project: material, scattering, radiative transfer and surface through the
// installed headers and libraries, checked against numbers that are known otherwise.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <miebrdf/miebrdf.h>

using namespace miebrdf;

namespace {

int failures = 0;

void check(const char* what, double value, double expected, double bound) {
    const bool good = std::abs(value - expected) <= bound;
    std::printf("%s %s: %.6f, expected %.6f within %g\n", good ? "good" : "BAD ", what, value,
                expected, bound);
    failures += !good;
}

}  // namespace

int main() {
    // Malitson's formula for fused silica at 589.3 nm.
    const auto silica = materials::Database::embedded().refractive_index("SiO2");
    check("n of SiO2", silica.at(589.3).real(), 1.4584, 1e-4);

    // Rayleigh's limit: Q_sca = 8/3 x^4 ((m^2 - 1) / (m^2 + 2))^2, next term of order x^2.
    const double x = 1e-3;
    const double rayleigh = 8.0 / 3.0 * std::pow(x, 4) * std::pow(1.25 / 4.25, 2);
    check("Q_sca of a small sphere over Rayleigh's",
          mie::scatter_by_sphere(1.5, x).q_sca / rayleigh, 1.0, 1e-5);

    // Chandrasekhar 1960: an isotropic half-space of albedo 1 reflects everything.
    const Brdf white = solve({.base = medium("isotropic:1")}, {550});
    check("plane albedo of a white half-space", white.albedo({0.3}).at(0, 0), 1.0, 1e-9);

    // Chandrasekhar 1960, ch. V: at albedo a the plane albedo is 1 - H(mu) sqrt(1 - a);
    // H(1) = 1.850098 at a = 0.9 (tests/reference/rte).
    const Brdf grey = solve({.base = medium("isotropic:0.9")}, {550}, {.tolerance = 1e-5});
    check("plane albedo of a grey half-space", grey.albedo({1.0}).at(0, 0),
          1.0 - 1.850098 * std::sqrt(0.1), 1e-5);
    const BrdfValues values = grey.evaluate({{0.5}, {0.5, 1.0}, {0}});
    check("reciprocity", values.at(0, 0, 1, 0), grey.evaluate({{1.0}, {0.5}, {0}}).at(0, 0, 0, 0),
          1e-9);

    // Chen et al. 2013, Table 1.
    Table1Request request;
    request.conventions = {table1_conventions().front()};
    double largest = 0;
    for (const Table1Entry& entry : compute_table1(request).entries) {
        largest = std::max(largest, std::abs(entry.factor - entry.paper.value()));
    }
    check("largest difference from Table 1", largest, 0.0, 0.0035);
    return failures;
}
