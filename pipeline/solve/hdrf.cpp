// Reflectance under a sky that is sun and diffuse light.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/value_derivatives.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "pipeline/solve/polarisation.h"
#include "rte/math/quadrature.h"
#include "rte/math/tolerance_budget.h"

namespace miebrdf {
namespace {

void require_share(double diffuse_fraction) {
    if (!(diffuse_fraction >= 0.0 && diffuse_fraction <= 1.0)) {
        throw UsageError("diffuse_fraction", diffuse_fraction,
                         "[0, 1]: 0 is the sun alone, 1 a uniform sky");
    }
}

/// Keeps the worse of both parts, wavelength by wavelength; the sums have no more than their
/// largest error.
void add_report(ResultReport& all, const ResultReport& part) {
    if (all.wavelengths.empty()) {
        all = part;
        return;
    }
    for (std::size_t w = 0; w < all.wavelengths.size(); ++w) {
        WavelengthReport& report = all.wavelengths[w];
        const WavelengthReport& other = part.wavelengths[w];
        if (report.optical_depths.empty()) report.optical_depths = other.optical_depths;
        report.mie_error_estimate = std::max(report.mie_error_estimate, other.mie_error_estimate);
        report.error_estimate = std::max(report.error_estimate, other.error_estimate);
        report.converged = report.converged && other.converged;
    }
}

/// @throws UsageError  where hdrf has no meaning
void require_sky(const Brdf& brdf, double diffuse_fraction) {
    require_share(diffuse_fraction);
    const Scene& scene = brdf.scene();
    if (diffuse_fraction > 0.0 && scene.surface &&
        scene.coupling != rte::SurfaceCoupling::reciprocal) {
        throw UsageError(
            "diffuse light on a rough surface needs the coupling 'reciprocal': with the paper's, "
            "what comes in from all sides is not what goes out to them");
    }
}

/// The sun's part is not evaluated under a uniform sky, but its directions are checked all the
/// same.
BrdfParts parts_of_sun(double diffuse_fraction) {
    return {.subsurface = false, .surface = false, .total = diffuse_fraction < 1.0};
}

/// The diffuse part of reflectance factors, or of a derivative of them: [wavelength][direction].
using Factors = std::vector<std::vector<double>>;

/// Of both parts, or their derivatives.
/// @param diffuse  empty: the sun's part alone
HdrfValues mixed(const Directions& directions, double diffuse_fraction, const BrdfValues& sun,
                 const Factors& diffuse) {
    HdrfValues values;
    values.directions = directions;
    values.diffuse_fraction = diffuse_fraction;
    const bool sunny = diffuse_fraction < 1.0;
    const std::size_t wavelengths = sunny ? sun.slices.size() : diffuse.size(),
                      size = directions.mu_in.size() * directions.mu_out.size() *
                             directions.azimuth_deg.size();
    for (std::size_t w = 0; w < wavelengths; ++w) {
        std::vector<double>& all = values.hdrf.emplace_back(size, 0.0);
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (sunny)
                all[i] = (1.0 - diffuse_fraction) * std::numbers::pi * sun.slices[w].total[i];
            if (!diffuse.empty()) all[i] += diffuse_fraction * diffuse[w][i];
        }
    }
    return values;
}

/// By reciprocity: the plane albedo at each mu_out.
Factors under_uniform_sky(const Directions& directions, const AlbedoValues& albedo) {
    const std::size_t ins = directions.mu_in.size(), outs = directions.mu_out.size(),
                      azimuths = directions.azimuth_deg.size();
    Factors factors;
    for (std::size_t w = 0; w < albedo.spherical_albedo.size(); ++w) {
        std::vector<double>& all = factors.emplace_back(ins * outs * azimuths);
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = albedo.at(w, i / azimuths % outs);
    }
    return factors;
}

/// Nodes of a sky: Gauss points in the cosine, even steps in the azimuth from the sun.
struct SkyNodes {
    math::Quadrature mu;
    int azimuths;

    SkyNodes(int cosines, int turns)
        : mu(math::gauss_legendre(cosines, 0.0, 1.0)), azimuths(turns) {}
    double from_sun(int k) const { return 360.0 * (k + 0.5) / azimuths; }

