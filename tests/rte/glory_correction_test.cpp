#include <cmath>
#include <numbers>
#include <utility>

#include "rte/first_order/first_order_sum.h"
#include "rte/first_order/glory_correction.h"
#include "rte/math/tolerance_budget.h"
#include "rte/phase/scaled_medium.h"
#include "rte/stack/fourier_sum.h"
#include "rte/stack/layered_reflection.h"
#include "rte/stack/stack_solver.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

// A small model of a transparent sphere's phase function: half of the light in a smooth background,
// half in a diffraction peak, and a glory of alternating high moments; 200 moments in all.
rte::Optics glory_optics(double albedo) {
    rte::Optics optics = rte::isotropic_optics(albedo);
    optics.chi.resize(200);
    for (int l = 0; l < 200; ++l) {
        const double background = 0.5 * std::pow(0.3, l);
        const double peak = 0.5 * std::exp(-std::pow(l / 90.0, 2));
        const double glory =
            l > 20 ? 0.004 * (l % 2 ? -1 : 1) * std::exp(-std::pow((l - 90) / 25.0, 2)) : 0.0;
        optics.chi[std::size_t(l)] = background + peak + glory;
    }
    optics.chi[0] = 1.0;
    return optics;
}

double backscatter(const rte::Stack& stack, int streams) {
    return rte::reflect(stack, {{1.0}, {1.0}, {180.0}}, {.tolerance = 1e-6, .streams = streams})
        .reflection[0];
}

// With the narrow features beyond delta-M.
rte::ScaledStack with_narrow(rte::ScaledStack stack) {
    for (rte::ScaledMedium& medium : stack.media)
        medium.narrow = rte::split_forward_peak(medium.exact.chi, medium.scaled.first_cutoff);
    return stack;
}

}  // namespace

TEST_CASE("a glory seen with few nodes is the glory of the whole equation", "[rte][narrow]") {
    const double albedo = GENERATE(0.8, 1.0);
    const double tau = GENERATE(0.0, 0.3);
    rte::Stack stack{.base = glory_optics(albedo)};
    if (tau > 0) stack.coats = {{rte::henyey_greenstein_optics(0.6, 0.5), tau}};

    // 200 moments on 150 nodes: nothing truncated, no correction applies.
    const double truth = backscatter(stack, 150);
    const double corrected = backscatter(stack, 16);
    // This first order (TMS) is without the high moments that the correction needs.
    rte::Stack uncorrected = stack;
    const rte::Optics whole = stack.base;
    uncorrected.base.chi.resize(22);
    uncorrected.base.phase = [whole](double x) {
        rte::Optics copy = whole;
        double sum = 0.0;
        double P0 = 1.0;
        double P1 = x;
        for (std::size_t l = 0; l < copy.chi.size(); ++l) {
            sum += (2.0 * double(l) + 1.0) * copy.chi[l] * P0;
            const double P2 =
                ((2.0 * double(l) + 3.0) * x * P1 - (double(l) + 1.0) * P0) / (double(l) + 2.0);
            P0 = P1;
            P1 = P2;
        }
        return sum;
    };
    const double plain = backscatter(uncorrected, 16);
    CAPTURE(albedo, tau, truth, corrected, plain);
    CHECK(std::abs(plain / truth - 1.0) >= 0.03);
    // The small-angle limit behind the correction: a per cent at such a wide peak.
    CHECK(std::abs(corrected / truth - 1.0) <= 0.02);
    CHECK(std::abs(corrected - truth) <= 0.25 * std::abs(plain - truth));
}

