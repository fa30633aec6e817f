// What integrating spheres make of the light that a sample returns and passes. Formulas: Pickering,
// Prahl et al., Applied Optics 32, 399 (1993), with baffles; Prahl, "Everything I think you should
// know about inverse adding-doubling" (the manual of iad).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <utility>

#include <miebrdf/error.h>
#include <miebrdf/measured.h>

namespace miebrdf {
namespace {

/// Letters of Pickering et al.: a are areas of ports over that of the sphere, r reflectances of the
/// wall (w), detector (d), sample (s) and third port (t).
struct Sphere {
    double a_s, a_t, a_d, a_w, r_w, r_d, r_std;
    bool baffle;

    explicit Sphere(const IntegratingSphere& from)
        : r_w(from.wall), r_d(from.detector), r_std(from.standard), baffle(from.baffle) {
        const auto share = [&](double port_mm) {
            const double ratio = 0.5 * port_mm / from.diameter_mm;
            return ratio * ratio;
        };
        a_s = share(from.sample_port_mm);
        a_t = share(from.third_port_mm);
        a_d = share(from.detector_port_mm);
        a_w = 1.0 - a_s - a_t - a_d;
    }

    /// Light on the detector over that of a black sphere.
    double gain(double r_s, double r_t) const {
        if (!baffle) return 1.0 / (1.0 - a_w * r_w - a_d * r_d - a_s * r_s - a_t * r_t);
        const double first = r_w + a_t / a_w * r_t;
        return 1.0 / (1.0 - first * (a_w + (1.0 - a_t) * (a_d * r_d + a_s * r_s)));
    }
    /// Of light from the sample what the first wall leaves, where the detector does not see it.
    double first_bounce(double r_t) const { return baffle ? (1.0 - a_t) * r_w + a_t * r_t : 1.0; }
};

/// What the spheres get.
struct Collected {
    double r = 0.0, t = 0.0;      ///< scattered, of direct light
    double r_u = 0.0, t_u = 0.0;  ///< straight
    double R = 0.0, T = 0.0;      ///< of diffuse light, alike on both sides
};

Collected collected(const SphereMeasurement& m, const SlabLight& light) {
    return {.r = light.r_direct - light.r_unscattered,
            .t = light.t_direct - light.t_unscattered,
            .r_u = m.unscattered_reflectance * light.r_unscattered,
            .t_u = m.unscattered_transmittance * light.t_unscattered,
            .R = light.r_diffuse,
            .T = light.t_diffuse};
}

double one_above(const SphereMeasurement& m, const Collected& c) {
    const Sphere s(m.above);
    const double f = m.hits_wall, first = s.first_bounce(0.0);
    // iad takes the standard's light without its first bounce.
    const double of_standard = m.as_iad ? 1.0 : first;
    const double nothing = s.gain(0.0, 0.0) * of_standard * f * s.r_w;
    const double standard = s.gain(s.r_std, 0.0) * of_standard * ((1.0 - f) * s.r_std + f * s.r_w);
    const double sample =
        s.gain(c.R, 0.0) * (first * ((1.0 - f) * c.r + f * s.r_w) + s.r_w * (1.0 - f) * c.r_u);
    return s.r_std * (sample - nothing) / (standard - nothing);
}

double one_below(const SphereMeasurement& m, const Collected& c) {
    const Sphere s(m.below);
    const double r_cal = s.a_t == 0.0 ? s.r_w : s.r_std;
    const double r_third = s.a_t > 0.0 && m.unscattered_transmittance == 0.0 ? 0.0 : r_cal;
    const double sample = s.gain(c.R, r_third) * (s.first_bounce(r_third) * c.t + r_third * c.t_u);
    // iad's 100 % is what the standard returns of the open beam.
    return sample / (s.gain(0.0, r_cal) * (m.as_iad ? 1.0 : r_cal));
}

/// Light on a detector of two spheres: the one above, or below.
double of_two(const SphereMeasurement& m, bool below, const Collected& c) {
    const Sphere above(m.above), under(m.below);
    const double f = m.hits_wall, G = above.gain(c.R, 0.0), G_below = under.gain(c.R, 0.0);
    const double passes = (1.0 - above.a_t) * (1.0 - under.a_t);
    // iad has the areas of the walls in place of their reflectances.
    const double walls = m.as_iad ? above.a_w * under.a_w : above.r_w * under.r_w;
    const double exchange =
        1.0 / (1.0 - above.a_s * under.a_s * walls * passes * G * G_below * c.T * c.T);
    const double r = (1.0 - f) * (c.r + c.r_u) + f * above.r_w, t = (1.0 - f) * (c.t + c.t_u);
    const double in_above = (1.0 - above.a_t) * above.r_w, in_below = (1.0 - under.a_t) * under.r_w;
    if (below) return in_below * G_below * exchange * (t + in_above * above.a_s * c.T * r * G);
    return in_above * G * exchange * (r + under.a_s * in_below * t * c.T * G_below);
}

double two(const SphereMeasurement& m, bool below, const Collected& c) {
    const double std = m.above.standard, nothing = of_two(m, below, {});
    const Collected whole = below ? Collected{.t = 1.0, .T = 1.0} : Collected{.r = std, .R = std};
    return (below ? 1.0 : std) * (of_two(m, below, c) - nothing) /
           (of_two(m, below, whole) - nothing);
}

using Words = SphereMeasurement;
IntegratingSphere& of(Words& m, bool below) { return below ? m.below : m.above; }

constexpr double kLargestMm = 1e4;
struct Word {
    std::string_view name;
    double& (*number)(Words& m, bool below);
    double most = 1.0;
};
constexpr Word kWords[] = {
    {"diameter", [](Words& m, bool b) -> double& { return of(m, b).diameter_mm; }, kLargestMm},
    {"sample_port", [](Words& m, bool b) -> double& { return of(m, b).sample_port_mm; },
     kLargestMm},
    {"third_port", [](Words& m, bool b) -> double& { return of(m, b).third_port_mm; }, kLargestMm},
    {"detector_port", [](Words& m, bool b) -> double& { return of(m, b).detector_port_mm; },
     kLargestMm},
    {"wall", [](Words& m, bool b) -> double& { return of(m, b).wall; }},
    {"detector", [](Words& m, bool b) -> double& { return of(m, b).detector; }},
    {"standard", [](Words& m, bool b) -> double& { return of(m, b).standard; }},
    {"unscattered_reflectance",
     [](Words& m, bool) -> double& { return m.unscattered_reflectance; }},
    {"unscattered_transmittance",
     [](Words& m, bool) -> double& { return m.unscattered_transmittance; }},
    {"hits_wall", [](Words& m, bool) -> double& { return m.hits_wall; }},
    {"beam", [](Words& m, bool) -> double& { return m.beam_mm; }, kLargestMm}};

void check(const IntegratingSphere& sphere) {
    if (!(sphere.diameter_mm > 0.0 && sphere.sample_port_mm > 0.0 && sphere.wall > 0.0 &&
          sphere.standard > 0.0))
        throw UsageError(
            "sphere: give diameter and sample_port in mm, and the reflectances of its wall and "
            "standard, "
            "sphere = { diameter = 200, sample_port = 25, wall = 0.97 }");
    const Sphere s(sphere);
    if (!(s.a_w > 0.5))
        throw UsageError("sphere: share of its area that is wall", s.a_w,
                         "above 0.5: ports smaller than the sphere");
}

}  // namespace

SphereMeasurement SphereMeasurement::at(double wavelength_nm) const {
    SphereMeasurement here = *this;
    if (rows.empty()) return here;
    const auto next = std::find_if(rows.begin(), std::prev(rows.end()), [&](const SphereRow& row) {
        return row.wavelength_nm >= wavelength_nm;
    });
    const SphereRow &high = *next, &low = next == rows.begin() ? high : *std::prev(next);
    const double apart = high.wavelength_nm - low.wavelength_nm;
    const double t =
        apart > 0.0 ? std::clamp((wavelength_nm - low.wavelength_nm) / apart, 0.0, 1.0) : 0.0;
    const auto between = [&](auto member) { return std::lerp(low.*member, high.*member, t); };
    here.above.wall = between(&SphereRow::wall_above);
    here.below.wall = between(&SphereRow::wall_below);
    here.above.standard = between(&SphereRow::standard_above);
    here.below.standard = between(&SphereRow::standard_below);
    return here;
}

double sphere_reading(const SphereMeasurement& m, bool transmitted, const SlabLight& light) {
    const Collected c = collected(m, light);
    if (m.spheres == 0) return transmitted ? c.t + c.t_u : c.r + c.r_u;
    if (m.spheres == 2) return two(m, transmitted, c);
    return transmitted ? one_below(m, c) : one_above(m, c);
}

void set_sphere_word(SphereMeasurement& m, const std::string& word, double value, bool other) {
    std::string allowed = "baffle, dual_beam, lost_light";
    for (const Word& known : kWords) {
        allowed += fmt::format(", {}", known.name);
        if (known.name != word) continue;
        if (!(value >= 0.0 && value <= known.most))
            throw UsageError("sphere: " + word, value, fmt::format("0 to {}", known.most));
        known.number(m, true) = value;
        if (!other) known.number(m, false) = value;
        return;
    }
    if (word == "dual_beam") {
        m.spheres = value != 0.0 ? 0 : 1;
    } else if (word == "lost_light") {
        m.lost_light = value != 0.0;
    } else if (word != "baffle") {
        throw UsageError("sphere: word", word, allowed);
    } else {
        m.below.baffle = value != 0.0;
        if (!other) m.above.baffle = m.below.baffle;
    }
}

void validate(const SphereMeasurement& m) {
    if (m.lost_light && !(m.above.sample_port_mm > 0.0 && m.below.sample_port_mm > 0.0))
        throw UsageError(
            "sphere: lost_light needs the diameters of beam and port in mm, beam = 5, sample_port "
            "= "
            "25");
    if (m.spheres == 0) return;
    check(m.above);
    check(m.below);
}

}  // namespace miebrdf
