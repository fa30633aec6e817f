#include <cmath>

#include "rte/forward_peak.h"
#include "rte/layered_reflection.h"
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

}  // namespace

TEST_CASE("a glory seen with few nodes is the glory of the whole equation", "[rte][narrow]") {
    const double albedo = GENERATE(0.8, 1.0);
    const double tau = GENERATE(0.0, 0.3);
    rte::Stack stack{.base = glory_optics(albedo)};
    if (tau > 0) stack.coats = {{rte::henyey_greenstein_optics(0.6, 0.5), tau}};

    // 200 moments on 150 nodes: nothing truncated, no correction applies.
    const double truth = backscatter(stack, 150);
    const double corrected = backscatter(stack, 16);
    // The same first order (TMS) without the high moments that the correction needs.
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

TEST_CASE("Henyey-Greenstein has no narrow features, short lists none either", "[rte][narrow]") {
    CHECK(rte::split_forward_peak(rte::henyey_greenstein_optics(1.0, 0.97).chi, 30).rest.empty());
    CHECK(rte::split_forward_peak(std::vector<double>{1.0, 0.5}, 4).rest.empty());
    const auto split = rte::split_forward_peak(glory_optics(1.0).chi, 30);
    REQUIRE(split.rest.size() == 170);
    // The peak is smooth on the scale of the window: its own bend adds 2 % of its value.
    for (int l = 60; l < 140; ++l) {
        CHECK(std::abs(split.peak[std::size_t(l - 30)] - 0.5 * std::exp(-std::pow(l / 90.0, 2))) <=
              0.01);
    }
}
