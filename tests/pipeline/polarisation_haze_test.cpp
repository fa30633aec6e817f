// Two layers of gas and haze above a ground: the model atmosphere of de Haan, Bosma & Hovenier
// (1987), from sizes of droplets to Stokes vectors.
#include <miebrdf/ensemble.h>

#include <array>
#include <cmath>
#include <numbers>

#include "rte/phase/polarisation.h"
#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

/// Haze L: n(r) = r^2 exp(-15.1186 sqrt r) (r in um), index 1.33, 700 nm.
rte::Optics haze_optics() {
    mie::EnsembleRequest request;
    request.sizes.kind = mie::SizeDistributionKind::tabulated;
    for (int i = 0; i <= 6000; ++i) {
        const double r = 1e-3 + (3.0 - 1e-3) * i / 6000;
        request.sizes.radii_um.push_back(r);
        request.sizes.number_density.push_back(r * r * std::exp(-15.1186 * std::sqrt(r)));
    }
    request.refractive_index = {1.33, 0};
    request.wavelength_nm = 700;
    request.tolerance = 1e-6;
    const mie::MatrixOptics matrix = mie::average_matrix(request);
    rte::Optics optics = rte::isotropic_optics(1.0);
    optics.chi = matrix.optics.chi;
    optics.polarisation =
        std::make_shared<const rte::Polarisation>(rte::Polarisation{matrix.expansion, {}});
    return optics;
}

/// Media that absorb nothing, by their shares of the scattering.
rte::Optics mixed(const rte::Optics& a, const rte::Optics& b, double share_of_b) {
    const std::array<rte::Optics, 2> both = {a, b};
    const std::array<double, 2> share = {1.0 - share_of_b, share_of_b};
    rte::Optics optics = rte::isotropic_optics(1.0);
    optics.chi.assign(std::max(a.chi.size(), b.chi.size()), 0.0);
    for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t l = 0; l < both[k].chi.size(); ++l)
            optics.chi[l] += share[k] * both[k].chi[l];
    optics.polarisation = rte::mix_polarisation(both, share);
    return optics;
}

}  // namespace

TEST_CASE("gas above gas and haze reflects what de Haan, Bosma & Hovenier found",
          "[pipeline][polarisation]") {
    // Their model 2: optical depths 0.1 of gas, below it 0.1 of gas and 0.4 of haze, Lambertian
    // ground of albedo 0.1; molecules depolarise by 0.0279. Incident flux pi: I = mu_in R11. Their
    // azimuth has the other sense: U and V change their sign.
    const rte::Optics gas = rte::rayleigh_optics(1.0, 0.0279);
    const rte::Optics below = mixed(gas, haze_optics(), 0.8);
    rte::Stack stack{.coats = {{below, 0.5}, {gas, 0.1}}};
    stack.base_kind = rte::BaseKind::lambertian;
    stack.ground_albedo = 0.1;
    struct Row {
        double mu_in, mu_out, azimuth_deg, I, Q, U;
    };
    const Row rows[] = {{0.5, 0.1, 0, 0.532950, -0.028340, 0.000000},
                        {0.5, 0.5, 0, 0.208430, -0.036299, 0.000000},
                        {0.5, 1.0, 0, 0.093680, -0.024156, 0.000000},
                        {0.5, 0.1, 30, 0.418140, -0.000058, 0.073105},
                        {0.5, 0.5, 30, 0.184970, -0.019649, 0.041401},
                        {0.5, 1.0, 30, 0.093680, -0.012078, 0.020920},
                        {0.1, 0.1, 0, 0.522770, 0.011506, 0.000000},
                        {0.1, 0.5, 0, 0.106590, -0.005186, 0.000000},
                        {0.1, 1.0, 0, 0.026009, -0.014984, 0.000000},
                        {0.1, 0.1, 30, 0.276300, 0.034368, 0.016042},
                        {0.1, 0.5, 30, 0.083628, 0.003839, 0.014492},
                        {0.1, 1.0, 30, 0.026009, -0.007492, 0.012976}};
    const int components = GENERATE(3, 4);
    for (const Row& row : rows) {
        const auto R = rte::reflect_polarised(stack, {{row.mu_in}, {row.mu_out}, {row.azimuth_deg}},
                                              components, {.tolerance = 1e-7, .streams = 64})
                           .reflection;
        CAPTURE(components, row.mu_in, row.mu_out, row.azimuth_deg);
        const auto c = std::size_t(components);
        // Five digits of I; the size distribution's ends are not known, which is most of 1e-5.
        CHECK(std::abs(row.mu_in * R[0] - row.I) <= 1e-5);
        CHECK(std::abs(row.mu_in * R[c] - row.Q) <= 4e-6);
        CHECK(std::abs(row.mu_in * R[2 * c] - row.U) <= 4e-6);
    }
}