    /// From each node to each direction of reflection.
    Directions directions(const Directions& asked) const {
        Directions all{mu.nodes, asked.mu_out, {}};
        all.azimuth_deg.reserve(asked.azimuth_deg.size() * std::size_t(azimuths));
        for (const double view : asked.azimuth_deg) {
            for (int k = 0; k < azimuths; ++k) all.azimuth_deg.push_back(view - from_sun(k));
        }
        return all;
    }
};

/// pi f L mu over L mu, summed over the nodes.
/// @param f        at directions(), or a derivative
/// @param mirrors  at mu_out: a mirror shows the sky beyond it
Factors under_sky(const Directions& directions, const std::vector<double>& wavelength_nm,
                  const Sky& sky, const SkyNodes& nodes, const BrdfValues& f,
                  const AlbedoValues& mirrors) {
    const auto& [mu_in, mu_out, azimuth_deg] = directions;
    const math::Quadrature& mu = nodes.mu;
    const auto turns = std::size_t(nodes.azimuths);
    Factors factors;
    for (std::size_t w = 0; w < f.slices.size(); ++w) {
        const double nm = wavelength_nm[w];
        std::vector<double>& all = factors.emplace_back();
        for (const double sun : mu_in) {
            std::vector<double> weights(mu.nodes.size() * turns);
            double irradiance = 0.0;
            for (std::size_t i = 0; i < weights.size(); ++i) {
                const std::size_t n = i / turns;
                weights[i] = 2.0 * std::numbers::pi / nodes.azimuths * mu.weights[n] * mu.nodes[n] *
                             sky.radiance(mu.nodes[n], nodes.from_sun(int(i % turns)), sun, nm);
                irradiance += weights[i];
            }
            for (std::size_t o = 0; o < mu_out.size(); ++o) {
                for (std::size_t a = 0; a < azimuth_deg.size(); ++a) {
                    double sum = 0.0;
                    for (std::size_t i = 0; i < weights.size(); ++i)
                        sum += weights[i] * f.at(w, i / turns, o, a * turns + i % turns);
                    if (!mirrors.mirror_reflectance.empty())
                        sum += mirrors.mirror_reflectance[w][o] *
                               sky.radiance(mu_out[o], azimuth_deg[a], sun, nm);
                    all.push_back(irradiance > 0.0 ? std::numbers::pi * sum / irradiance : 0.0);
                }
            }
        }
    }
    return factors;
}

/// The errors of f in place of its values.
BrdfValues errors_of(const BrdfValues& f) {
    BrdfValues errors;
    errors.directions = f.directions;
    for (const BrdfValues::Slice& slice : f.slices)
        errors.slices.emplace_back().total = slice.errors;
    return errors;
}

/// In place of the errors of f, which are those of its worst direction, those of its means over
/// the sky: glories and horizons are little of it.
/// @param errors  of the factors, where those of f add up
void keep_mean_errors(ResultReport& report, const Factors& factors, const Factors& errors,
                      std::size_t incidences) {
    for (std::size_t w = 0; w < factors.size(); ++w) {
        WavelengthReport& at = report.wavelengths[w];
        const bool has_steps = at.solver.converged || at.solver.error_estimate > report.tolerance;
        const std::size_t block = factors[w].size() / incidences;
        at.error_estimate = 0.0;
        for (std::size_t start = 0; start < factors[w].size(); start += block) {
            double largest = 0.0, error = 0.0;
            for (std::size_t i = start; i < start + block; ++i) {
                largest = std::max(largest, factors[w][i]);
                error = std::max(error, errors[w][i]);
            }
            if (largest > 0.0) at.error_estimate = std::max(at.error_estimate, error / largest);
        }
        at.phase_noise = {};
        at.converged = has_converged(
            at.error_estimate, report.tolerance, has_steps,
            at.polarisation_left_out <= std::max(report.tolerance, kPromisedWithoutPolarisation));
    }
}

/// Adds what half as many nodes differ by to the error estimates.
void add_node_error(HdrfValues& values, const Factors& fine, const Factors& coarse) {
    for (std::size_t w = 0; w < fine.size(); ++w) {
        double largest = 0.0, apart = 0.0;
        for (std::size_t i = 0; i < fine[w].size(); ++i) {
            largest = std::max(largest, std::abs(values.hdrf[w][i]));
            apart = std::max(apart, std::abs(fine[w][i] - coarse[w][i]));
        }
        WavelengthReport& report = values.wavelengths[w];
        const double error = largest > 0.0 ? values.diffuse_fraction * apart / largest : 0.0;
        report.error_estimate = std::max(report.error_estimate, error);
        report.converged = report.converged && error <= values.tolerance;
    }
}

}  // namespace

