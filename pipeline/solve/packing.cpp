#include "pipeline/solve/packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/LU>

#include <miebrdf/error.h>
#include <miebrdf/sizes.h>
#include <miebrdf/sphere.h>
#include "pipeline/cache/job_key.h"
#include "rte/first_order/first_order.h"
#include "rte/math/quadrature.h"

namespace miebrdf {
namespace {

// Beyond this, moments of P S cost more than all the rest, and crowding only changes diffraction.
constexpr double kLargestSizeParameter = 300.0;
constexpr int kNodesPerPanel = 12;
using std::numbers::pi;

/// The integral over r from R - d to R of exp(iqr) (a / 2 (r^2 - R^2) + b (r - R)).
std::complex<double> baxter_integral(double a, double b, double R, double d, double q) {
    const std::complex<double> z(0.0, -q * d);
    std::complex<double> first, second;  // integrals over s from 0 to 1 of s exp(zs), s^2 exp(zs)
    if (std::abs(z) < 1.0) {
        std::complex<double> term = 1.0;
        for (int k = 0; k < 18; ++k) {
            first += term / double(k + 2);
            second += term / double(k + 3);
            term *= z / double(k + 1);
        }
    } else {
        const std::complex<double> e = std::exp(z);
        first = (e - (e - 1.0) / z) / z;
        second = (e - 2.0 * first) / z;
    }
    return std::polar(d * d, q * R) * (0.5 * a * d * second - (a * R + b) * first);
}

double wave_number_per_um(const Particles& at) {
    return 2.0e3 * pi * at.host_index / at.wavelength_nm;
}

double kd_of(const ResolvedSpecies& species, std::size_t w) {
    return 2.0 * wave_number_per_um(species.particles[w]) * species.outer_radius_um;
}

double largest_kd(const Structure& structure) {
    return *std::max_element(structure.spheres.diameter.begin(), structure.spheres.diameter.end());
}

/// A sphere of this radius, or with such a core.
std::vector<mie::SphereLayer> layers_of(const Particles& at, double radius_um) {
    const double k_per_um = wave_number_per_um(at);
    const double core = k_per_um * radius_um;
    std::vector<mie::SphereLayer> layers = {{at.index / at.host_index, core}};
    for (const mie::ParticleCoating& coating : at.coatings) {
        layers.push_back({coating.refractive_index / at.host_index,
                          layers.back().size_parameter + k_per_um * coating.thickness_um +
                              coating.share_of_radius * core});
    }
    return layers;
}

/// Gauss nodes over (0, pi) that resolve `degrees` Legendre functions and S(q); weights of
/// sin(theta) d theta / 2.
math::Quadrature angles_for(double kd, int degrees) {
    const double fastest = std::max({kd, double(degrees), 20.0});
    const int panels = static_cast<int>(std::ceil(pi * fastest / 4.0));
    const math::Quadrature rule = math::gauss_legendre(kNodesPerPanel, 0.0, 1.0);
    math::Quadrature all;
    for (int p = 0; p < panels; ++p) {
        for (int i = 0; i < kNodesPerPanel; ++i) {
            const double theta = pi * (p + rule.nodes[i]) / panels;
            all.nodes.push_back(theta);
            all.weights.push_back(0.5 * std::sin(theta) * pi / panels * rule.weights[i]);
        }
    }
    return all;
}

/// Means over the sphere of `values` at the angles times P_l, l = 0 ... count - 1.
std::vector<double> moments_of(const math::Quadrature& angles, const std::vector<double>& values,
                               std::size_t count) {
    std::vector<double> chi(count, 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double mu = std::cos(angles.nodes[i]), weight = angles.weights[i] * values[i];
        double before = 0.0, here = 1.0;
        for (std::size_t l = 0; l < count; ++l) {
            chi[l] += weight * here;
            const double n = static_cast<double>(l);
            const double next = ((2.0 * n + 1.0) * mu * here - n * before) / (n + 1.0);
            before = here;
            here = next;
        }
    }
    return chi;
}

/// Between values at 0, 1, 2, ... through the four nearest.
double cubic_at(const std::vector<double>& values, double x) {
    const auto last = static_cast<double>(values.size()) - 4.0;
    const double start = std::clamp(std::floor(x) - 1.0, 0.0, last);
    const double t = x - start;
    const double* const v = &values[static_cast<std::size_t>(start)];
    return -v[0] * (t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0 +
           v[1] * t * (t - 2.0) * (t - 3.0) / 2.0 - v[2] * t * (t - 1.0) * (t - 3.0) / 2.0 +
           v[3] * t * (t - 1.0) * (t - 2.0) / 6.0;
}

/// At angles alike apart, of spheres of the effective radii.
std::vector<double> structure_at_angles(const std::vector<CrowdMember>& crowd, std::size_t w,
                                        const Structure& structure) {
    constexpr double kStep = 0.05;  // of kd times the angle: cubics then err by 1e-7
    const int intervals =
        static_cast<int>(std::ceil(pi * std::max(largest_kd(structure), 20.0) / kStep));
    std::vector<double> degrees;
    degrees.reserve(std::size_t(intervals) + 1);
    for (int i = 0; i <= intervals; ++i) degrees.push_back(180.0 * i / intervals);
    const auto kinds = static_cast<Eigen::Index>(crowd.size());
    std::vector<mie::Amplitudes> amplitudes;
    amplitudes.reserve(crowd.size());
    for (const CrowdMember& member : crowd) {
        amplitudes.push_back(mie::scattering_amplitudes(
            layers_of(member.particles[w], member.effective_radius_um), degrees));
    }
    std::vector<double> factors;
    factors.reserve(degrees.size());
    for (std::size_t a = 0; a < degrees.size(); ++a) {
        Eigen::MatrixX2cd f(kinds, 2);
        for (Eigen::Index i = 0; i < kinds; ++i) {
            const auto m = std::size_t(i);
            const double root = std::sqrt(structure.spheres.volume_fraction[m] /
                                          std::pow(structure.spheres.diameter[m], 3));
            f(i, 0) = root * amplitudes[m].s1[a];
            f(i, 1) = root * amplitudes[m].s2[a];
        }
        const double q = 2.0 * std::sin(0.5 * pi * double(a) / intervals);
        const Eigen::MatrixXcd Q = baxter_factor(structure.spheres, q);
        const Eigen::MatrixX2cd crowded = Q.adjoint().partialPivLu().solve(f);
        factors.push_back(crowded.squaredNorm() / f.squaredNorm());
    }
    return factors;
}

/// Members without an amount are not there.
Structure structure_of(const ResolvedSpecies& species, std::size_t w) {
    Structure structure;
    bool differ = false;
    const CrowdMember& first = species.crowd.front();
    for (const CrowdMember& member : species.crowd) {
        structure.spheres.diameter.push_back(2.0 * wave_number_per_um(member.particles[w]) *
                                             member.outer_radius_um);
        structure.spheres.volume_fraction.push_back(member.volume_fraction);
        differ = differ || member.key[w] != first.key[w];
    }
    if (differ) {
        structure.at_angles = structure_at_angles(species.crowd, w, structure);
    } else {
        std::vector<double>& all = structure.spheres.volume_fraction;
        all = {std::accumulate(all.begin(), all.end(), 0.0)};
        structure.spheres.diameter.resize(1);
    }
    return structure;
}

/// Sizes in equal steps of ln r with their shares of the cross-section, enough for two digits of a
/// mean over them.
std::vector<std::pair<double, double>> some_sizes(const ResolvedSpecies& species, std::size_t w) {
    constexpr double kTail = 1e-3;
    constexpr int kSizes = 16;
    const mie::SizeDistribution& law = species.sizes;
    const auto [smallest, largest] =
        mie::radius_range(law, kTail, 1.0 / wave_number_per_um(species.particles[w]));
    if (!(smallest < largest)) return {{species.effective_radius_um, 1.0}};
    std::vector<std::pair<double, double>> sizes;
    const double step = std::pow(largest / smallest, 1.0 / kSizes);
    for (int i = 0; i < kSizes; ++i) {
        const double from = smallest * std::pow(step, i);
        sizes.emplace_back(from * std::sqrt(step),
                           mie::area_share_within(law, {from, from * step}));
    }
    return sizes;
}

}  // namespace

double percus_yevick(double volume_fraction, double qd) {
    const double f = volume_fraction, gap = (1.0 - f) * (1.0 - f);
    const double a = (1.0 + 2.0 * f) / gap, b = -1.5 * f / gap;
    return 1.0 / std::norm(1.0 - 12.0 * f * baxter_integral(a, b, 1.0, 1.0, qd));
}

Eigen::MatrixXcd baxter_factor(const HardSpheres& spheres, double q) {
    const std::vector<double>&d = spheres.diameter, &f = spheres.volume_fraction;
    const std::size_t count = d.size();
    double by_diameter = 0.0, filled = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        by_diameter += f[i] / d[i];
        filled += f[i];
    }
    const double gap = (1.0 - filled) * (1.0 - filled);
    Eigen::MatrixXcd Q(count, count);
    for (std::size_t i = 0; i < count; ++i) {
        const double a = (1.0 - filled + 3.0 * d[i] * by_diameter) / gap;
        const double b = -1.5 * d[i] * d[i] * by_diameter / gap;
        for (std::size_t j = 0; j < count; ++j) {
            // 2 pi times the roots of the numbers, 6 f / (pi d^3) each.
            const double roots = 12.0 * std::sqrt(f[i] * f[j] / std::pow(d[i] * d[j], 3));
            Q(Eigen::Index(i), Eigen::Index(j)) =
                double(i == j) - roots * baxter_integral(a, b, 0.5 * (d[i] + d[j]), d[j], q);
        }
    }
    return Q;
}

double Structure::operator()(double cos_theta) const {
    const double sine_of_half = std::sqrt(std::max(0.0, 0.5 * (1.0 - cos_theta)));
    if (at_angles.empty()) {
        return percus_yevick(spheres.volume_fraction.front(),
                             2.0 * spheres.diameter.front() * sine_of_half);
    }
    const auto intervals = static_cast<double>(at_angles.size() - 1);
    return cubic_at(at_angles, 2.0 * std::asin(std::min(sine_of_half, 1.0)) / pi * intervals);
}

double CrowdedPhase::factor(double cos_theta) const { return structure(cos_theta) / mean; }

double CrowdedPhase::operator()(double cos_theta) const {
    return alone.phase(cos_theta) * factor(cos_theta);
}

std::string crowd_key(const ResolvedSpecies& species, std::size_t w) {
    JobKey key("crowd");
    for (const CrowdMember& member : species.crowd)
        key.add(member.volume_fraction).add(member.outer_radius_um).add(member.key[w]);
    return key.hash();
}

void require_crowd(const ResolvedSpecies& species, std::size_t w) {
    const double kd = kd_of(species, w);
    if (!(kd > 2.0 * kLargestSizeParameter)) return;
    throw UsageError(fmt::format(
        "medium '{}': its size parameter is {:.4g} at {} nm; packing percus-yevick goes up to "
        "{}: crowding of larger spheres changes their forward diffraction alone",
        describe(species.species), 0.5 * kd, species.particles[w].wavelength_nm,
        kLargestSizeParameter));
}

MediumOptics crowded(const MediumOptics& alone, const ResolvedSpecies& species, std::size_t w,
                     const std::vector<double>& angles_deg) {
    require_crowd(species, w);
    CrowdedPhase phase{alone.optics, structure_of(species, w), 1.0};
    const std::size_t count = alone.optics.chi.size();
    const math::Quadrature angles =
        angles_for(largest_kd(phase.structure), static_cast<int>(count));
    std::vector<double> values;
    for (const double theta : angles.nodes) values.push_back(phase(std::cos(theta)));
    MediumOptics whole = alone;
    whole.optics.chi = moments_of(angles, values, count);
    phase.mean = whole.optics.chi.front();
    for (double& chi : whole.optics.chi) chi /= phase.mean;
    whole.asymmetry = count > 1 ? whole.optics.chi[1] : 0.0;
    const double scattered = alone.optics.single_scattering_albedo * phase.mean;
    const double extinction = scattered + alone.optics.one_minus_albedo;
    whole.optics.single_scattering_albedo = scattered / extinction;
    whole.optics.one_minus_albedo = alone.optics.one_minus_albedo / extinction;
    whole.q_ext = alone.q_ext.value_or(0.0) * extinction;
    for (std::size_t i = 0; i < whole.phase.size(); ++i) {
        const double factor = phase.factor(std::cos(angles_deg[i] * pi / 180.0));
        whole.phase[i] *= factor;
        if (i < whole.phase_error.size()) whole.phase_error[i] *= factor;
    }
    whole.optics.phase = std::move(phase);
    return whole;
}

std::optional<double> crowding(const ResolvedMedium& medium, std::size_t w) {
    const auto there = std::find_if(medium.species.begin(), medium.species.end(),
                                    [](const auto& one) { return one.volume_fraction > 0.0; });
    if (there == medium.species.end()) return std::nullopt;
    const ResolvedSpecies& any = *there;
    double largest = 0.0;
    for (const CrowdMember& member : any.crowd)
        largest = std::max(largest,
                           2.0 * wave_number_per_um(member.particles[w]) * member.outer_radius_um);
    constexpr double kLargest = 60.0;
    if (0.5 * largest > kLargest) return std::nullopt;
    const Structure structure = structure_of(any, w);
    const math::Quadrature angles = angles_for(largest, static_cast<int>(2.0 * largest) + 20);
    std::vector<double> degrees, factor;
    for (const double theta : angles.nodes) {
        degrees.push_back(theta * 180.0 / pi);
        factor.push_back(structure(std::cos(theta)));
    }
    double alone = 0.0, together = 0.0;  // of the scattering, weighted by 1 - cos
    for (const ResolvedSpecies& species : medium.species) {
        if (species.volume_fraction == 0.0) continue;
        const double area_per_um =
            species.volume_fraction / (species.effective_radius_um * species.volume_per_core);
        for (const auto& [radius_um, share] : some_sizes(species, w)) {
            const auto amplitudes =
                mie::scattering_amplitudes(layers_of(species.particles[w], radius_um), degrees);
            const double number = area_per_um * share / (radius_um * radius_um);
            for (std::size_t i = 0; i < degrees.size(); ++i) {
                const double intensity = std::norm(amplitudes.s1[i]) + std::norm(amplitudes.s2[i]);
                const double part =
                    number * angles.weights[i] * (1.0 - std::cos(angles.nodes[i])) * intensity;
                alone += part;
                together += part * factor[i];
            }
        }
    }
    return together / alone;
}

}  // namespace miebrdf
