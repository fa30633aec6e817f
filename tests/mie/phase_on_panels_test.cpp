// P at many angles that lie close together, against the same angles one by one.
#include <miebrdf/ensemble.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "tests/support/catch.h"

using namespace miebrdf;
using Complex = std::complex<double>;
using Kind = mie::SizeDistributionKind;

namespace {

mie::EnsembleRequest request_of(Complex index, Kind kind, double radius_um) {
    mie::EnsembleRequest request;
    request.sizes.effective_radius_um = radius_um;
    request.sizes.effective_variance = 0.2;
    request.sizes.kind = kind;
    request.refractive_index = index;
    request.wavelength_nm = 550;
    request.tolerance = 2e-4;
    return request;
}

}  // namespace

TEST_CASE("P at many angles is within what is allowed, as one by one", "[mie][rays][honesty]") {
    // Large spheres by rays, some below n = 1.4 by sizes, and small ones.
    struct Case {
        Complex index;
        Kind kind;
        double radius_um;
    };
    const Case c =
        GENERATE(Case{{2.6, 0}, Kind::power_law, 50}, Case{{1.6, 1e-5}, Kind::gamma, 30},
                 Case{{3.3, 1e-3}, Kind::power_law, 40}, Case{{1.33, 0}, Kind::log_normal, 12},
                 Case{{2.0, 0}, Kind::power_law, 1.5});
    constexpr double allowed_share = 4e-3;
    mie::EnsembleRequest many = request_of(c.index, c.kind, c.radius_um);
    for (double angle = 20.2; angle < 179.9; angle += 0.7) many.angles_deg.push_back(angle);
    many.phase_tolerance = 1e-3;
    for (std::size_t i = 0; i < many.angles_deg.size(); ++i)
        many.phase_allowed.push_back(allowed_share * (many.angles_deg[i] < 160 ? 0.5 : 1.0));
    const mie::PhaseValues values = mie::phase_at_angles(many, 0);

    mie::EnsembleRequest single = request_of(c.index, c.kind, c.radius_um);
    for (std::size_t i = 3; i < many.angles_deg.size(); i += 19)
        single.angles_deg.push_back(many.angles_deg[i]);
    single.phase_tolerance = 3e-4;
    single.phase_floor = 0.5;
    const mie::PhaseValues truth = mie::phase_at_angles(single, 0);

    int allowed = 0, beyond = 0;
    for (std::size_t i = 0; i < truth.phase.size(); ++i) {
        const std::size_t at = 3 + 19 * i;
        CAPTURE(c.index, c.radius_um, single.angles_deg[i], truth.phase[i], truth.error[i],
                values.phase[at], values.error[at]);
        if (values.error[at] <= many.phase_allowed[at]) ++allowed;
        const double off = std::abs(values.phase[at] - truth.phase[i]);
        // Twice an rms is exceeded by one in twenty.
        if (!(off <= values.error[at] + truth.error[i])) ++beyond;
        CHECK(off <= 2 * values.error[at] + truth.error[i]);
    }
    CAPTURE(c.index, c.radius_um, truth.phase.size());
    CHECK(beyond <= 1);
    CHECK(allowed >= int(truth.phase.size()) - 1);
}