double AlbedoValues::under_sky(std::size_t wavelength, std::size_t in,
                               double diffuse_fraction) const {
    require_share(diffuse_fraction);
    return (1.0 - diffuse_fraction) * at(wavelength, in) +
           diffuse_fraction * spherical_albedo[wavelength];
}

HdrfValues Brdf::hdrf(const Directions& directions, double diffuse_fraction) const {
    return hdrf(directions, diffuse_fraction, {});
}

HdrfValues Brdf::hdrf(const Directions& directions, double diffuse_fraction, const Sky& sky) const {
    return hdrf_derivatives(*this, {}, directions, diffuse_fraction, sky).values;
}

WithDerivatives<HdrfValues> hdrf_derivatives(const Brdf& brdf,
                                             const std::vector<std::string>& parameters,
                                             const Directions& directions, double diffuse_fraction,
                                             const Sky& sky) {
    require_sky(brdf, diffuse_fraction);
    std::optional<BrdfDerivatives> by;
    if (!parameters.empty()) by = brdf.derivatives(parameters);
    const auto evaluate = [&](const Directions& at, const BrdfParts& parts) {
        return by && parts.total ? by->evaluate(at, parts)
                                 : WithDerivatives<BrdfValues>{brdf.evaluate(at, parts), {}, {}};
    };
    const auto albedo = [&] {
        return by ? by->albedo(directions.mu_out)
                  : WithDerivatives<AlbedoValues>{brdf.albedo(directions.mu_out), {}, {}};
    };
    WithDerivatives<BrdfValues> sun = evaluate(directions, parts_of_sun(diffuse_fraction));
    sun.derivatives.resize(parameters.size());

    ResultReport report;
    if (diffuse_fraction < 1.0) add_report(report, sun.values);
    Factors diffuse, coarse;
    std::vector<Factors> slopes(parameters.size());
    if (diffuse_fraction > 0.0) {
        const WithDerivatives<AlbedoValues> at_out = albedo();
        if (sky.kind == Sky::Kind::uniform) {
            add_report(report, at_out.values);
            diffuse = under_uniform_sky(directions, at_out.values);
            for (std::size_t p = 0; p < slopes.size(); ++p)
                slopes[p] = under_uniform_sky(directions, at_out.derivatives[p]);
        } else {
            // Circumsolar light, lobes and glories are smooth beside the nodes, or the estimate
            // says so.
            constexpr int kCosines = 24, kAzimuths = 48;
            const BrdfParts whole{.subsurface = false, .errors = true};
            const std::vector<double>& nm = brdf.wavelength_nm();
            const SkyNodes few(kCosines / 2, kAzimuths / 2), nodes(kCosines, kAzimuths);
            coarse = under_sky(directions, nm, sky, few,
                               brdf.evaluate(few.directions(directions), whole), at_out.values);
            auto f = evaluate(nodes.directions(directions), whole);
            diffuse = under_sky(directions, nm, sky, nodes, f.values, at_out.values);
            keep_mean_errors(f.values, diffuse,
                             under_sky(directions, nm, sky, nodes, errors_of(f.values), {}),
                             directions.mu_in.size());
            add_report(report, f.values);
            for (std::size_t p = 0; p < slopes.size(); ++p)
                slopes[p] =
                    under_sky(directions, nm, sky, nodes, f.derivatives[p], at_out.derivatives[p]);
        }
    }
    WithDerivatives<HdrfValues> all{
        mixed(directions, diffuse_fraction, sun.values, diffuse), parameters, {}};
    static_cast<ResultReport&>(all.values) = std::move(report);
    if (!coarse.empty()) add_node_error(all.values, diffuse, coarse);
    for (std::size_t p = 0; p < parameters.size(); ++p)
        all.derivatives.push_back(
            mixed(directions, diffuse_fraction, sun.derivatives[p], slopes[p]));
    return all;
}

}  // namespace miebrdf
