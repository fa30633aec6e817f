// Reflectance under a sky that is sun and diffuse light.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/value_derivatives.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/transfer.h>
#include "rte/math/quadrature.h"

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

/// Of both parts, or their derivatives.
/// @param sky  at the cosines of reflection; empty: the sun's part alone
HdrfValues mixed(const Directions& directions, double diffuse_fraction, const BrdfValues& sun,
                 const AlbedoValues& sky) {
    const bool diffuse = diffuse_fraction > 0.0 && !sky.spherical_albedo.empty(),
               sunny = diffuse_fraction < 1.0;
    const std::size_t ins = directions.mu_in.size(), outs = directions.mu_out.size(),
                      azimuths = directions.azimuth_deg.size();
    HdrfValues values;
    if (sunny) add_report(values, sun);
    if (diffuse) add_report(values, sky);
    values.directions = directions;
    values.diffuse_fraction = diffuse_fraction;
    const std::size_t wavelengths = sunny ? sun.slices.size() : sky.spherical_albedo.size();
    for (std::size_t w = 0; w < wavelengths; ++w) {
        std::vector<double>& all = values.hdrf.emplace_back(ins * outs * azimuths, 0.0);
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (sunny)
                all[i] = (1.0 - diffuse_fraction) * std::numbers::pi * sun.slices[w].total[i];
            if (diffuse) all[i] += diffuse_fraction * sky.at(w, i / azimuths % outs);
        }
    }
    return values;
}

}  // namespace

double AlbedoValues::under_sky(std::size_t wavelength, std::size_t in,
                               double diffuse_fraction) const {
    require_share(diffuse_fraction);
    return (1.0 - diffuse_fraction) * at(wavelength, in) +
           diffuse_fraction * spherical_albedo[wavelength];
}

HdrfValues Brdf::hdrf(const Directions& directions, double diffuse_fraction) const {
    require_sky(*this, diffuse_fraction);
    const BrdfValues sun = evaluate(directions, parts_of_sun(diffuse_fraction));
    return mixed(directions, diffuse_fraction, sun,
                 diffuse_fraction > 0.0 ? albedo(directions.mu_out) : AlbedoValues{});
}

namespace {

/// pi f L mu over L mu, summed over nodes of the sky: [wavelength][direction].
struct SkySums {
    std::vector<std::vector<double>> factor;
    ResultReport report;
};

/// @param cosines, azimuths  of the nodes, how many
SkySums under_sky(const Brdf& brdf, const Directions& directions, const Sky& sky, int cosines,
                  int azimuths) {
    const math::Quadrature mu = math::gauss_legendre(cosines, 0.0, 1.0);
    const auto& [mu_in, mu_out, azimuth_deg] = directions;
    Directions nodes{mu.nodes, mu_out, {}};
    const auto from_sun = [&](int k) { return 360.0 * (k + 0.5) / azimuths; };
    nodes.azimuth_deg.reserve(azimuth_deg.size() * std::size_t(azimuths));
    for (const double view : azimuth_deg) {
        for (int k = 0; k < azimuths; ++k) nodes.azimuth_deg.push_back(view - from_sun(k));
    }
    const BrdfValues f = brdf.evaluate(nodes, {.subsurface = false, .total = true});
    // A mirror shows the sky beyond it.
    const AlbedoValues mirrors = brdf.albedo(mu_out);
    const auto turns = std::size_t(azimuths);
    SkySums sums;
    sums.report = f;
    for (std::size_t w = 0; w < f.slices.size(); ++w) {
        const double nm = brdf.wavelength_nm()[w];
        std::vector<double>& all = sums.factor.emplace_back();
        for (const double sun : mu_in) {
            std::vector<double> weights(mu.nodes.size() * turns);
            double irradiance = 0.0;
            for (std::size_t i = 0; i < weights.size(); ++i) {
                const std::size_t n = i / turns;
                weights[i] = 2.0 * std::numbers::pi / azimuths * mu.weights[n] * mu.nodes[n] *
                             sky.radiance(mu.nodes[n], from_sun(int(i % turns)), sun, nm);
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
    return sums;
}

}  // namespace

HdrfValues Brdf::hdrf(const Directions& directions, double diffuse_fraction, const Sky& sky) const {
    if (sky.kind == Sky::Kind::uniform || diffuse_fraction == 0.0)
        return hdrf(directions, diffuse_fraction);
    require_sky(*this, diffuse_fraction);
    rte::validate(directions);
    // Circumsolar light, lobes and glories are smooth beside the nodes, or the estimate says so.
    constexpr int kCosines = 24, kAzimuths = 48;
    const SkySums coarse = under_sky(*this, directions, sky, kCosines / 2, kAzimuths / 2);
    SkySums fine = under_sky(*this, directions, sky, kCosines, kAzimuths);
    HdrfValues values = mixed(directions, diffuse_fraction,
                              evaluate(directions, parts_of_sun(diffuse_fraction)), {});
    add_report(values, fine.report);
    for (std::size_t w = 0; w < fine.factor.size(); ++w) {
        double largest = 0.0, apart = 0.0;
        if (values.hdrf.size() == w) values.hdrf.emplace_back(fine.factor[w].size(), 0.0);
        for (std::size_t i = 0; i < fine.factor[w].size(); ++i) {
            values.hdrf[w][i] += diffuse_fraction * fine.factor[w][i];
            largest = std::max(largest, std::abs(values.hdrf[w][i]));
            apart = std::max(apart, std::abs(fine.factor[w][i] - coarse.factor[w][i]));
        }
        WavelengthReport& report = values.wavelengths[w];
        const double error = largest > 0.0 ? diffuse_fraction * apart / largest : 0.0;
        report.error_estimate = std::max(report.error_estimate, error);
        report.converged = report.converged && error <= values.tolerance;
    }
    return values;
}

WithDerivatives<HdrfValues> hdrf_derivatives(const Brdf& brdf,
                                             const std::vector<std::string>& parameters,
                                             const Directions& directions,
                                             double diffuse_fraction) {
    require_sky(brdf, diffuse_fraction);
    const BrdfDerivatives by = brdf.derivatives(parameters);
    const BrdfParts parts = parts_of_sun(diffuse_fraction);
    WithDerivatives<BrdfValues> sun;
    if (parts.total) {
        sun = by.evaluate(directions, parts);
    } else {
        sun.values = brdf.evaluate(directions, parts);
    }
    WithDerivatives<AlbedoValues> sky;
    if (diffuse_fraction > 0.0) sky = by.albedo(directions.mu_out);
    sun.derivatives.resize(parameters.size());
    sky.derivatives.resize(parameters.size());
    WithDerivatives<HdrfValues> all{
        mixed(directions, diffuse_fraction, sun.values, sky.values), parameters, {}};
    for (std::size_t p = 0; p < parameters.size(); ++p) {
        HdrfValues& derivative = all.derivatives.emplace_back(
            mixed(directions, diffuse_fraction, sun.derivatives[p], sky.derivatives[p]));
        static_cast<ResultReport&>(derivative) = {};
    }
    return all;
}

}  // namespace miebrdf
