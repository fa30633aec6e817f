#include "pipeline/solve/grain_shape.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "pipeline/solve/resolver.h"
#include "rte/first_order/first_order.h"

namespace miebrdf {
namespace {

using Grain = GrainShape::Kind;
using Bands = std::array<double, 7>;

/// Ends of the bands, in um.
constexpr std::array<double, 8> kEnds = {0.25, 0.70, 1.41, 1.90, 2.50, 3.50, 4.00, 5.00};

/// He et al. (2017), table 3; the last band has the values of the one before.
constexpr Bands kFactor = {9.76029e-1, 9.67798e-1, 1.00111,   1.00224,
                           9.64295e-1, 9.97475e-1, 9.97475e-1};
constexpr Bands kShapePower = {5.21042e-1, 4.96181e-1, 1.83711e-1, 1.37082e-1,
                               5.50598e-2, 8.48743e-2, 8.48743e-2};
constexpr Bands kSizePower = {-2.66792e-4, 1.14088e-3,  2.37011e-4, -2.35905e-4,
                              8.40449e-4,  -4.71484e-4, -4.71484e-4};

/// Fu (2007), tables 1 and 2: powers of the aspect ratio of spheroids, of its logarithm for plates.
constexpr std::array<Bands, 3> kSpheroid = {
    {{7.938904e-1, 8.030084e-1, 8.513932e-1, 8.692241e-1, 7.085850e-1, 6.412701e-1, 6.412701e-1},
     {-3.987320e-1, -3.723287e-1, -3.924784e-1, -3.259404e-1, 4.429054e-2, -1.726586e-1,
      -1.726586e-1},
     {1.349959e-1, 1.115697e-1, 9.853958e-2, 5.557793e-2, -1.233493e-1, 0.0, 0.0}}};
constexpr std::array<Bands, 3> kPlate = {
    {{5.292852e-1, 5.425909e-1, 5.601598e-1, 6.023407e-1, 6.473899e-1, 4.634944e-1, 4.634944e-1},
     {1.140557e-1, 1.143152e-1, 1.143814e-1, 1.071238e-1, 1.353873e-1, 1.914431e-1, 1.914431e-1},
     {3.165543e-3, 2.014810e-3, 1.780838e-3, 6.987734e-4, -1.882932e-2, -2.277872e-2,
      -2.277872e-2}}};

/// He et al. (2017), table 1: effective radius over that of a sphere of equal volume.
constexpr double kPlateFactor = 0.788, kSpheroidFactor = 0.929, kKochFactor = 0.712;
/// Effective radius of a Koch flake over half of the diameter that eq. 7 is written in.
constexpr double kKochDiameter = 0.544;
constexpr double kLargestAsymmetry = 0.99;
/// Two lobes have chi_1 ... chi_3; one has chi_1.
constexpr int kMomentsOfTwoLobes = 3;
constexpr double kSphereB = 1.25, kReflectedByGrain = 0.0611;
/// Real indices of ice between 0.2 and 5 um lie within; the coefficients are for no other.
constexpr double kLeastIceIndex = 0.9, kMostIceIndex = 1.7;

/// The slope at the end of three points, kept monotone; h and the secant next to the end come
/// first.
double slope_at_end(double h0, double secant0, double h1, double secant1) {
    const double slope = ((2.0 * h0 + h1) * secant0 - h0 * secant1) / (h0 + h1);
    if (!(slope * secant0 > 0.0)) return 0.0;
    const bool turns = secant0 * secant1 < 0.0;
    return turns && std::abs(slope) > 3.0 * std::abs(secant0) ? 3.0 * secant0 : slope;
}

/// Monotone cubic (Fritsch & Butland 1984) between the middles of the bands, held beyond them.
double between_bands(const Bands& values, double wavelength_um) {
    Bands x;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = 0.5 * (kEnds[i] + kEnds[i + 1]);
    if (wavelength_um <= x.front()) return values.front();
    if (wavelength_um >= x.back()) return values.back();
    const auto slope_in = [&](std::size_t i) {
        return (values[i + 1] - values[i]) / (x[i + 1] - x[i]);
    };
    const auto slope_at = [&](std::size_t i) {
        if (i == 0) return slope_at_end(x[1] - x[0], slope_in(0), x[2] - x[1], slope_in(1));
        const std::size_t n = x.size();
        if (i + 1 == n) {
            return slope_at_end(x[n - 1] - x[n - 2], slope_in(n - 2), x[n - 2] - x[n - 3],
                                slope_in(n - 3));
        }
        const double before = slope_in(i - 1), after = slope_in(i);
        if (!(before * after > 0.0)) return 0.0;
        const double h0 = x[i] - x[i - 1], h1 = x[i + 1] - x[i];
        return 3.0 * (h0 + h1) / ((2.0 * h1 + h0) / before + (h1 + 2.0 * h0) / after);
    };
    const auto i = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), wavelength_um) -
                                            x.begin() - 1);
    const double h = x[i + 1] - x[i], t = (wavelength_um - x[i]) / h, u = 1.0 - t;
    return u * u * (1.0 + 2.0 * t) * values[i] + t * t * (3.0 - 2.0 * t) * values[i + 1] +
           h * t * u * (u * slope_at(i) - t * slope_at(i + 1));
}

