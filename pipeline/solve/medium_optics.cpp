#include "pipeline/solve/medium_optics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <miebrdf/error.h>
#include "mie/ensemble/ensemble.h"
#include "rte/first_order/first_order.h"
#include "rte/math/tolerance_budget.h"

namespace miebrdf {
namespace {

/// Optics that are given, not computed; Mie theory has no part in them.
rte::Optics analytic_optics(const Medium& medium) {
    struct Maker {
        rte::Optics operator()(const IsotropicMedium& m) const {
            return rte::isotropic_optics(m.single_scattering_albedo);
        }
        rte::Optics operator()(const RayleighMedium& m) const {
            return rte::rayleigh_optics(m.single_scattering_albedo);
        }
        rte::Optics operator()(const HenyeyGreensteinMedium& m) const {
            return rte::henyey_greenstein_optics(m.single_scattering_albedo, m.asymmetry);
        }
        rte::Optics operator()(const MomentsMedium& m) const {
            rte::Optics optics;
            optics.single_scattering_albedo = m.single_scattering_albedo;
            optics.one_minus_albedo = 1.0 - m.single_scattering_albedo;
            optics.chi = m.chi;
            return optics;
        }
        rte::Optics operator()(const DatabaseMedium&) const { return {}; }
        rte::Optics operator()(const IndexMedium&) const { return {}; }
    };
    return std::visit(Maker{}, medium);
}

/// Where P is below half of its mean over the sphere, noise is judged against that: single
/// scattering R = P / (4 (mu + mu')) of such angles is small beside the largest value at any
/// incidence.
constexpr double kPhaseFloor = 0.5;

mie::EnsembleRequest ensemble_request(std::complex<double> index, double wavelength_nm,
                                      const ParticleOptions& particles,
                                      const OpticsDemand& demand) {
    mie::EnsembleRequest request;
    request.sizes = particles.sizes;
    request.refractive_index = index;
    request.host_index = particles.host_index;
    request.wavelength_nm = wavelength_nm;
    request.highest_moment = demand.highest_moment;
    request.angles_deg = demand.angles_deg;
    request.tolerance = demand.tolerance;
    if (demand.whole_phase_function) {
        request.with_phase_table = true;
        request.phase_floor = kPhaseFloor;
        request.phase_tolerance = std::clamp(kPhasePerMoment * demand.tolerance,
                                             kLeastPhaseTolerance, kMostPhaseTolerance);
        request.table_tolerance = kPhaseInterpolationShare * request.phase_tolerance;
        request.highest_moment = std::min(mie::highest_moment_of(request), kMostMoments);
    }
    return request;
}

MediumOptics from_mie(const mie::EnsembleOptics& ensemble, const mie::EnsembleRequest& request) {
    MediumOptics result;
    result.refractive_index = request.refractive_index;
    result.optics.single_scattering_albedo = ensemble.single_scattering_albedo;
    result.optics.one_minus_albedo = ensemble.one_minus_albedo;
    if (!ensemble.chi.empty()) {
        result.optics.chi = ensemble.chi;
        result.optics.has_more_moments = request.highest_moment < mie::highest_moment_of(request);
    }
    if (ensemble.phase_table) result.optics.phase = *ensemble.phase_table;
    result.phase = ensemble.phase;
    result.asymmetry = ensemble.asymmetry;
    result.q_ext = ensemble.q_ext;
    result.error_estimate = ensemble.error_estimate;
    result.converged = ensemble.converged;
    return result;
}

/// The average; what it refuses is a matter of sizes and wavelength together.
mie::EnsembleOptics average(const Medium& medium, const mie::EnsembleRequest& request,
                            const mie::Executor& run) {
    try {
        return mie::average_over_sizes(request, run);
    } catch (const std::invalid_argument& error) {
        const LayerSizes own = sizes_of(medium);
        throw UsageError(fmt::format(
            "{}{} ({} {} um, {} {}, --host-index {}, at {} nm)",
            own == LayerSizes{} ? "" : fmt::format("medium '{}': ", describe(medium)), error.what(),
            own.effective_radius_um ? "radius" : "--effective-radius",
            request.sizes.effective_radius_um,
            own.effective_variance ? "variance" : "--effective-variance",
            request.sizes.effective_variance, request.host_index, request.wavelength_nm));
    }
}

}  // namespace

MediumOptics medium_optics(const ResolvedMedium& medium, double wavelength_nm,
                           const ParticleOptions& particles, const OpticsDemand& demand,
                           const mie::Executor& run) {
    if (const auto index = medium.index_at(wavelength_nm, particles.k_floor)) {
        const auto request =
            ensemble_request(*index, wavelength_nm, particles_of(medium.medium, particles), demand);
        return from_mie(average(medium.medium, request, run), request);
    }
    MediumOptics result;
    result.optics = analytic_optics(medium.medium);
    result.asymmetry = result.optics.chi.size() > 1 ? result.optics.chi[1] : 0.0;
    for (const double angle : demand.angles_deg) {
        result.phase.push_back(
            rte::exact_phase(result.optics, std::cos(angle * std::numbers::pi / 180.0)));
    }
    return result;
}

}  // namespace miebrdf
