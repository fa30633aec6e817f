// P at many angles that lie close together, against the same angles one by one.
#include <miebrdf/ensemble.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "mie/ensemble/phase_panel.h"
#include "mie/ensemble/phase_table.h"
#include "mie/sphere/radial_functions.h"
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

TEST_CASE("half a panel keeps the parts of P that the whole has smooth", "[mie][rays]") {
    const mie::Ensemble ensemble = mie::ensemble_of(request_of({2.6, 0}, Kind::power_law, 50));
    mie::PairedSizeSamples sizes(ensemble, mie::PhaseMethod::rays);
    mie::PhaseGoal options;
    options.method = mie::PhaseMethod::rays;
    options.floor = 0.5;
    const auto add_next = [&](mie::PhasePanel& panel) {
        std::vector<double> angles_deg;
        for (const double theta : mie::panel_nodes(panel.lower(), panel.upper()))
            angles_deg.push_back(theta * 180 / std::numbers::pi);
        const std::vector<int> levels = panel.next_levels(sizes, 1e-3);
        panel.add_level(sizes.levels(levels, angles_deg, false, mie::run_in_order), levels, sizes,
                        options);
    };
    // The bow of 4 ways is here, at 142.9 degrees: that part alone is not smooth.
    const double lower = 140 * std::numbers::pi / 180, upper = 146 * std::numbers::pi / 180;
    mie::PhasePanel whole(lower, upper, 0);
    add_next(whole);
    constexpr double smooth = 1e-4;
    int kept = 0, anew = 0;
    for (const bool is_upper : {false, true}) {
        mie::PhasePanel half = is_upper ? whole.upper_half(smooth) : whole.lower_half(smooth);
        CHECK((is_upper ? half.lower() : half.upper()) == whole.middle());
        CHECK(half.generation() == 1);
        const std::vector<int> wanted = half.next_levels(sizes, 1e-3);
        CHECK(wanted[4] == 0);
        for (const int level : wanted) ++(level < 0 ? kept : anew);
        mie::PhasePanel direct(half.lower(), half.upper(), 1);
        add_next(half);
        add_next(direct);
        // What the polynomials of all parts leave out, at most three times their last two
        // coefficients, and single precision.
        const double bound = 3 * smooth * sizes.part_count() + 1e-5;
        CHECK((half.values() - direct.values()).cwiseAbs().maxCoeff() <= bound);
        // All are there: from now on the noisiest part is next, wherever it comes from.
        int asked = 0;
        for (const int level : half.next_levels(sizes, 1e9)) asked += level >= 0 ? 1 : 0;
        CHECK(asked == 1);
    }
    CAPTURE(kept, anew);
    CHECK(kept >= 8);
    CHECK(anew <= 6);
    // Nothing is kept where nothing is smooth enough.
    for (const int level : whole.lower_half(0).next_levels(sizes, 1e-3)) CHECK(level == 0);
}