TEST_CASE("light that nodes resolve in part is as bright at retro-reflection as with all nodes",
          "[rte][narrow]") {
    // A peak and a glory that 24 nodes resolve along the azimuth and in part along the zenith
    // angle.
    rte::Optics optics = rte::isotropic_optics(0.95);
    optics.chi.resize(130);
    for (int l = 1; l < 130; ++l) {
        optics.chi[std::size_t(l)] =
            0.5 * std::pow(0.3, l) + 0.5 * std::exp(-std::pow(l / 45.0, 2)) +
            (l > 10 ? 0.006 * (l % 2 ? -1 : 1) * std::exp(-std::pow((l - 50) / 15.0, 2)) : 0.0);
    }
    const rte::Stack stack{.base = optics};
    const double mu = GENERATE(0.3, 0.6, 0.8);
    const auto retro = [&](int streams) {
        return rte::reflect(stack, {{mu}, {mu}, {180.0}}, {.tolerance = 1e-5, .streams = streams})
            .reflection[0];
    };
    const double truth = retro(128);
    const int streams = 24;
    // The part of the first order that stands for what is not resolved.
    rte::ScaledStack scaled = rte::scale_stack(stack, 4 * streams, true);
    rte::split_by_resolution(scaled, rte::StackGrids(scaled, rte::GridKind::mapped_gauss, streams));
    const auto change = [&] {
        double sum = 0.0;
        const double towards_source = -1.0;
        rte::GloryCorrection({&scaled.media, 1}, mu, 1e-9)
            .add_to(&sum, {&mu, 1}, {&mu, 1}, {&towards_source, 1});
        return sum;
    };
    const double all = change();
    for (rte::ScaledMedium& medium : scaled.media) medium.unresolved_shares.clear();
    const double with = retro(streams), without = with - (all - change());
    CAPTURE(mu, truth, with, without);
    CHECK(std::abs(without / truth - 1.0) >= 4e-3);
    // Waves in all directions alike, at one angle: the fifth part of it is the model's own error.
    CHECK(std::abs(with - truth) <= 0.2 * std::abs(without - truth));
}

TEST_CASE("the estimate straight back covers a glory that nodes do not resolve", "[rte][narrow]") {
    const auto at = [](const rte::Optics& optics, int streams) {
        return rte::reflect({.base = optics}, {{1.0}, {1.0}, {180.0}},
                            {.tolerance = 1e-4, .streams = streams});
    };
    const rte::ReflectionTable few = at(glory_optics(0.95), 12), many = at(glory_optics(0.95), 96);
    CAPTURE(few.reflection[0], many.reflection[0], few.errors[0]);
    CHECK(std::abs(few.reflection[0] - many.reflection[0]) <= few.errors[0] * few.reflection[0]);
    CHECK(!few.report.converged);
}

TEST_CASE("sums of Fourier orders look beyond a gap for the orders of a glory", "[rte][narrow]") {
    const auto last_order = [](const rte::Optics& optics, double hump) {
        rte::ScaledStack scaled = rte::scale_stack({.base = optics}, 128, true);
        rte::split_by_resolution(scaled, rte::StackGrids(scaled, rte::GridKind::mapped_gauss, 32));
        rte::FeatureOrders features(scaled, rte::collect({0.7}, {0.7}));
        int asked = 0;
        const int last = features.last(20, 128, 1.0, 1e-4, [&](int order) {
            ++asked;
            return hump * std::exp(-std::pow((order - 70) / 20.0, 2));
        });
        CHECK(asked <= 4);
        return std::pair(last, asked);
    };
    CHECK(last_order(glory_optics(0.9), 1e-2).first >= 60);
    CHECK(last_order(glory_optics(0.9), 0.0) == std::pair(20, 4));
    CHECK(last_order(rte::henyey_greenstein_optics(0.9, 0.95), 1e-2) == std::pair(20, 0));
}

TEST_CASE("the waves that nodes resolve are those of their distances", "[rte][narrow]") {
    const rte::ZenithGrid grid = rte::make_zenith_grid(
        GENERATE(rte::GridKind::mapped_gauss, rte::GridKind::gauss, rte::GridKind::paper), 64);
    const int count = 9001;
    const std::vector<double> waves = rte::resolved_waves(grid, count);
    REQUIRE(waves.size() == std::size_t(count));
    for (Eigen::Index j = 8; j + 8 < grid.size(); ++j) {
        const double angle = std::acos(grid.mu[j]);
        const double distance =
            0.5 * std::abs(std::acos(grid.mu[j - 1]) - std::acos(grid.mu[j + 1]));
        const double place = angle * (2.0 / std::numbers::pi) * (count - 1);
        const double here = waves[std::size_t(std::lround(place))];
        // Nodes lie as their density says to some (1 / 8)^2 of their distance, eight nodes from
        // the ends of a panel.
        CHECK(std::abs(here * distance / std::numbers::pi - 1.0) <= 0.02);
    }
    CHECK(rte::resolved_waves({grid.mu, grid.weights}, count).empty());
}

