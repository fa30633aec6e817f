// Radiance of the sky: the standard skies of the CIE, and tables.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <numbers>
#include <set>

#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include "materials/readers/text_table.h"

namespace miebrdf {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// CIE S 003 (1996), clear sky (Kittler 1967): f(chi) phi(mu) over its value at the zenith.
double clear_sky(double mu, double from_sun_deg, double mu_sun) {
    const auto around_sun = [](double cos_chi) {
        const double c = std::clamp(cos_chi, -1.0, 1.0);
        return 0.91 + 10.0 * std::exp(-3.0 * std::acos(c)) + 0.45 * c * c;
    };
    const auto to_horizon = [](double at) { return -std::expm1(-0.32 / at); };
    const double sines = std::sqrt((1.0 - mu) * (1.0 + mu) * (1.0 - mu_sun) * (1.0 + mu_sun));
    const double cos_chi = mu * mu_sun + sines * std::cos(from_sun_deg * kDegree);
    return around_sun(cos_chi) * to_horizon(mu) / (around_sun(mu_sun) * to_horizon(1.0));
}

/// Two neighbours in an ascending list, and the share of the second.
struct Between {
    std::size_t first, second;
    double share;

    Between(const std::vector<double>& list, double x) : first(0), second(0), share(0.0) {
        if (list.size() < 2 || !(x > list.front())) return;
        first = second = list.size() - 1;
        if (!(x < list.back())) return;
        second = std::size_t(std::upper_bound(list.begin(), list.end(), x) - list.begin());
        first = second - 1;
        share = (x - list[first]) / (list[second] - list[first]);
    }
    template <typename At>
    double mix(const At& at) const {
        return (1.0 - share) * at(first) + (share > 0.0 ? share * at(second) : 0.0);
    }
};

std::vector<double> distinct(const std::vector<double>* column) {
    if (column == nullptr) return {};
    const std::set<double> values(column->begin(), column->end());
    return {values.begin(), values.end()};
}

Sky read_sky(const std::string& path) {
    const materials::NumberTable table(path);
    table.require_names({"zenith_deg", "azimuth_deg", "radiance"},
                        {"zenith_deg", "azimuth_deg", "radiance", "wavelength_nm"});
    const std::vector<double>* nm = table.find("wavelength_nm");
    const std::vector<double>&zenith = table.column("zenith_deg"),
          &azimuth = table.column("azimuth_deg"), &radiance = table.column("radiance");
    Sky sky{.kind = Sky::Kind::table,
            .wavelength_nm = distinct(nm),
            .zenith_deg = distinct(&zenith),
            .azimuth_deg = distinct(&azimuth),
            .file = path};
    const std::size_t points = sky.zenith_deg.size() * sky.azimuth_deg.size();
    const std::size_t count = points * std::max<std::size_t>(1, sky.wavelength_nm.size());
    if (count != table.rows())
        table.refuse(fmt::format("{} rows; expected {}: each zenith angle with each azimuth{} once",
                                 table.rows(), count, nm != nullptr ? " and wavelength" : ""));
    sky.values.assign(count, -1.0);
    const auto place = [](const std::vector<double>& list, double value) {
        return std::size_t(std::lower_bound(list.begin(), list.end(), value) - list.begin());
    };
    bool is_dark = true;
    for (std::size_t row = 0; row < table.rows(); ++row) {
        if (!(zenith[row] >= 0.0 && zenith[row] <= 90.0))
            table.refuse(row, fmt::format("zenith_deg {}; allowed: 0 to 90", zenith[row]));
        if (!(azimuth[row] >= 0.0 && azimuth[row] <= 360.0))
            table.refuse(
                row, fmt::format("azimuth_deg {}; allowed: 0 to 360, 0 = the sun's", azimuth[row]));
        if (!(radiance[row] >= 0.0))
            table.refuse(row, fmt::format("radiance {}; allowed: 0 or more", radiance[row]));
        const std::size_t w = nm != nullptr ? place(sky.wavelength_nm, (*nm)[row]) : 0;
        double& value =
            sky.values[w * points + place(sky.zenith_deg, zenith[row]) * sky.azimuth_deg.size() +
                       place(sky.azimuth_deg, azimuth[row])];
        if (value >= 0.0) table.refuse(row, "this point of the sky is there twice");
        value = radiance[row];
        is_dark = is_dark && value == 0.0;
    }
    if (is_dark) table.refuse("is dark everywhere");
    return sky;
}

}  // namespace

double Sky::radiance(double mu, double from_sun_deg, double mu_sun, double at_nm) const {
    switch (kind) {
        case Kind::uniform:
            return 1.0;
        case Kind::cie_clear:
            return clear_sky(mu, from_sun_deg, mu_sun);
        case Kind::cie_overcast:
            return (1.0 + 2.0 * mu) / 3.0;
        case Kind::table:
            break;
    }
    if (!wavelength_nm.empty() &&
        !(at_nm >= wavelength_nm.front() && at_nm <= wavelength_nm.back())) {
        throw InputError(fmt::format("sky '{}' has no radiance at {} nm; it covers {} to {} nm",
                                     file, at_nm, wavelength_nm.front(), wavelength_nm.back()));
    }
    double turned = std::fmod(std::abs(from_sun_deg), 360.0);
    if (azimuth_deg.back() <= 180.0) turned = std::min(turned, 360.0 - turned);
    const Between w(wavelength_nm, at_nm), z(zenith_deg, std::acos(std::min(mu, 1.0)) / kDegree),
        a(azimuth_deg, turned);
    return w.mix([&](std::size_t k) {
        return z.mix([&](std::size_t i) {
            return a.mix([&](std::size_t j) {
                return values[(k * zenith_deg.size() + i) * azimuth_deg.size() + j];
            });
        });
    });
}

Sky sky(const std::string& text) {
    if (text == "uniform") return {};
    if (text == "cie-clear") return {.kind = Sky::Kind::cie_clear};
    if (text == "cie-overcast") return {.kind = Sky::Kind::cie_overcast};
    if (std::filesystem::exists(text)) return read_sky(text);
    const std::string reason = fmt::format(
        "sky '{}': allowed: uniform, cie-clear, cie-overcast, or a CSV file with the columns "
        "zenith_deg,azimuth_deg,radiance",
        text);
    if (text.find_first_of("./\\") == std::string::npos) throw UsageError(reason);
    throw InputError(reason);  // it is meant to be a file
}

}  // namespace miebrdf
