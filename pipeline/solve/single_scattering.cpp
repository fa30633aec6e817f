// One species at one wavelength.
#include "pipeline/solve/single_scattering.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include <miebrdf/ensemble.h>
#include "pipeline/cache/job_key.h"
#include "pipeline/scene/medium_kinds.h"
#include "pipeline/solve/coated.h"
#include "pipeline/solve/grain_shape.h"
#include "pipeline/solve/packing.h"
#include "rte/first_order/first_order.h"
#include "rte/grid/discretisation.h"
#include "rte/math/legendre.h"
#include "rte/math/tolerance_budget.h"

namespace miebrdf {
namespace {

// Moments that `auto` may use of Mie media where no phase function is wanted; more would cost more
// than all the rest (docs/numerics.md).
constexpr int kMostAutomaticMoments = 128;

/// Where P is below half of its mean over the sphere, noise is judged against that: single
/// scattering R = P / (4 (mu + mu')) of such angles is small beside the largest value at any
/// incidence.
constexpr double kPhaseFloor = 0.5;

/// Products of partial waves and angles that a level of sizes for single angles of P is worth.
constexpr double kMostPhaseWork = 3e8;

mie::EnsembleRequest ensemble_request(const ResolvedSpecies& species, std::size_t w,
                                      const OpticsDemand& demand) {
    mie::EnsembleRequest request = particles_of(species, w);
    request.highest_moment = demand.highest_moment;
    request.angles_deg = demand.angles_deg;
    request.tolerance = demand.tolerance;
    request.phase_tolerance =
        std::clamp(kPhasePerMoment * demand.tolerance, kLeastAngleTolerance, kMostPhaseTolerance);
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

/// Calls `ask`; what it refuses is a matter of sizes and wavelength together.
template <typename Ask>
auto ask_mie(const Species& species, const mie::EnsembleRequest& request, Ask ask) {
    try {
        return ask(request);
    } catch (const UsageError& error) {
        const ParticleSizes& own = species.sizes;
        throw UsageError(fmt::format(
            "medium '{}': {} ({}, {} {}, host_index {}, at {} nm)", describe(species), error.what(),
            own.effective_radius_um
                ? fmt::format("radius {} um", *own.effective_radius_um)
                : fmt::format("effective_radius_um {}", request.sizes.effective_radius_um),
            own.effective_variance ? "variance" : "effective_variance",
            request.sizes.effective_variance, request.host_index, request.wavelength_nm));
    }
}

template <typename Average>
auto average(Average compute, const Species& species, const mie::EnsembleRequest& request,
             const mie::Executor& run) {
    return ask_mie(species, request,
                   [&](const mie::EnsembleRequest& own) { return compute(own, run); });
}

mie::EnsembleRequest matrix_request(const ResolvedSpecies& species, std::size_t w,
                                    OpticsDemand demand) {
    demand.highest_moment = -1;
    demand.whole_phase_function = false;
    demand.angles_deg.clear();
    mie::EnsembleRequest request = ensemble_request(species, w, demand);
    request.phase_floor = kPhaseFloor;
    return request;
}

/// The same by spheres of kLargestOwnMatrix: at a wavelength so much longer, and with absorption
/// that is as much stronger, until nothing passes through a sphere. Opaque ones keep theirs, which
/// shows in what they reflect. Points of P may have any error: light scattered once is the same
/// with and without polarisation.
mie::EnsembleRequest stand_in(mie::EnsembleRequest request, double size) {
    constexpr double opaque_k = 0.04;  // exp(-4 k x) = 7e-5 along the diameter
    const double longer = size / kLargestOwnMatrix;
    const auto absorbing = [=](std::complex<double> index) {
        const double k = std::min(index.imag() * longer, std::max(index.imag(), opaque_k));
        return std::complex(index.real(), k);
    };
    request.wavelength_nm *= longer;
    request.phase_tolerance = std::numeric_limits<double>::infinity();
    request.refractive_index = absorbing(request.refractive_index);
    for (mie::ParticleCoating& coating : request.coatings)
        coating.refractive_index = absorbing(coating.refractive_index);
    return request;
}

/// All of the scattering matrix, as a series, and P of the same spheres as a table.
MediumOptics polarising(const ResolvedSpecies& species, std::size_t w, const OpticsDemand& demand,
                        const mie::Executor& run) {
    auto request = matrix_request(species, w, demand);
    const double size = size_parameter(species, w);
    if (demand.only_compared && size > kLargestOwnMatrix) {
        // Refusals are in words of its own sizes and wavelength.
        ask_mie(species.species, request, mie::require_average);
        request = stand_in(std::move(request), size);
    }
    mie::MatrixOptics matrix = average(mie::average_matrix, species.species, request, run);
    MediumOptics result;
    result.optics.single_scattering_albedo = matrix.optics.single_scattering_albedo;
    result.optics.one_minus_albedo = matrix.optics.one_minus_albedo;
    result.optics.chi = std::move(matrix.optics.chi);
    result.optics.polarisation = std::make_shared<const rte::Polarisation>(
        rte::Polarisation{std::move(matrix.expansion), {}});
    result.optics.phase = *matrix.optics.phase_table;
    result.asymmetry = matrix.optics.asymmetry;
    result.q_ext = matrix.optics.q_ext;
    result.error_estimate = matrix.optics.error_estimate;
    result.converged = matrix.optics.converged;
    return result;
}

MediumOptics from_mie(const mie::EnsembleOptics& ensemble, const mie::EnsembleRequest& request) {
    MediumOptics result;
    result.optics.single_scattering_albedo = ensemble.single_scattering_albedo;
    result.optics.one_minus_albedo = ensemble.one_minus_albedo;
    if (!ensemble.chi.empty()) {
        result.optics.chi = ensemble.chi;
        result.optics.has_more_moments = request.highest_moment < mie::highest_moment_of(request);
    }
    if (ensemble.phase_table) result.optics.phase = *ensemble.phase_table;
    result.phase = ensemble.phase;
    result.phase_error = ensemble.phase_error;
    result.asymmetry = ensemble.asymmetry;
    result.q_ext = ensemble.q_ext;
    result.error_estimate = ensemble.error_estimate;
    result.converged = ensemble.converged;
    return result;
}

}  // namespace

double size_parameter(const ResolvedSpecies& species, std::size_t w) {
    const Particles& at = species.particles[w];
    return 2e3 * std::numbers::pi * at.host_index * species.outer_radius_um / at.wavelength_nm;
}

OpticsDemand demand_of(const rte::SolverOptions& solver, double mie_tolerance, PhaseDemand phase) {
    OpticsDemand demand;
    demand.tolerance = mie_tolerance > 0.0 ? mie_tolerance : kMieShare * solver.tolerance;
    // So many the solver keeps at most, and delta-M needs one more.
    demand.highest_moment = solver.streams > 0
                                ? rte::moments_per_node(solver.streams) * solver.streams
                                : kMostAutomaticMoments;
    demand.whole_phase_function =
        phase == PhaseDemand::whole && solver.single_scattering_correction;
    return demand;
}

std::string optics_hash(const ResolvedSpecies& species, std::size_t w, const OpticsDemand& demand) {
    const auto& [highest_moment, whole, angles_deg, tolerance, polarisation, compared] = demand;
    const bool by_others =
        compared && species.needs_mie() && size_parameter(species, w) > kLargestOwnMatrix;
    JobKey key(by_others      ? "scattering matrix of a stand-in"
               : polarisation ? "scattering matrix"
                              : "single scattering");
    key.add(species.key[w]);
    if (polarisation) return key.add(tolerance).hash();
    // With the whole phase function come all moments, however few were asked for.
    return key.add(whole ? -1 : highest_moment).add(whole).add(angles_deg).add(tolerance).hash();
}

double matrix_seconds(const ResolvedSpecies& species, std::size_t w, const OpticsDemand& demand) {
    return mie::matrix_seconds(matrix_request(species, w, demand));
}

void require_computable(const ResolvedSpecies& species, std::size_t w, const OpticsDemand& demand) {
    if (!species.needs_mie()) {
        species.given->optics(species.wavelength_nm[w]);
        return;
    }
    if (species.crowded) require_crowd(species, w);
    mie::EnsembleRequest request = particles_of(species, w);
    request.tolerance = demand.tolerance;
    const bool has_matrix = demand.polarisation && !has_smooth_phase(species.species);
    ask_mie(species.species, request, has_matrix ? mie::require_matrix : mie::require_average);
}

MediumOptics compute_optics(const ResolvedSpecies& species, std::size_t w,
                            const OpticsDemand& demand, const mie::Executor& run) {
    if (species.needs_mie() && has_smooth_phase(species.species)) {
        const auto spheres = compute_optics(averaged_particles(species, w), 0,
                                            demand_of_average(species.species, demand), run);
        return smooth_optics(species, w, demand, spheres);
    }
    if (species.needs_mie() && demand.polarisation) return polarising(species, w, demand, run);
    if (species.needs_mie()) {
        const auto request = ensemble_request(species, w, demand);
        return from_mie(average(mie::average_over_sizes, species.species, request, run), request);
    }
    MediumOptics result;
    result.optics = species.given->optics(species.wavelength_nm[w]);
    if (species.has_extinction())
        result.q_ext = species.given->extinction(species.wavelength_nm[w]);
    result.asymmetry = result.optics.chi.size() > 1 ? result.optics.chi[1] : 0.0;
    result.phase = phase_at(result.optics, demand.angles_deg);
    result.phase_error.assign(result.phase.size(), 0.0);
    return result;
}

std::vector<double> phase_at(const rte::Optics& optics, const std::vector<double>& angles_deg) {
    std::vector<double> phase;
    phase.reserve(angles_deg.size());
    for (const double angle : angles_deg)
        phase.push_back(rte::exact_phase(optics, std::cos(angle * std::numbers::pi / 180.0)));
    return phase;
}

namespace {

std::vector<double> moved(std::vector<double> list, const std::vector<double>& by, double share) {
    for (std::size_t k = 0; k < list.size() && k < by.size(); ++k) list[k] += share * by[k];
    return list;
}

/// The known optics with a share of a difference.
MediumOptics moved(const MediumOptics& known, const mie::EnsembleDifference& by, double share) {
    MediumOptics result = known;
    rte::Optics& optics = result.optics;
    // Slopes of spheres that absorb nothing are rounding.
    optics.single_scattering_albedo =
        std::min(1.0, optics.single_scattering_albedo + share * by.single_scattering_albedo);
    optics.one_minus_albedo = std::max(0.0, optics.one_minus_albedo + share * by.one_minus_albedo);
    optics.chi = moved(optics.chi, by.chi, share);
    if (by.phase_table) {
        optics.phase = [phase = known.optics.phase, slope = by.phase_table,
                        share](double cos_theta) {
            return phase(cos_theta) + share * (*slope)(cos_theta);
        };
    } else if (optics.phase && optics.polarisation) {  // all degrees are in the series
        optics.phase = [phase = known.optics.phase, slope = by.chi, share](double cos_theta) {
            return phase(cos_theta) + share * math::legendre_series(slope, cos_theta);
        };
    }
    if (optics.polarisation) {
        rte::Polarisation p = *optics.polarisation;
        p.a2 = moved(p.a2, by.expansion.a2, share);
        p.a3 = moved(p.a3, by.expansion.a3, share);
        p.a4 = moved(p.a4, by.expansion.a4, share);
        p.b1 = moved(p.b1, by.expansion.b1, share);
        p.b2 = moved(p.b2, by.expansion.b2, share);
        optics.polarisation = std::make_shared<const rte::Polarisation>(std::move(p));
    }
    result.asymmetry += share * by.asymmetry;
    if (result.q_ext) *result.q_ext += share * by.q_ext;
    return result;
}

}  // namespace

std::vector<std::pair<MediumOptics, MediumOptics>> changed_optics(
    const MediumOptics& known, const ResolvedSpecies& middle,
    const std::vector<SpeciesChange>& changes, std::size_t w, const OpticsDemand& demand,
    const mie::Executor& run) {
    mie::DifferenceDemand wanted;
    if (demand.polarisation) {
        wanted.matrix_degree = int(known.optics.chi.size()) - 1;
    } else {
        wanted.highest_moment = demand.highest_moment < 0 && !demand.whole_phase_function
                                    ? -1
                                    : int(known.optics.chi.size()) - 1;
        wanted.phase_table = known.optics.phase.target<mie::PhaseTable>();
    }
    const auto request = ensemble_request(middle, w, demand);
    std::vector<mie::EnsembleChange> sides;
    sides.reserve(changes.size());
    for (const SpeciesChange& change : changes)
        sides.push_back({ensemble_request(*change.plus, w, demand),
                         ensemble_request(*change.minus, w, demand)});
    const auto of = [&](const mie::EnsembleRequest&, const mie::Executor& pieces) {
        return mie::differences_of_averages(request, sides, wanted, pieces);
    };
    const std::vector<mie::EnsembleDifference> differences =
        average(of, middle.species, request, run);
    std::vector<std::pair<MediumOptics, MediumOptics>> both;
    both.reserve(changes.size());
    for (std::size_t c = 0; c < changes.size(); ++c) {
        const double above = changes[c].plus->key[w] == middle.key[w]    ? 0.0
                             : changes[c].minus->key[w] == middle.key[w] ? 1.0
                                                                         : 0.5;
        both.emplace_back(moved(known, differences[c], above),
                          moved(known, differences[c], above - 1.0));
    }
    return both;
}

mie::PhaseValues phase_of_mie(const ResolvedSpecies& species, std::size_t w,
                              const OpticsDemand& demand, const mie::PhaseTable& table,
                              const std::vector<double>& angles_deg,
                              const std::vector<double>& allowed, const mie::Executor& run) {
    auto request = ensemble_request(species, w, demand);
    request.angles_deg = angles_deg;
    request.phase_allowed = allowed;
    request.phase_floor = 0.0;
    request.phase_work = kMostPhaseWork;
    for (std::size_t i = 0; i < angles_deg.size(); ++i) {
        const double P = table(std::cos(angles_deg[i] * std::numbers::pi / 180.0));
        if (P > 0.0 && allowed[i] > 0.0)
            request.phase_tolerance = std::min(request.phase_tolerance, allowed[i] / P);
    }
    request.phase_tolerance = std::max(request.phase_tolerance, kLeastAngleTolerance);
    return mie::phase_at_angles(request, 0.0, run);
}

}  // namespace miebrdf
