// What a glossmeter reads.
#include <miebrdf/colour.h>

#include <algorithm>
#include <cmath>

#include "pipeline/solve/vector_pairs.h"
#include "rte/math/quadrature.h"
#include "rte/surface/fresnel.h"

namespace miebrdf {
namespace {

constexpr double kBlackGlass = 1.567;  // index at 587.6 nm (ISO 2813)

/// Widths in the plane of incidence and across it, degrees: those of ISO 2813 and ASTM D523 as
/// commonly quoted (docs/colour.md).
struct Aperture {
    double in_plane, across;
};
constexpr Aperture kGlossSource = {0.75, 2.5};
struct GlossAngle {
    double angle_deg;
    Aperture receptor;
};
constexpr GlossAngle kGeometries[] = {{20, {1.8, 3.6}}, {60, {4.4, 11.7}}, {85, {4.0, 6.0}}};

/// Offsets d of the outgoing ray from the mirror direction of the incident one. The share of the
/// source whose ray meets the receptor is a trapezoid of d, because the BRDF depends on d alone
/// while the incidence moves by a fraction of a degree. Nodes of its plateau go like u^2, since
/// narrow lobes lie at 0: of a Gaussian exp(-(d / w)^2) they integrate 1e-3 for w of 1 % of the
/// plateau.
struct Offsets {
    std::vector<double> radians, weight;
};
Offsets offsets(double receptor_deg, double source_deg) {
    constexpr int kPlateau = 20, kSlope = 4;
    const double plateau = 0.5 * (receptor_deg - source_deg), end = plateau + source_deg;
    Offsets all;
    const auto add = [&](double d, double weight) {
        all.radians.push_back(kDegree * d);
        all.weight.push_back(kDegree * weight);
    };
    const auto inner = math::gauss_legendre(kPlateau, 0.0, 1.0);
    for (std::size_t i = 0; i < inner.nodes.size(); ++i) {
        const double u = inner.nodes[i];
        add(plateau * u * u, plateau * 2.0 * u * inner.weights[i]);
    }
    const auto outer = math::gauss_legendre(kSlope, plateau, end);
    for (std::size_t i = 0; i < outer.nodes.size(); ++i)
        add(outer.nodes[i], outer.weights[i] * (end - outer.nodes[i]) / source_deg);
    return all;
}

/// The worse report of each wavelength.
void take_worse(ResultReport& all, const ResultReport& more) {
    if (all.wavelengths.empty()) {
        all = more;
        return;
    }
    for (std::size_t w = 0; w < all.wavelengths.size(); ++w) {
        if (more.wavelengths[w].error_estimate > all.wavelengths[w].error_estimate)
            all.wavelengths[w] = more.wavelengths[w];
    }
}

}  // namespace

GlossValues gloss(const Brdf& brdf, const Viewing& viewing) {
    const ObserverWeights weights = observer_weights(brdf.wavelength_nm(), viewing);
    GlossValues result;
    for (const auto& [angle_deg, receptor] : kGeometries) {
        const double theta = kDegree * angle_deg;
        const Offsets in_plane = offsets(receptor.in_plane, kGlossSource.in_plane),
                      across = offsets(receptor.across, kGlossSource.across);
        Directions directions{{std::cos(theta)}, {}, {}};
        std::vector<double> flux_of_row;  // solid angle and cosine, of either side
        for (const double side : {-1.0, 1.0}) {
            for (std::size_t i = 0; i < in_plane.radians.size(); ++i) {
                const double out = theta + side * in_plane.radians[i];
                directions.mu_out.push_back(std::cos(out));
                flux_of_row.push_back(in_plane.weight[i] * std::sin(out) * std::cos(out) /
                                      std::sin(theta));
            }
        }
        for (const double d : across.radians)
            directions.azimuth_deg.push_back(d / std::sin(theta) / kDegree);
        const BrdfValues values = brdf.evaluate(directions);
        std::vector<double> reflectance;
        for (const BrdfValues::Slice& slice : values.slices) {
            double flux = slice.mirror_reflectance.empty() ? 0.0 : slice.mirror_reflectance[0];
            for (std::size_t o = 0; o < flux_of_row.size(); ++o) {
                for (std::size_t a = 0; a < across.weight.size(); ++a)
                    flux += 2.0 * flux_of_row[o] * across.weight[a] *
                            slice.total[o * across.weight.size() + a];
            }
            reflectance.push_back(flux);
        }
        const double luminous = to_xyz(weights, reflectance).y;
        result.angles.push_back(
            {angle_deg, luminous,
             100.0 * luminous / rte::fresnel_reflectance(kBlackGlass, std::cos(theta))});
        take_worse(result, values);
    }
    return result;
}

}  // namespace miebrdf