/// Henyey and Greenstein's, or two of them.
rte::Optics lobes(const DoubleLobe& lobe, double albedo, double one_minus_albedo) {
    rte::Optics optics = rte::henyey_greenstein_optics(1.0, lobe.forward);
    if (lobe.share < 1.0) {
        optics = rte::mix({{optics, lobe.share},
                           {rte::henyey_greenstein_optics(1.0, lobe.backward), 1.0 - lobe.share}});
    }
    optics.single_scattering_albedo = albedo;
    optics.one_minus_albedo = one_minus_albedo;
    return optics;
}

}  // namespace

namespace {

bool has_exact_shape(const Species& species) {
    return species.shape == GrainShape{} || species.shape.by_t_matrix;
}

}  // namespace

bool has_smooth_phase(const Species& species) {
    const PhaseForm by_default =
        has_exact_shape(species) ? PhaseForm::mie : PhaseForm::henyey_greenstein;
    return species.phase.value_or(by_default) != PhaseForm::mie;
}

Species averaged_words(Species species) {
    if (!has_smooth_phase(species)) return species;
    species.phase.reset();
    if (!species.shape.by_t_matrix) species.shape = {};
    return species;
}

ResolvedSpecies averaged_particles(const ResolvedSpecies& species, std::size_t w) {
    ResolvedSpecies one{.species = averaged_words(species.species),
                        .particles = {species.particles[w]},
                        .wavelength_nm = {species.wavelength_nm[w]},
                        .sizes = species.sizes,
                        .effective_radius_um = species.effective_radius_um,
                        .outer_radius_um = species.outer_radius_um,
                        .spectrum = species.spectrum};
    one.key = {species_key(one, 0)};
    return one;
}

OpticsDemand demand_of_average(const Species& species, const OpticsDemand& demand) {
    if (!has_smooth_phase(species)) return demand;
    const bool is_double = species.phase == PhaseForm::double_henyey_greenstein;
    return {.highest_moment = is_double ? kMomentsOfTwoLobes : 1, .tolerance = demand.tolerance};
}

bool is_of_average(const OpticsDemand& demand) {
    return demand.highest_moment >= 1 && demand.highest_moment <= kMomentsOfTwoLobes &&
           !demand.whole_phase_function && !demand.polarisation;
}

double grain_asymmetry(const GrainShape& shape, double wavelength_nm, double effective_radius_um,
                       double single_scattering_albedo) {
    const double wavelength_um = wavelength_nm / 1e3;
    const bool is_spheroid = shape.kind == Grain::spheroid, is_koch = shape.kind == Grain::koch;
    const double factor = is_spheroid ? kSpheroidFactor : is_koch ? kKochFactor : kPlateFactor;
    const double diameter = 2.0 * effective_radius_um / (is_koch ? kKochDiameter : 1.0);
    const double aspect = shape.aspect.value_or(is_spheroid ? kSpheroidAspect : 2.5);
    const double a = is_spheroid ? aspect : std::log(aspect);
    const std::array<Bands, 3>& fu = is_spheroid ? kSpheroid : kPlate;
    Bands correction{}, geometric{};
    for (std::size_t i = 0; i < correction.size(); ++i) {
        correction[i] = kFactor[i] * std::pow(factor / kPlateFactor, kShapePower[i]) *
                        std::pow(diameter, kSizePower[i]);
        geometric[i] = fu[0][i] + a * (fu[1][i] + a * fu[2][i]);
    }
    const double g = between_bands(geometric, wavelength_um);
    const double whole = g + 0.5 * (1.0 - g) / single_scattering_albedo;
    return std::min(kLargestAsymmetry, whole * between_bands(correction, wavelength_um));
}

