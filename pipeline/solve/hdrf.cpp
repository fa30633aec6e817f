// Reflectance under a sky that is sun and diffuse light.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/value_derivatives.h>

#include <algorithm>
#include <numbers>

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
/// @param sky  at the cosines of reflection; not looked at without diffuse light
HdrfValues mixed(const Directions& directions, double diffuse_fraction, const BrdfValues& sun,
                 const AlbedoValues& sky) {
    const bool diffuse = diffuse_fraction > 0.0, sunny = diffuse_fraction < 1.0;
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
