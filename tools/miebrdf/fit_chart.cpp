#include "tools/miebrdf/fit_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/plot/chart.h"

namespace miebrdf::program {
namespace {

double degrees(double cosine) {
    return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

bool has_view(const MeasuredValue& value) { return value.mu_out > 0.0; }

double azimuth_of(const MeasuredValue& value) {
    return std::isnan(value.azimuth_deg) ? 0.0 : std::remainder(value.azimuth_deg, 360.0);
}

/// The angle of view, negative on the side of the light.
double signed_angle(const MeasuredValue& value) {
    return std::abs(azimuth_of(value)) <= 90.0 ? degrees(value.mu_out) : -degrees(value.mu_out);
}

bool is_in_plane(const MeasuredValue& value) {
    constexpr double kNear = 10.0;  // degrees of azimuth
    return std::abs(std::remainder(azimuth_of(value), 180.0)) <= kNear ||
           degrees(value.mu_out) <= 1.0;
}

/// Values of one colour: measured ones, the model's, and their differences.
struct Series {
    std::string label;
    struct At {
        double x, measured, model;
    };
    std::vector<At> shown = {};
    std::vector<double> residual_x = {}, residual = {};
};

std::vector<plot::Curve> curves_of(std::vector<Series>& all) {
    std::vector<plot::Curve> curves;
    for (std::size_t i = 0; i < all.size(); ++i) {
        std::sort(all[i].shown.begin(), all[i].shown.end(),
                  [](const auto& a, const auto& b) { return a.x < b.x; });
        plot::Curve measured, model;
        measured.label = all[i].label;
        measured.mark = plot::Mark::points;
        measured.colour = model.colour = int(i);
        for (const Series::At& at : all[i].shown) {
            measured.x.push_back(at.x);
            measured.y.push_back(at.measured);
            model.x.push_back(at.x);
            model.y.push_back(at.model);
        }
        curves.push_back(std::move(measured));
        curves.push_back(std::move(model));
    }
    return curves;
}

std::vector<plot::Curve> residuals_of(const std::vector<Series>& all) {
    std::vector<plot::Curve> curves;
    for (std::size_t i = 0; i < all.size(); ++i)
        curves.push_back({.label = "",
                          .x = all[i].residual_x,
                          .y = all[i].residual,
                          .mark = plot::Mark::points,
                          .colour = int(i)});
    return curves;
}

Series& series_of(std::vector<Series>& all, const std::string& label) {
    for (Series& known : all) {
        if (known.label == label) return known;
    }
    all.push_back({label});
    return all.back();
}

}  // namespace

plot::Picture draw_fit(const FitProblem& problem, const FitResult& result,
                       const plot::Caption& caption) {
    std::vector<Series> spectra, views;
    for (const FitResidual& residual : result.residuals) {
        const MeasuredValue& value = residual.measured;
        if (!(value.wavelength_nm > 0.0)) continue;  // a colour
        const std::string name = problem.data[residual.data].name;
        const double difference = residual.model - value.value;
        if (!has_view(value)) {
            const bool passes = value.quantity == MeasuredQuantity::transmittance;
            Series& series = series_of(spectra, passes ? name + ", transmitted" : name);
            series.shown.push_back({value.wavelength_nm, value.value, residual.model});
            series.residual_x.push_back(value.wavelength_nm);
            series.residual.push_back(difference);
            continue;
        }
        Series& series = series_of(views, fmt::format("light at {:.3g}°", degrees(value.mu_in)));
        const double angle = signed_angle(value);
        if (is_in_plane(value)) series.shown.push_back({angle, value.value, residual.model});
        series.residual_x.push_back(angle);
        series.residual.push_back(difference);
    }
    std::vector<plot::Panel> panels;
    const auto add = [&](std::vector<Series>& all, const plot::AxisOptions& x, const char* y,
                         const char* residuals) {
        if (all.empty()) return;
        panels.push_back({.x = x, .y = {.label = y}, .curves = curves_of(all)});
        panels.push_back(
            {.x = x, .y = {.label = residuals}, .curves = residuals_of(all), .height = 110.0});
    };
    if (spectra.empty()) {
        add(views,
            {.label = "angle of view [°], light from the left", .lowest = -90.0, .highest = 90.0},
            "BRDF in the plane of incidence [1/sr]", "model - measured, all");
    }
    add(spectra, {.label = "wavelength [nm]"}, "share of the light", "model - measured");
    if (panels.empty())
        throw UsageError("a chart needs spectra or directions; colours have neither");
    return plot::draw_chart(panels, caption);
}

}  // namespace miebrdf::program