TEST_CASE("Henyey-Greenstein has no narrow features, short lists none either", "[rte][narrow]") {
    CHECK(rte::split_forward_peak(rte::henyey_greenstein_optics(1.0, 0.97).chi, 30)
              .structure.empty());
    CHECK(rte::split_forward_peak(std::vector<double>{1.0, 0.5}, 4).structure.empty());
    const auto split = rte::split_forward_peak(glory_optics(1.0).chi, 30);
    REQUIRE(split.structure.size() == 170);
    // The peak is smooth on the scale of the window: its own bend adds 2 % of its value.
    for (int l = 60; l < 140; ++l) {
        CHECK(std::abs(split.peak[std::size_t(l - 30)] - 0.5 * std::exp(-std::pow(l / 90.0, 2))) <=
              0.01);
    }
}

TEST_CASE("the table of narrow features is the sum over degrees that it stands for",
          "[rte][narrow]") {
    rte::Stack stack{.base = glory_optics(0.9)};
    const bool coated = GENERATE(false, true);
    if (coated) {
        stack.coats = {{rte::henyey_greenstein_optics(0.6, 0.5), 0.01}, {glory_optics(1.0), 0.7}};
    }
    const std::vector<rte::ScaledMedium> media =
        with_narrow(rte::scale_stack(stack, 24, true)).media;
    const double tolerance = 1e-7;
    const double mu_least = 0.01;
    rte::GloryCorrection features({&media, 1}, mu_least, tolerance);
    if (GENERATE(false, true)) features.tabulate();
    REQUIRE(!features.none());
    double largest = 0.0;
    double largest_error = 0.0;
    for (const double mu_in : {0.01, 0.033, 0.25, 0.7, 1.0}) {
        for (const double mu_out : {0.01, 0.02, 0.5, 0.93, 1.0}) {
            const Eigen::VectorXd strengths =
                rte::GloryStrengths(media).of_all(1.0 / mu_in + 1.0 / mu_out);
            for (const double cos_azimuth : {-1.0, -0.9, 0.1, 1.0}) {
                const double x = rte::cos_scattering_angle(mu_in, mu_out, cos_azimuth);
                double P0 = 1.0;
                double P1 = x;
                double exact = 0.0;
                for (Eigen::Index l = 0; l < strengths.size(); ++l) {
                    exact += strengths[l] * P0;
                    const double P2 = ((2.0 * double(l) + 3.0) * x * P1 - (double(l) + 1.0) * P0) /
                                      (double(l) + 2.0);
                    P0 = P1;
                    P1 = P2;
                }
                double added = 0.0;
                features.add_to(&added, {&mu_in, 1}, {&mu_out, 1}, {&cos_azimuth, 1});
                largest = std::max(largest, std::abs(exact));
                largest_error =
                    std::max(largest_error, std::abs(4.0 * (mu_in + mu_out) * added - exact));
            }
        }
    }
    CHECK(largest >= 0.1);
    // Interpolation in q, panels in angle, the dropped tail: each within the tolerance, and the sum
    // over the nodes' weights (below 3) multiplies the panels' part.
    CHECK(largest_error <= 6.0 * tolerance);
}

