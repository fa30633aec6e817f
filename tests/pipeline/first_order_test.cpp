#include "pipeline/solve/first_order.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "rte/stack/stack_solver.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

// Half of the light in a smooth background, half in a diffraction peak, and a glory of alternating
// high moments around degree `glory`; 300 moments in all.
rte::Optics glory_optics(double albedo, double glory) {
    rte::Optics optics = rte::isotropic_optics(albedo);
    optics.chi.resize(300);
    for (int l = 0; l < 300; ++l) {
        optics.chi[std::size_t(l)] =
            0.5 * std::pow(0.3, l) + 0.5 * std::exp(-std::pow(l / 90.0, 2)) +
            (l > 20 ? 0.004 * (l % 2 ? -1 : 1) * std::exp(-std::pow((l - glory) / 25.0, 2)) : 0.0);
    }
    optics.chi[0] = 1.0;
    return optics;
}

std::vector<rte::ScaledMedium> media_of(const rte::Stack& stack) {
    return rte::scale_stack(stack, 24, true).media;
}

}  // namespace

TEST_CASE("many wavelengths at once are each wavelength's own first order",
          "[pipeline][first_order]") {
    // A coat, two coats and a bare base; glories of different widths; a sharp forward peak.
    const rte::Optics sharp = rte::henyey_greenstein_optics(0.6, 0.97);
    const std::vector<std::vector<rte::ScaledMedium>> stacks = {
        media_of({.base = glory_optics(0.9, 90), .coats = {{sharp, 0.1}}}),
        media_of({.base = sharp, .coats = {{glory_optics(1.0, 140), 0.7}, {sharp, 0.02}}}),
        media_of({.base = glory_optics(0.3, 110)}),
    };
    const bool exact = GENERATE(true, false);
    const double tolerance = GENERATE(1e-3, 1e-5);
    const FirstOrder together(stacks, exact, tolerance);
    REQUIRE(together.wavelengths() == 3);
    // The same sums over moments, at each direction itself.
    std::vector<rte::NarrowFeatures> features;
    for (const auto& media : stacks) features.push_back({{&media, 1}, 0.005, 1e-9});
    std::mt19937_64 engine(5);
    const auto uniform = [&] { return (double(engine() >> 12) + 0.5) * 0x1p-52; };
    double largest_narrow = 0.0, largest_excess = 0.0;
    for (int i = 0; i < 300; ++i) {
        const double mu_in = 0.005 + 0.995 * uniform(), mu_out = 0.005 + 0.995 * uniform();
        const std::vector<double> cos_azimuth = {2 * uniform() - 1, -1.0, 1.0};
        std::vector<double> found(9);
        together.evaluate(mu_in, mu_out, cos_azimuth, found);
        for (std::size_t w = 0; w < 3; ++w) {
            for (std::size_t a = 0; a < 3; ++a) {
                double narrow = 0.0;
                if (exact)
                    features[w].add_to(&narrow, {&mu_in, 1}, {&mu_out, 1}, {&cos_azimuth[a], 1});
                const double scattered =
                    rte::single_scattering(stacks[w], exact, mu_in, mu_out, cos_azimuth[a]);
                // Phase functions to 0.01 of the tolerance, relative, of which terms that follow
                // the two looked at may take twice; narrow features to 0.1, absolute before the
                // division by 4 (mu_in + mu_out), six times (interpolation in q, ranks, panels).
                const double allowed = 0.02 * tolerance * std::abs(scattered) +
                                       0.6 * tolerance / (4 * (mu_in + mu_out));
                largest_narrow = std::max(largest_narrow, std::abs(narrow));
                largest_excess = std::max(
                    largest_excess, std::abs(found[a * 3 + w] - scattered - narrow) / allowed);
            }
        }
    }
    CHECK(largest_excess <= 1.0);
    if (exact) CHECK(largest_narrow >= 0.1);
}

TEST_CASE("the first order has the same bits wherever the caller keeps it",
          "[pipeline][first_order]") {
    // Eleven wavelengths are no whole number of vectors. Only builds whose vectors are wider than
    // what memory is aligned to can fail.
    const rte::Optics sharp = rte::henyey_greenstein_optics(0.6, 0.97);
    std::vector<std::vector<rte::ScaledMedium>> stacks;
    for (int w = 0; w < 11; ++w)
        stacks.push_back(media_of({.base = glory_optics(0.9, 90 + w), .coats = {{sharp, 0.1}}}));
    const FirstOrder first_order(stacks, true, 1e-3);
    const std::vector<double> cos_azimuth = {-0.9, -0.3, 0.2, 0.8, 1.0};
    const std::size_t count = stacks.size() * cos_azimuth.size();
    std::vector<double> memory(count + 8), reference(count);
    for (const double mu_in : {0.1, 0.37, 0.9}) {
        first_order.evaluate(mu_in, 0.6, cos_azimuth, reference);
        for (std::size_t offset = 0; offset < 8; ++offset) {
            const std::span<double> found(&memory[offset], count);
            first_order.evaluate(mu_in, 0.6, cos_azimuth, found);
            CAPTURE(mu_in, offset);
            CHECK(std::equal(found.begin(), found.end(), reference.begin()));
        }
    }
}

TEST_CASE("nothing scatters once in no layers", "[pipeline][first_order]") {
    const FirstOrder none({{}, {}}, true, 1e-3);
    const double cos_azimuth = 0.5;
    double found[2] = {1.0, 1.0};
    none.evaluate(0.5, 0.5, {&cos_azimuth, 1}, found);
    CHECK(found[0] == 0.0);
    CHECK(found[1] == 0.0);
}
