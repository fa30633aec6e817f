#include "pipeline/sweep/eradiate.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <cmath>
#include <numbers>

namespace miebrdf::sweep {
namespace {

/// Steps are compared with this, relative to the whole axis: ranges have twelve digits.
constexpr double kEven = 1e-9;

bool is_even(const Axis& axis, double step) {
    for (std::size_t i = 0; i < axis.size(); ++i) {
        const double place = double(i) * step;
        if (!(std::abs(axis.numbers[i] - place) <= kEven * step * double(axis.size())))
            return false;
    }
    return true;
}

void require_cosines(const Axis& axis, const char* name) {
    const std::size_t n = axis.size();
    if (axis.name == name && n >= 2 && is_even(axis, 1.0 / double(n - 1))) return;
    throw UsageError(
        fmt::format("layout eradiate: {} goes from 0 to 1 in even steps; write {} = \"0:1:11 "
                    "linear\"",
                    axis.name, name));
}

}  // namespace

void require_eradiate_axes(const Sweep& sweep) {
    if (sweep.outputs != std::vector{Output::brdf})
        throw UsageError("layout eradiate: outputs = [\"brdf\"] is all that it holds");
    require_cosines(sweep.incidence, "mu_in");
    require_cosines(sweep.reflection, "mu_out");
    const std::size_t n = sweep.azimuth.size();
    if (n >= 2 && n % 2 == 0 && is_even(sweep.azimuth, 360.0 / double(n))) return;
    throw UsageError(
        "layout eradiate: azimuth_deg goes around in an even number of even steps, without 360; "
        "write azimuth_deg = \"0:345:15\"");
}

std::vector<double> eradiate_azimuths(const Axis& azimuth) {
    std::vector<double> phi;
    for (std::size_t i = 0; i < azimuth.size(); ++i)
        phi.push_back(2.0 * std::numbers::pi * double(i) / double(azimuth.size()));
    return phi;
}

std::vector<double> in_eradiate_order(const Sweep& sweep, const double* brdf) {
    const std::size_t wavelengths = sweep.wavelength.size(), in = sweep.incidence.size(),
                      out = sweep.reflection.size(), azimuths = sweep.azimuth.size();
    std::vector<double> ordered;
    ordered.reserve(wavelengths * in * out * azimuths);
    for (std::size_t o = 0; o < out; ++o) {
        for (std::size_t phi = 0; phi < azimuths; ++phi) {
            // Our azimuth is 0 at the mirror's side: 180 degrees minus phi_d.
            const std::size_t a = (azimuths + azimuths / 2 - phi) % azimuths;
            for (std::size_t i = 0; i < in; ++i) {
                for (std::size_t w = 0; w < wavelengths; ++w)
                    ordered.push_back(brdf[((w * in + i) * out + o) * azimuths + a]);
            }
        }
    }
    return ordered;
}

}  // namespace miebrdf::sweep