double enhanced_absorption(double absorption, double of_spheres) {
    const double most = 0.5 * (1.0 - kReflectedByGrain);
    if (!(of_spheres < most)) return of_spheres;
    return -most * std::expm1(absorption / kSphereB * std::log1p(-of_spheres / most));
}

DoubleLobe double_lobe(double chi1, double chi2, double chi3) {
    // Nodes and weights of the Gauss rule that has these moments: g^2 = p g - q at both nodes.
    const double spread = chi2 - chi1 * chi1;
    const double p = (chi3 - chi1 * chi2) / spread, q = (chi1 * chi3 - chi2 * chi2) / spread;
    const double root = std::sqrt(0.25 * p * p - q);
    DoubleLobe lobe{.forward = 0.5 * p + root, .backward = 0.5 * p - root};
    lobe.share = (chi1 - lobe.backward) / (lobe.forward - lobe.backward);
    if (spread > 0.0 && lobe.forward < 1.0 && lobe.backward > -1.0 && lobe.share >= 0.0 &&
        lobe.share <= 1.0)
        return lobe;
    throw UsageError(fmt::format(
        "no two lobes of Henyey and Greenstein have the moments {:.4g}, {:.4g}, {:.4g} of this "
        "phase function; take phase=henyey-greenstein",
        chi1, chi2, chi3));
}

MediumOptics smooth_optics(const ResolvedSpecies& species, std::size_t w,
                           const OpticsDemand& demand, const MediumOptics& spheres) {
    const Species& words = species.species;
    MediumOptics result;
    result.q_ext = spheres.q_ext;
    result.error_estimate = spheres.error_estimate;
    result.converged = spheres.converged;
    double absorbed = spheres.optics.one_minus_albedo,
           albedo = spheres.optics.single_scattering_albedo;
    if (words.shape.absorption) {
        absorbed = enhanced_absorption(*words.shape.absorption, absorbed);
        albedo = 1.0 - absorbed;
    }
    double g = spheres.asymmetry;
    if (words.shape.kind != Grain::sphere) {
        g = grain_asymmetry(words.shape, species.wavelength_nm[w], species.effective_radius_um,
                            albedo);
    }
    g = words.shape.asymmetry.value_or(g);
    DoubleLobe lobe{.forward = g};
    if (words.phase == PhaseForm::double_henyey_greenstein) {
        const std::vector<double>& chi = spheres.optics.chi;
        lobe = double_lobe(chi[1], chi[2], chi[3]);
        // A lobe is smoothed by one of asymmetry a when its own is multiplied with a.
        const double a = spheres.asymmetry == 0.0 ? 1.0 : g / spheres.asymmetry;
        const double most = std::max(std::abs(lobe.forward), std::abs(lobe.backward));
        if (!(std::abs(a) * most < 1.0)) {
            throw UsageError(fmt::format(
                "medium '{}': asymmetry {:.4g} is too far from the {:.4g} of spheres for two lobes "
                "of their shape; take phase=henyey-greenstein",
                describe(words), g, spheres.asymmetry));
        }
        lobe.forward *= a;
        lobe.backward *= a;
    }
    result.optics = lobes(lobe, albedo, absorbed);
    result.asymmetry = g;
    for (const double angle : demand.angles_deg) {
        result.phase.push_back(
            rte::exact_phase(result.optics, std::cos(angle * std::numbers::pi / 180.0)));
        result.phase_error.push_back(0.0);
    }
    return result;
}

void require_grains(const ResolvedSpecies& species) {
    if (species.species.shape.kind == Grain::sphere || species.species.shape.by_t_matrix) return;
    for (const Particles& at : species.particles) {
        const double n = at.index.real() / at.host_index;
        const bool in_range = at.wavelength_nm >= 200.0 && at.wavelength_nm <= 5000.0;
        if (in_range && n >= kLeastIceIndex && n <= kMostIceIndex) continue;
        throw UsageError(fmt::format(
            "medium '{}': the corrections for its shape are of ice between 200 and 5000 nm (He et "
            "al. 2017), here n = {:.4g} at {} nm; give asymmetry= (and phase=henyey-greenstein), "
            "or a file of its scattering",
            describe(species.species), n, at.wavelength_nm));
    }
}

}  // namespace miebrdf
