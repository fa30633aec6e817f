// Single scattering: from n + ik and sizes to what radiative transfer needs, each different job
// once.
#pragma once

#include <miebrdf/control.h>
#include <miebrdf/optics.h>
#include <miebrdf/solver.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <miebrdf/ensemble.h>
#include "pipeline/solve/resolved_scene.h"

namespace miebrdf {

/// How much of a medium's optics is wanted; the rest is not computed.
struct OpticsDemand {
    int highest_moment = -1;  ///< chi_0 ... chi_L; -1: none
    /// The phase function at every angle, and all the moments it has (up to kMostMoments).
    bool whole_phase_function = false;
    std::vector<double> angles_deg = {};  ///< P at these angles, for MediumOptics::phase
    double tolerance = 1e-4;              ///< relative, of the size average
    /// The whole scattering matrix, rte::Optics::polarisation, with all moments and a table of the
    /// phase function.
    bool polarisation = false;
    /// With `polarisation`, to tell what it changes: spheres of kLargestOwnMatrix, whose rays are
    /// refracted, reflected and absorbed alike, stand in for larger ones.
    bool only_compared = false;
};

/// Size parameter up to which scattering matrices of the spheres themselves tell what polarisation
/// changes: those of larger ones would cost more than the rest.
inline constexpr double kLargestOwnMatrix = 60.0;
/// Of the effective radius.
double size_parameter(const ResolvedSpecies& species, std::size_t w);

enum class PhaseDemand { moments_only, whole };

/// The optics that radiative transfer with these options makes use of.
/// @param mie_tolerance  of the size average; 0: its share of the solver's tolerance
OpticsDemand demand_of(const rte::SolverOptions& solver, double mie_tolerance, PhaseDemand phase);

/// The cost of moments grows with their square; beyond this many (spheres of about 0.5 mm in
/// visible light) the list is cut short.
constexpr int kMostMoments = 12'000;

struct MediumOptics {
    rte::Optics optics;
    std::vector<double> phase;        ///< P at the demanded angles_deg, in their order
    std::vector<double> phase_error;  ///< of each, absolute (mie::PhaseValues)
    double asymmetry = 0.0;           ///< chi_1
    std::optional<double> q_ext;      ///< extinction efficiency; empty if analytic or a mixture
    double error_estimate = 0.0;      ///< relative, of the size average; 0 if analytic
    bool converged = true;
    double extinction_per_um = 0.0;  ///< of the medium (extinction_per_um); 0 of single species
};

/// Everything that the optics of a species depend on: scenes that share it share the result.
/// @param w  index of the wavelength
std::string optics_hash(const ResolvedSpecies& species, std::size_t w, const OpticsDemand& demand);

/// About how long its scattering matrix takes (mie::matrix_seconds).
double matrix_seconds(const ResolvedSpecies& species, std::size_t w, const OpticsDemand& demand);

/// Refuses, without computing it, a species whose optics cannot be computed at this wavelength.
/// What only computing can tell is not looked for: a T-matrix without digits, lobes that fit no
/// moments.
/// @throws UsageError, InputError
void require_computable(const ResolvedSpecies& species, std::size_t w, const OpticsDemand& demand);

/// One species at one wavelength, computed.
/// @param run  for the pieces of one Mie average (parallel.h)
/// @throws UsageError  for sizes that the average cannot be taken over at this wavelength
MediumOptics compute_optics(const ResolvedSpecies& species, std::size_t w,
                            const OpticsDemand& demand,
                            const mie::Executor& run = mie::run_in_order);

/// A species a little different, one way and the other; one of them may be the one in the middle.
struct SpeciesChange {
    const ResolvedSpecies *plus, *minus;
};

/// The optics of both sides of changes of a species that is known: with the same sizes, and what
/// these give.
/// @param known  compute_optics of `middle`
/// @pre middle's phase function is not a smooth one (averaged_particles)
/// @return of `plus` and of `minus`, for each change
std::vector<std::pair<MediumOptics, MediumOptics>> changed_optics(
    const MediumOptics& known, const ResolvedSpecies& middle,
    const std::vector<SpeciesChange>& changes, std::size_t w, const OpticsDemand& demand,
    const mie::Executor& run);

/// The structure factor is multiplied with the whole phase function, even where moments are all
/// that is wanted.
OpticsDemand crowd_demand(const ResolvedSpecies& species, OpticsDemand demand);

/// A medium of which every species is known: albedos by extinction, phase functions by scattering,
/// what the host absorbs as a species of albedo 0.
/// @param species  in the order of the medium
MediumOptics mixed(const ResolvedMedium& medium, std::size_t w,
                   const std::vector<MediumOptics>& species);

/// Extinction in 1/um of a layer with the medium's volume fractions (of ratios alone: in any unit):
/// 3 f Q_ext / (4 r_eff) of every species, and what the host absorbs. 0 for media whose optics are
/// given.
double extinction_per_um(const ResolvedMedium& medium, std::size_t w,
                         const std::vector<MediumOptics>& species);

/// One medium at one wavelength, computed species by species.
MediumOptics compute_optics(const ResolvedScene& scene, std::size_t medium, std::size_t w,
                            const OpticsDemand& demand,
                            const mie::Executor& run = mie::run_in_order);

/// P at angles, of optics with their whole phase function or all moments.
std::vector<double> phase_at(const rte::Optics& optics, const std::vector<double>& angles_deg);

/// P of a medium with spheres at a few angles, better than its table has it.
/// @param allowed  error at each angle, absolute; as much of it as a bounded number of sizes
/// reaches
mie::PhaseValues phase_of_mie(const ResolvedSpecies& species, std::size_t w,
                              const OpticsDemand& demand, const mie::PhaseTable& table,
                              const std::vector<double>& angles_deg,
                              const std::vector<double>& allowed, const mie::Executor& run);

/// The optics of every medium at some of the scene's wavelengths: [place in `wavelengths`][medium].
/// Equal jobs are done once, different ones in parallel; what Control remembers is looked up.
/// @param media  indices of the media wanted
std::vector<std::vector<MediumOptics>> optics_of(const ResolvedScene& scene,
                                                 const std::vector<std::size_t>& media,
                                                 const std::vector<std::size_t>& wavelengths,
                                                 const OpticsDemand& demand,
                                                 const Control& control);

/// Optical depths of layers: [place in `wavelengths`][layer, the lowest first]. Single scattering
/// is asked for extinction alone, and only of layers whose depth follows it.
std::vector<std::vector<double>> optical_depths_of(const ResolvedScene& scene,
                                                   const std::vector<std::size_t>& wavelengths,
                                                   double mie_tolerance, const Control& control);

}  // namespace miebrdf
