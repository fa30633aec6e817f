#include "tools/miebrdf/measured_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "pipeline/plot/chart.h"
#include "tools/miebrdf/command.h"

namespace miebrdf::program {
namespace {

/// Samples in the colours of the palette; more are a family from dark to light.
constexpr std::size_t kPalette = 8;
/// Panels of a chart of directions: one for each angle of incidence.
constexpr std::size_t kMostPanels = 6;

double degrees_of(double mu) { return std::acos(std::min(mu, 1.0)) * 180.0 / std::numbers::pi; }

std::string axis_of(MeasuredQuantity quantity) {
    if (quantity == MeasuredQuantity::brdf) return "BRDF [1/sr]";
    std::string word = word_of(quantity);
    std::replace(word.begin(), word.end(), '_', ' ');
    return word;
}

/// One panel for an incidence; a curve for each wavelength and distance from the plane of
/// incidence.
plot::Panel panel_of(const Measurements& list, double theta_in, bool waves) {
    plot::Panel panel;
    panel.x = {"angle of reflection [\u00b0], positive on the mirror side", plot::Scale::linear,
               -90.0, 90.0, 30.0};
    panel.note = fmt::format("incidence {:.3g}\u00b0", theta_in);
    std::map<std::pair<double, int>, plot::Curve> curves;
    for (const MeasuredValue& v : list.values) {
        if (std::isnan(v.mu_in) || std::isnan(v.mu_out)) continue;
        if (std::abs(std::round(degrees_of(v.mu_in)) - theta_in) > 0.5) continue;
        panel.y.label = axis_of(v.quantity);
        const double azimuth = std::isnan(v.azimuth_deg) ? 0.0 : v.azimuth_deg;
        const double from_plane = std::min(azimuth, 360.0 - azimuth);  // [0, 180]
        const bool mirror_side = from_plane <= 90.0;
        const double off = mirror_side ? from_plane : 180.0 - from_plane;
        const int band = off <= 5.0 ? 0 : off <= 45.0 ? 1 : 2;
        plot::Curve& curve = curves[{waves ? v.wavelength_nm : 0.0, band}];
        static constexpr const char* kBands[] = {"in the plane", "up to 45\u00b0 from it",
                                                 "beyond"};
        curve.label = (waves ? fmt::format("{:g} nm, ", v.wavelength_nm) : "") + kBands[band];
        curve.mark = plot::Mark::points;
        curve.x.push_back(degrees_of(v.mu_out) * (mirror_side ? 1.0 : -1.0));
        curve.y.push_back(v.value);
    }
    for (auto& [key, curve] : curves) panel.curves.push_back(std::move(curve));
    return panel;
}

plot::Picture draw_directions(const Measurements& list, const plot::Caption& caption) {
    std::map<double, std::size_t> incidences;
    std::vector<double> wavelengths;
    for (const MeasuredValue& v : list.values) {
        if (std::isnan(v.mu_in) || std::isnan(v.mu_out)) continue;
        ++incidences[std::round(degrees_of(v.mu_in))];
        if (std::find(wavelengths.begin(), wavelengths.end(), v.wavelength_nm) == wavelengths.end())
            wavelengths.push_back(v.wavelength_nm);
    }
    // The incidences that most values have.
    std::vector<std::pair<double, std::size_t>> most(incidences.begin(), incidences.end());
    std::stable_sort(most.begin(), most.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    if (most.size() > kMostPanels) most.resize(kMostPanels);
    std::sort(most.begin(), most.end());
    std::vector<plot::Panel> panels;
    for (const auto& [theta_in, count] : most) {
        panels.push_back(panel_of(list, theta_in, wavelengths.size() > 1));
        panels.back().height = most.size() == 1 ? 260.0 : 150.0;
    }
    return plot::draw_chart(panels, caption);
}

}  // namespace

void MeasuredArguments::add_to(CLI::App& command) {
    auto* group = command.add_option_group("Facts that the file lacks");
    std::string names;
    for (const MeasuredFormat& format : measured_formats())
        names += (names.empty() ? "" : ", ") + std::string(format.name);
    option(*group, "--format", options_.format, "NAME",
           "format of the file; default: recognised by its content. One of " + names);
    option(*group, "--column", options_.column, "NAME", "read one column or sample only");
    option(*group, "--quantity", options_.quantity, "WORD",
           "what the values are, whatever the file says: plane_albedo, spherical_albedo, "
           "hemispherical, plane_transmittance, spherical_transmittance, "
           "unscattered_transmittance, brdf, reflectance_factor, hdrf, "
           "d8-sci, d8-sce, 45-0, reflectance, transmittance");
    auto* percent = group->add_flag("--percent", percent_, "the values are percent");
    group->add_flag("--shares", shares_, "the values are fractions of 1, whatever the file says")
        ->excludes(percent);
    option(*group, "--wavelength", options_.wavelength_nm, "NM",
           "wavelength in nm of values that have none in the file");
    mu_in_.add_to(*group, "cosine of incidence of values that have none in the file");
    mu_out_.add_to(*group, "cosine of reflection of values that have none in the file");
    option(*group, "--azimuth", options_.azimuth_deg, "DEG",
           "azimuth in degrees (0 = mirror side) of values that have none in the file");
    option(*group, "--azimuth-zero", options_.azimuth_zero, "SIDE",
           "what azimuth 0 means in the file: mirror, or back (towards the source)");
    option(*group, "--sigma", options_.sigma, "NUMBER",
           "standard error of values that have none in the file");
    option(*group, "--relative-sigma", options_.relative_sigma, "NUMBER",
           "the same as a fraction of the value");
    option(*group, "--wavelengths-file", wavelengths_, "FILE",
           "file with the wavelengths of a spectrum of the USGS library");
}

Measurements MeasuredArguments::read(const std::string& path) const {
    MeasuredOptions options = options_;
    if (percent_ || shares_) options.percent = percent_;
    const auto one = [](const DirectionArgument& argument, const char* name) {
        const std::vector<double> list = argument.parse();
        if (list.size() != 1) {
            throw UsageError(name, fmt::format("{} numbers", list.size()), "one");
        }
        return list.front();
    };
    if (mu_in_.given()) options.mu_in = one(mu_in_, "mu_in");
    if (mu_out_.given()) options.mu_out = one(mu_out_, "mu_out");
    options.wavelengths = wavelengths_;
    return read_measured(path, options);
}

std::vector<plot::Curve> measured_curves(const Measurements& list, plot::Mark mark) {
    std::map<std::tuple<std::size_t, MeasuredQuantity, MeasuredGeometry>, plot::Curve> curves;
    for (const MeasuredValue& v : list.values) {
        if (std::isnan(v.wavelength_nm) || v.quantity >= MeasuredQuantity::lab_l) continue;
        plot::Curve& curve = curves[{v.sample, v.quantity, v.geometry}];
        curve.label = list.samples[v.sample];
        curve.mark = mark;
        curve.x.push_back(v.wavelength_nm);
        curve.y.push_back(v.value);
    }
    std::vector<plot::Curve> all;
    for (auto& [key, curve] : curves) {
        if (curves.size() > kPalette) curve.shade = double(all.size()) / double(curves.size() - 1);
        all.push_back(std::move(curve));
    }
    return all;
}

plot::Picture draw_measured(const Measurements& list, const plot::Caption& caption) {
    const bool directions = std::any_of(list.values.begin(), list.values.end(), [](const auto& v) {
        return v.geometry == MeasuredGeometry::directions && !std::isnan(v.mu_out) &&
               !std::isnan(v.mu_in);
    });
    if (directions) return draw_directions(list, caption);
    plot::Panel panel;
    panel.x.label = "vacuum wavelength [nm]";
    panel.curves = measured_curves(list, plot::Mark::line);
    if (panel.curves.empty()) {
        throw InputError(
            list.file + ": holds neither spectra nor directions, so that there is nothing to draw");
    }
    panel.y.label = axis_of(list.values.front().quantity);
    for (plot::Curve& curve : panel.curves) {
        constexpr std::size_t kFewPoints = 60;  // that marks do not cover each other
        if (curve.x.size() <= kFewPoints) curve.mark = plot::Mark::line_and_points;
    }
    return plot::draw_chart({panel}, caption);
}

}  // namespace miebrdf::program
