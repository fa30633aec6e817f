#include "tools/miebrdf/fit_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

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
    std::vector<double> residual_x = {}, residual = {}, measured = {};  ///< of all
};

/// Three times the usual distance of neighbours: beyond it values were left out, and no line is
/// drawn.
double widest_step(const std::vector<Series::At>& shown) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < shown.size(); ++i) steps.push_back(shown[i].x - shown[i - 1].x);
    if (steps.empty()) return 0.0;
    const auto median = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), median, steps.end());
    return 3.0 * *median;
}

std::vector<plot::Curve> curves_of(std::vector<Series>& all) {
    std::vector<plot::Curve> curves;
    for (std::size_t i = 0; i < all.size(); ++i) {
        std::sort(all[i].shown.begin(), all[i].shown.end(),
                  [](const auto& a, const auto& b) { return a.x < b.x; });
        const double gap = widest_step(all[i].shown);
        plot::Curve measured, model;
        measured.label = all[i].label;
        measured.mark = plot::Mark::points;
        measured.colour = model.colour = int(i);
        for (const Series::At& at : all[i].shown) {
            if (!model.x.empty() && at.x - model.x.back() > gap) {
                model.x.push_back(at.x);
                model.y.push_back(std::numeric_limits<double>::quiet_NaN());
            }
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

/// Lines and colours that can be told apart.
constexpr std::size_t kMostSeries = 12;

/// "light at 15°", with the wavelength where there are several.
std::string light_of(const MeasuredValue& value, bool several_wavelengths) {
    const double tenths = std::round(10.0 * degrees(value.mu_in)) / 10.0;
    return several_wavelengths ? fmt::format("light at {}°, {} nm", tenths, value.wavelength_nm)
                               : fmt::format("light at {}°", tenths);
}

/// In place of more lines than can be told apart: the model's values over the measured ones.
std::vector<plot::Curve> model_over_measured(const std::vector<Series>& all) {
    plot::Curve values, equal;
    values.mark = plot::Mark::points;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Series& series : all) {
        for (std::size_t i = 0; i < series.residual.size(); ++i) {
            values.x.push_back(series.measured[i]);
            values.y.push_back(series.measured[i] + series.residual[i]);
            low = std::min(low, series.measured[i]);
            high = std::max(high, series.measured[i]);
        }
    }
    equal.x = equal.y = {low, high};
    equal.colour = 1;
    return {values, equal};
}

Series& series_of(std::vector<Series>& all, const std::string& label) {
    for (Series& known : all) {
        if (known.label == label) return known;
    }
    all.push_back({label});
    return all.back();
}

}  // namespace

void require_drawable(const FitProblem& problem) {
    const bool has_any =
        std::any_of(problem.data.begin(), problem.data.end(), [](const FitData& d) {
            return std::any_of(d.values.begin(), d.values.end(), [](const MeasuredValue& value) {
                return value.quantity != MeasuredQuantity::lab_l &&
                       value.quantity != MeasuredQuantity::lab_a &&
                       value.quantity != MeasuredQuantity::lab_b;
            });
        });
    if (!has_any)
        throw UsageError("a chart (--plot) needs spectra or directions; colours have neither");
}

plot::Picture draw_fit(const FitProblem& problem, const FitResult& result,
                       const plot::Caption& caption) {
    std::vector<Series> spectra, views;
    std::set<double> wavelengths;
    bool any_brdf = false, all_pass = true, none_pass = true;
    for (const FitResidual& residual : result.residuals) {
        if (!has_view(residual.measured)) continue;
        wavelengths.insert(residual.measured.wavelength_nm);
        any_brdf = any_brdf || residual.measured.quantity == MeasuredQuantity::brdf;
    }
    const std::string quantity = any_brdf ? "BRDF" : "reflectance factor";
    const std::string unit = any_brdf ? " [1/sr]" : "";
    for (const FitResidual& residual : result.residuals) {
        const MeasuredValue& value = residual.measured;
        if (!(value.wavelength_nm > 0.0)) continue;  // a colour
        const std::string name = problem.data[residual.data].name;
        const double difference = residual.model - value.value;
        if (!has_view(value)) {
            const bool passes = value.quantity == MeasuredQuantity::transmittance;
            (passes ? none_pass : all_pass) = false;
            Series& series = series_of(spectra, passes ? name + ", transmitted" : name);
            series.shown.push_back({value.wavelength_nm, value.value, residual.model});
            series.residual_x.push_back(value.wavelength_nm);
            series.residual.push_back(difference);
            continue;
        }
        Series& series = series_of(views, light_of(value, wavelengths.size() > 1));
        const double angle = signed_angle(value);
        if (is_in_plane(value)) series.shown.push_back({angle, value.value, residual.model});
        series.residual_x.push_back(angle);
        series.residual.push_back(difference);
        series.measured.push_back(value.value);
    }
    std::vector<plot::Panel> panels;
    const auto add = [&](std::vector<Series>& all, const plot::AxisOptions& x, const std::string& y,
                         const std::string& residuals) {
        if (all.empty()) return;
        panels.push_back({.x = x, .y = {.label = y}, .curves = curves_of(all)});
        panels.push_back(
            {.x = x, .y = {.label = residuals}, .curves = residuals_of(all), .height = 110.0});
    };
    const plot::AxisOptions angles{
        .label = "angle of view [°], light from the left", .lowest = -90.0, .highest = 90.0};
    if (spectra.empty() && views.size() <= kMostSeries) {
        add(views, angles, quantity + " in the plane of incidence" + unit, "model - measured, all");
    } else if (spectra.empty()) {
        panels.push_back({.x = {.label = "measured " + quantity + unit},
                          .y = {.label = "model" + unit},
                          .curves = model_over_measured(views)});
        for (Series& series : views) series.label.clear();
        std::vector<plot::Curve> residuals = residuals_of(views);
        for (plot::Curve& curve : residuals) curve.colour = 0;
        panels.push_back({.x = angles,
                          .y = {.label = "model - measured"},
                          .curves = std::move(residuals),
                          .height = 110.0});
    }
    add(spectra, {.label = "vacuum wavelength [nm]"},
        none_pass  ? "reflectance"
        : all_pass ? "transmittance"
                   : "share of the light",
        "model - measured");
    return plot::draw_chart(panels, caption);
}

}  // namespace miebrdf::program
