#include "pipeline/plan/cost_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/solve/coated.h"
#include "pipeline/solve/grain_shape.h"
#include "pipeline/solve/rules.h"
#include "pipeline/solve/single_scattering.h"

namespace miebrdf {
namespace {

// Fitted to `miebrdf` on one core of a 2.6 GHz server processor, native build.
constexpr double kNodeCubed_s = 1.2e-9;  // times n^2 (n + cosines), for each layer
constexpr double kMoment_s = 2e-9;       // times n^2 times moments, for each layer of particles
constexpr double kOrder_s = 5e-6;
// The numbers of nodes that were tried before, and the coarser one for the error estimate.
constexpr double kStreamAttempts = 2.0;
constexpr double kValue_s = 2.5e-7;
constexpr double kTerm_s =
    1.5e-8;  // of the sum over orders, with all numbers of nodes that are tried
constexpr double kLobe_s = 1e-7;
constexpr double kRho_s = 3e-4;

}  // namespace

MieWork mie_work(const ResolvedSpecies& species, std::size_t w, double tolerance,
                 bool whole_phase) {
    const Particles& at = species.particles[w];
    const bool whole = whole_phase && !has_smooth_phase(species.species);
    MieWork work{
        species.sizes, at.index / at.host_index, at.host_index, at.wavelength_nm, tolerance,
        whole,         at.coatings.size()};
    if (species.species.shape.by_t_matrix) {
        mie::EnsembleRequest request = particles_of(species, w);
        request.tolerance = tolerance;
        work.t_matrix_seconds = mie::matrix_seconds(request);
    }
    // Waves are as many as the whole particle needs, resonances as wide as the clearest layer makes
    // them.
    work.sizes.effective_radius_um = species.outer_radius_um;
    for (const mie::ParticleCoating& coating : at.coatings) {
        const std::complex<double> index = coating.refractive_index / at.host_index;
        work.relative_index = {std::max(work.relative_index.real(), index.real()),
                               std::min(work.relative_index.imag(), index.imag())};
    }
    return work;
}

double mie_bytes(const MieWork& work) {
    // Angles of the phase function and moments both go with the size; measured for 5 to 500 um.
    constexpr double whole = 1.4e4, moments = 4e3;
    const double x = 2.0e3 * std::numbers::pi * work.sizes.effective_radius_um * work.host_index /
                     work.wavelength_nm;
    return (work.whole_phase ? whole : moments) * x;
}

double mie_working_bytes(const MieWork& work) {
    if (!work.whole_phase) return 0.0;
    // Functions of 400 angles and the waves of a level that are kept, for each order of the largest
    // sphere; measured for log-normal ice of 50 to 1,000 um.
    constexpr double per_order = 6.5e3;
    const double wave_number_per_um =
        2.0e3 * std::numbers::pi * work.host_index / work.wavelength_nm;
    return per_order * wave_number_per_um *
           mie::radius_range(work.sizes, 1e-6, 1.0 / wave_number_per_um).largest_um;
}

namespace {

/// Powers and factors of a fit to run times.
struct MieFit {
    double seconds, size, finer, finer_if_damped, width, absorption, clear, gamma, log_normal,
        contrast, damped, largest;
};

double seconds_of(const MieFit& fit, const MieWork& work) {
    using Kind = mie::SizeDistributionKind;
    const double wave_number_per_um =
        2.0e3 * std::numbers::pi * work.host_index / work.wavelength_nm;
    const double x = wave_number_per_um * work.sizes.effective_radius_um;
    const double k = work.relative_index.imag();
    const bool mono = work.sizes.kind == Kind::mono;
    const double variance = mono ? 0.02 : work.sizes.effective_variance;
    // Moments by the table of the phase function go with the square of the largest sphere.
    constexpr double few_moments = 250.0;
    const double largest =
        mono ? x
             : wave_number_per_um *
                   mie::radius_range(work.sizes, 1e-6, 1.0 / wave_number_per_um).largest_um;
    // Resonances are as wide as k x: where that is more than 1, few sizes are enough.
    const bool damped = k * x > 1.0;
    double seconds =
        fit.seconds * std::pow(1.0 + x, fit.size) *
        std::pow(1e-3 / work.tolerance, damped ? fit.finer_if_damped : fit.finer) *
        std::pow(variance, fit.width) * std::pow(1.0 + 4.0 * k * x, fit.absorption) *
        std::pow(std::clamp(std::abs(work.relative_index - 1.0), 0.1, 2.0), fit.contrast) *
        std::pow(std::max(1.0, largest / few_moments), fit.largest);
    if (k == 0.0) seconds *= fit.clear;
    if (damped) seconds *= fit.damped;
    if (work.sizes.kind == Kind::gamma) seconds *= fit.gamma;
    if (work.sizes.kind == Kind::log_normal) seconds *= fit.log_normal;
    return seconds;
}

}  // namespace

// Powers of size, tolerance and width, and factors, fitted by least squares of logarithms to 1128
// size averages of random scenes (tools/bench/plan_against_runs.py; those that take 0.3 ms or more,
// native build). Of 313 others that take 2 ms or more 76 % lie within a factor of 2 where the phase
// function is wanted, of 74 others 49 % where it is not: there narrow resonances decide, which no
// smooth formula knows.
double mie_seconds(const MieWork& work) {
    if (work.t_matrix_seconds > 0.0) return work.t_matrix_seconds;
    constexpr double kPerCoating = 7.0;  // measured: docs/maths-mie.md, "Layers"
    constexpr MieFit kWhole = {1.13e-3, 0.621, 0.331, 0.129, 0.189, -0.172,
                               0.58,    1.76,  1.14,  0.335, 0.667, 0.515};
    constexpr MieFit kMomentsAlone = {4.6e-3, 0.199, 0.217, 0.037, 0.375, -0.203,
                                      0.85,   0.61,  0.85,  0.445, 1.64,  0.361};
    const double whole = seconds_of(kWhole, work);
    const double plain =
        work.whole_phase ? whole : std::min(whole, seconds_of(kMomentsAlone, work));
    return plain * (1.0 + kPerCoating * static_cast<double>(work.coatings));
}

namespace {

/// Share of the light that a layer scatters first, of what comes in and goes out vertically.
double share_scattered(double depth_above, double depth) {
    return std::exp(-2.0 * depth_above) * -std::expm1(-2.0 * depth);
}

/// Size parameter of the largest particles.
double largest_size_parameter(const ResolvedMedium& medium) {
    double largest = 0.0;
    for (const ResolvedSpecies& species : medium.species) {
        if (!species.needs_mie()) continue;
        const Particles& at = species.particles.front();
        largest = std::max(largest, 2.0e3 * std::numbers::pi * species.outer_radius_um *
                                        at.host_index / at.wavelength_nm);
    }
    return largest;
}

/// Fourier orders of a given phase function: up to the moment that no longer shows, less than half.
int orders_of(const std::vector<double>& chi, double share, double tolerance) {
    constexpr double part = 0.45;
    const double least = 0.25 * tolerance;
    std::size_t last = 0;
    for (std::size_t l = 0; l < chi.size(); ++l) {
        if (share * std::abs(chi[l]) > least) last = l;
    }
    return 2 + static_cast<int>(part * static_cast<double>(last));
}

double least_of(const std::vector<double>& cosines) {
    return cosines.empty() ? 1.0 : *std::min_element(cosines.begin(), cosines.end());
}

/// The media that show, from the top down.
struct Visible {
    double size = 0.0;  ///< largest size parameter, times the share that its layer scatters first
    int orders = 1;     ///< of given phase functions
    bool particles = false;
};

Visible look_at(const ResolvedScene& scene, std::size_t lowest, double tolerance) {
    Visible visible;
    double above = 0.0;
    for (std::size_t m = scene.media.size(); m-- > lowest;) {
        // Columns of particles have no depth before their optics are known: as if they hid the
        // rest.
        const bool is_base = m == 0;
        const bool unknown = is_base || scene.depths[m - 1].column_um.has_value();
        const double depth =
            unknown ? std::numeric_limits<double>::infinity() : scene.depths[m - 1].optical_depth;
        const double share = share_scattered(above, depth);
        const ResolvedMedium& medium = scene.media[m];
        if (medium.needs_mie()) {
            visible.particles = true;
            visible.size = std::max(visible.size, share * largest_size_parameter(medium));
        } else {
            const auto optics = compute_optics(scene, m, 0, {});
            visible.orders =
                std::max(visible.orders, orders_of(optics.optics.chi, share, tolerance));
        }
        above += depth;
    }
    return visible;
}

}  // namespace

// Powers fitted by least squares of logarithms to 210 random scenes of particles (radius 0.05 to 30
// um, tolerance 1e-4 to 1e-2); the rms of the logarithm is 0.38 for streams and 0.57 for orders.
TransferSize expected_size(const ResolvedScene& scene, std::size_t lowest,
                           const rte::SolverOptions& solver, const rte::Directions& directions) {
    constexpr int fewest = 12, most = 128, fewest_orders = 4, many_orders = 20, simple = 8;
    const Visible visible = look_at(scene, lowest, solver.tolerance);
    const double finer = 1e-3 / solver.tolerance, x = 1.0 + visible.size;
    // Scattering angles begin here: the forward peak shows near the horizon.
    const double least_angle =
        std::max(0.05, std::numbers::pi - std::acos(least_of(directions.mu_in)) -
                           std::acos(least_of(directions.mu_out)));
    TransferSize size;
    size.particles = visible.particles;
    size.orders = visible.orders;
    size.streams = size.orders > many_orders        ? 16
                   : most_fourier_orders(scene) > 0 ? simple
                                                    : fewest;
    if (visible.particles) {
        const double streams =
            9.12 * std::pow(x, 0.287) * std::pow(finer, 0.165) * std::pow(least_angle, -0.07);
        const double orders =
            3.39 * std::pow(x, 0.47) * std::pow(finer, 0.115) * std::pow(least_angle, -0.5);
        size.streams = std::max(size.streams, std::min(most, static_cast<int>(streams)));
        size.orders = std::max({size.orders, fewest_orders, static_cast<int>(orders)});
    }
    if (directions.mu_out.empty()) size.streams = std::min(size.streams, fewest);  // albedos
    if (solver.streams > 0) size.streams = solver.streams;
    size.orders = std::min(size.orders, 2 * size.streams);
    return size;
}

double order_seconds(const TransferSize& size, std::size_t layers, std::size_t cosines) {
    const double n = size.streams, moments = size.particles ? 4.0 * n : 0.0;
    const double nodes = n + static_cast<double>(cosines);
    const double each = kNodeCubed_s * nodes + kMoment_s * moments;
    return kStreamAttempts * (kOrder_s + static_cast<double>(layers) * n * n * each);
}

double value_seconds(int orders) { return kValue_s + kTerm_s * orders; }
double lobe_seconds() { return kLobe_s; }
double rho_seconds() { return kRho_s; }

}  // namespace miebrdf
