#include "rte/first_order/spectral_first_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <random>

#include "rte/boundary/smooth_boundary.h"
#include "rte/first_order/first_order_sum.h"
#include "rte/stack/scaled_stack.h"
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

// With the narrow features beyond delta-M.
rte::ScaledStack scaled(const rte::Stack& stack) {
    rte::ScaledStack own = rte::scale_stack(stack, 24, true);
    for (rte::ScaledMedium& medium : own.media)
        medium.narrow = rte::split_forward_peak(medium.exact.chi, medium.scaled.first_cutoff);
    return own;
}

std::vector<rte::SpectralFirstOrder::Wavelength> wavelengths_of(
    const std::vector<rte::ScaledStack>& stacks, bool is_polarised = false) {
    std::vector<rte::SpectralFirstOrder::Wavelength> list;
    for (const rte::ScaledStack& stack : stacks) list.push_back({&stack, is_polarised});
    return list;
}

}  // namespace

TEST_CASE("many wavelengths at once are each wavelength's own first order", "[rte][first_order]") {
    // A coat, two coats and a bare base; glories of different widths; a sharp forward peak.
    const rte::Optics sharp = rte::henyey_greenstein_optics(0.6, 0.97);
    const std::vector<rte::ScaledStack> stacks = {
        scaled({.base = glory_optics(0.9, 90), .coats = {{sharp, 0.1}}}),
        scaled({.base = sharp, .coats = {{glory_optics(1.0, 140), 0.7}, {sharp, 0.02}}}),
        scaled({.base = glory_optics(0.3, 110)}),
    };
    const bool exact = GENERATE(true, false);
    const double tolerance = GENERATE(1e-3, 1e-5);
    const rte::SpectralFirstOrder together(wavelengths_of(stacks), exact, tolerance);
    REQUIRE(together.wavelengths() == 3);
    // These sums over moments are taken at each direction itself.
    std::vector<rte::GloryCorrection> features;
    for (const auto& stack : stacks) features.push_back({{&stack.media, 1}, 0.005, 1e-9});
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
                    rte::single_scattering(stacks[w].media, exact, mu_in, mu_out, cos_azimuth[a]);
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

TEST_CASE("the first order has the same bits wherever the caller keeps it", "[rte][first_order]") {
    // Eleven wavelengths are no whole number of vectors. Only builds whose vectors are wider than
    // what memory is aligned to can fail.
    const rte::Optics sharp = rte::henyey_greenstein_optics(0.6, 0.97);
    std::vector<rte::ScaledStack> stacks;
    for (int w = 0; w < 11; ++w)
        stacks.push_back(scaled({.base = glory_optics(0.9, 90 + w), .coats = {{sharp, 0.1}}}));
    const rte::SpectralFirstOrder first_order(wavelengths_of(stacks), true, 1e-3);
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

TEST_CASE("nothing scatters once in no layers", "[rte][first_order]") {
    const std::vector<rte::ScaledStack> empty(2);
    const rte::SpectralFirstOrder none(wavelengths_of(empty), true, 1e-3);
    const double cos_azimuth = 0.5;
    double found[2] = {1.0, 1.0};
    none.evaluate(0.5, 0.5, {&cos_azimuth, 1}, found);
    CHECK(found[0] == 0.0);
    CHECK(found[1] == 0.0);
}

TEST_CASE("light scattered once leaves a film over a mirror by all four ways",
          "[rte][first_order]") {
    // A film without boundaries over a mirror of n + ik: down and up again (back), by way of the
    // mirror before or after (forward), or both (back once more). Closed forms of each.
    const std::complex<double> silver(0.13, 3.5);
    const double tau = 0.4, albedo = 0.7, g = 0.6;
    const rte::Stack stack{.coats = {{rte::henyey_greenstein_optics(albedo, g), tau}},
                           .base_kind = rte::BaseKind::mirror,
                           .mirror_index = silver};
    const rte::ScaledStack film = rte::scale_stack(stack, 64, false);
    const rte::FirstOrder first_order(film, true);
    const auto P = [&](double c) { return (1 - g * g) / std::pow(1 + g * g - 2 * g * c, 1.5); };
    for (const auto& [in, out, azimuth] :
         {std::array{0.3, 0.8, 20.0}, std::array{0.6, 0.5, 170.0}, std::array{0.9, 0.2, 90.0}}) {
        const double cosine = std::cos(azimuth * std::acos(-1.0) / 180);
        const double sines = std::sqrt((1 - in * in) * (1 - out * out));
        const double r_in = rte::boundary_reflectance(1.0, silver, in);
        const double r_out = rte::boundary_reflectance(1.0, silver, out);
        const double a = std::exp(-tau / in), b = std::exp(-tau / out);
        const double back = (1 - a * b) / (in + out) * (1 + r_in * a * r_out * b);
        const double forward = (a - b) / (in - out) * (r_in * a + r_out * b) / 1.0;
        // A beam that comes up has been down first, and one that leaves by the mirror goes up
        // afterwards: exp(-tau / mu) of its own each.
        const double expected =
            albedo / 4 *
            (back * P(-in * out + sines * cosine) + forward * P(in * out + sines * cosine));
        CAPTURE(in, out, azimuth);
        CHECK(first_order.reflection(in, out, cosine) == Approx(expected).epsilon(1e-12));
        // Tables and matrices of the same light.
        const std::vector<rte::ScaledStack> stacks = {film};
        double tabulated = 0.0;
        rte::SpectralFirstOrder(wavelengths_of(stacks), true, 1e-5)
            .evaluate(in, out, {&cosine, 1}, {&tabulated, 1});
        CHECK(tabulated == Approx(expected).epsilon(1e-6));
        std::vector<double> summed(1, 0.0);
        const rte::Directions direction{{in}, {out}, {azimuth}};
        rte::FirstOrderSum(direction, {}).add_to(summed, film);
        CHECK(summed[0] == Approx(expected).epsilon(1e-12));
        // dR/dP: R is linear in it.
        const auto weights = first_order.weights(in, out);
        CHECK(weights[0].back == Approx(albedo / 4 * back).epsilon(1e-12));
        CHECK(weights[0].forward == Approx(albedo / 4 * forward).epsilon(1e-12));
    }
}