TEST_CASE("what is kept of narrow features does not depend on the moments of the first call",
          "[rte][narrow]") {
    const auto optics = [](double albedo, double middle) {
        rte::Optics glory = rte::isotropic_optics(albedo);
        glory.chi.resize(700);
        for (int l = 1; l < 700; ++l)
            glory.chi[std::size_t(l)] =
                0.5 * std::pow(0.3, l) + 0.5 * std::exp(-std::pow(l / 200.0, 2)) +
                (l % 2 ? -1 : 1) * 0.003 * std::exp(-std::pow((l - middle) / 60.0, 2));
        return glory;
    };
    const rte::Stack stack{.base = optics(0.95, 150.0), .coats = {{optics(0.9, 300.0), 0.5}}};
    const rte::Directions directions{{0.1, 0.7, 1.0}, {0.1, 0.6, 1.0}, {0.0, 100.0, 178.0, 180.0}};
    const rte::SolverOptions options{.tolerance = 1e-5};
    rte::FirstOrderSum kept(directions, options);
    double largest = 0.0;
    // More than 128 moments are too many for what the first call has kept.
    for (const int moments : {24, 96, 200, 48}) {
        const rte::ScaledStack scaled = with_narrow(rte::scale_stack(stack, moments, true));
        const std::vector<rte::ScaledMedium>& media = scaled.media;
        const rte::GloryCorrection whole({&media, 1}, 0.1, 1e-9);
        std::vector<double> values(3 * 3 * 4, 0.0);
        kept.add_to(values, scaled);
        auto value = values.begin();
        for (const double mu_in : directions.mu_in) {
            for (const double mu_out : directions.mu_out) {
                for (const double azimuth : directions.azimuth_deg) {
                    const double cosine = std::cos(azimuth * (std::numbers::pi / 180.0));
                    double narrow = 0.0;
                    whole.add_to(&narrow, {&mu_in, 1}, {&mu_out, 1}, {&cosine, 1});
                    const double truth =
                        rte::single_scattering(media, true, mu_in, mu_out, cosine) + narrow;
                    CAPTURE(moments, mu_in, mu_out, azimuth, narrow);
                    // Interpolation in q and dropped degrees: a share of the tolerance of C each,
                    // for what is kept and for the rest.
                    CHECK(std::abs(*value++ - truth) * 4.0 * (mu_in + mu_out) <=
                          4.0 * kGloryShare * options.tolerance);
                    largest = std::max(largest, std::abs(narrow / truth));
                }
            }
        }
    }
    CHECK(largest >= 0.05);
}

TEST_CASE("the soft cutoff fades moments without moving energy", "[rte][delta_m]") {
    const rte::Optics optics = rte::henyey_greenstein_optics(0.99, 0.99);
    const rte::ScaledOptics scaled = rte::scale_optics(optics, 64, true);
    CHECK(scaled.first_cutoff == 64 - 29);  // 0.45 of 64
    CHECK(std::abs(scaled.chi[0] - 1.0) <= 1e-14);
    // Absorption per length is what it was.
    CHECK(std::abs(scaled.one_minus_albedo * scaled.depth_factor - 0.01) <= 1e-15);
    for (int l = 0; l < 64; ++l) {
        const double kept = (1.0 - scaled.truncated) * scaled.chi[l];
        const double chi = optics.chi[std::size_t(l)];
        // Up to the first cutoff it is delta-M; beyond, less and less is kept.
        if (l <= scaled.first_cutoff) CHECK(std::abs(kept + scaled.truncated - chi) <= 1e-14);
        CHECK(kept >= 0.0);
        CHECK(kept <= chi - optics.chi[64] + 1e-14);
    }
    // The share scaled away is the sum of the weights of the cutoffs up to there.
    double sum = 0.0;
    const int cutoffs = 64 - scaled.first_cutoff + 1;
    for (int c = 0; c < cutoffs; ++c) {
        const double h = std::numbers::pi / (cutoffs + 1);
        sum += std::sin((c + 1) * h) * std::tan(0.5 * h);
        CHECK(std::abs(scaled.share_scaled_away(scaled.first_cutoff + c) - sum) <= 1e-13);
    }
    // Weak peaks keep the sharp cutoff.
    CHECK(rte::scale_optics(rte::henyey_greenstein_optics(0.99, 0.75), 64, true).first_cutoff ==
          64);
}

TEST_CASE("the running mean of the forward peak has no step where moments turn negative",
          "[rte][narrow]") {
    // A peak that falls like that of spheres and crosses zero: a step of N_l at one degree would
    // give (2l + 1) N_l / 2 to retro-reflection, with the sign of its parity.
    std::vector<double> chi(400);
    for (int l = 0; l < 400; ++l)
        chi[std::size_t(l)] = std::pow(1 - l / 300.0, 3) * std::exp(-l / 200.0);
    const auto split = rte::split_forward_peak(chi, 32);
    REQUIRE(split.structure.size() > 300);
    double largest = 0;
    for (std::size_t k = 1; k < 300; ++k) {
        const double step = std::abs(split.structure[k] - split.structure[k - 1]);
        largest = std::max(largest, step * (2.0 * double(k + 32) + 1));
    }
    CHECK(largest <= 1.5e-2);  // the function itself changes by 7.6e-3 at most
}
