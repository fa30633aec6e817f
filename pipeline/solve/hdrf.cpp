// Reflectance under a sky that is sun and diffuse light.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

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

}  // namespace

double AlbedoValues::under_sky(std::size_t wavelength, std::size_t in,
                               double diffuse_fraction) const {
    require_share(diffuse_fraction);
    return (1.0 - diffuse_fraction) * at(wavelength, in) +
           diffuse_fraction * spherical_albedo[wavelength];
}

HdrfValues Brdf::hdrf(const Directions& directions, double diffuse_fraction) const {
    require_share(diffuse_fraction);
    const bool diffuse = diffuse_fraction > 0.0, sunny = diffuse_fraction < 1.0;
    if (diffuse && scene().surface && scene().coupling != rte::SurfaceCoupling::reciprocal) {
        throw UsageError(
            "diffuse light on a rough surface needs the coupling 'reciprocal': with the paper's, "
            "what comes in from all sides is not what goes out to them");
    }
    const std::size_t ins = directions.mu_in.size(), outs = directions.mu_out.size(),
                      azimuths = directions.azimuth_deg.size();
    HdrfValues values;
    // The diffuse part is not evaluated at the sun's directions, but these are checked all the
    // same.
    const BrdfValues sun =
        evaluate(directions, {.subsurface = false, .surface = false, .total = sunny});
    if (sunny) add_report(values, sun);
    AlbedoValues sky;
    if (diffuse) {
        sky = albedo(directions.mu_out);
        add_report(values, sky);
    }
    values.directions = directions;
    values.diffuse_fraction = diffuse_fraction;
    for (std::size_t w = 0; w < values.wavelengths.size(); ++w) {
        std::vector<double>& all = values.hdrf.emplace_back(ins * outs * azimuths, 0.0);
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (sunny)
                all[i] = (1.0 - diffuse_fraction) * std::numbers::pi * sun.slices[w].total[i];
            if (diffuse) all[i] += diffuse_fraction * sky.at(w, i / azimuths % outs);
        }
    }
    return values;
}

}  // namespace miebrdf
