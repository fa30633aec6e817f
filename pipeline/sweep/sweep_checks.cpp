#include "pipeline/sweep/sweep_checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <utility>

#include "pipeline/sweep/axis_values.h"
#include "pipeline/sweep/eradiate.h"
#include "pipeline/sweep/satellite.h"

namespace miebrdf::sweep {
namespace {

/// More scenes than any cluster computes.
constexpr double kMostScenes = 1e9;

constexpr std::array kOutputs = {Output::brdf,
                                 Output::plane_albedo,
                                 Output::spherical_albedo,
                                 Output::plane_transmittance,
                                 Output::spherical_transmittance,
                                 Output::colour,
                                 Output::contrast_ratio,
                                 Output::mueller,
                                 Output::hdrf,
                                 Output::emissivity};

/// Names of variables that a table has besides its axes.
const std::set<std::string> kReserved = {"brdf",
                                         "plane_albedo",
                                         "spherical_albedo",
                                         "plane_transmittance",
                                         "spherical_transmittance",
                                         "colour",
                                         "hdrf",
                                         "emissivity",
                                         "contrast_ratio",
                                         "error_estimate",
                                         "converged",
                                         "remark",
                                         "remark_scene",
                                         "sample",
                                         "X",
                                         "Y",
                                         "Z",
                                         "L_star",
                                         "a_star",
                                         "b_star"};

/// Elements of Mueller matrices: m11 to m44.
bool is_mueller_name(const std::string& name) {
    const auto is_place = [](char digit) { return digit >= '1' && digit <= '4'; };
    return name.size() == 3 && name[0] == 'm' && is_place(name[1]) && is_place(name[2]);
}

void require(const Axis& axis, const std::string& allowed, bool (*is_allowed)(double)) {
    if (axis.is_text())
        throw UsageError(fmt::format("axis {}: texts; allowed: numbers", axis.name));
    for (const double value : axis.numbers) {
        if (!is_allowed(value)) throw UsageError(axis.name, value, allowed);
    }
}

void require_range_of_name(const Axis& axis, bool for_eradiate) {
    if (axis.name == "wavelength_nm") {
        require(axis, "> 0", [](double x) { return x > 0.0; });
    } else if (axis.name == "azimuth_deg") {
        require(axis, "[-360, 360]", [](double x) { return x >= -360.0 && x <= 360.0; });
    } else if (axis.name.rfind("mu_", 0) == 0 && for_eradiate) {
        require(axis, "[0, 1]", [](double x) { return x >= 0.0 && x <= 1.0; });
    } else if (axis.name.rfind("mu_", 0) == 0) {
        require(axis, "(0, 1]", [](double x) { return x > 0.0 && x <= 1.0; });
    } else {
        require(axis, "[0, 90)", [](double x) { return x >= 0.0 && x < 90.0; });
    }
}

/// The place of an axis of this name that one solution is asked at; null: it is a dimension.
Axis* asked_axis(Sweep& sweep, const std::string& name) {
    if (name == "wavelength_nm") return &sweep.wavelength;
    if (name == "mu_in" || name == "theta_in_deg") return &sweep.incidence;
    if (name == "mu_out" || name == "theta_out_deg") return &sweep.reflection;
    if (name == "azimuth_deg") return &sweep.azimuth;
    return nullptr;
}

void require_name(const std::string& name) {
    const bool is_word = !name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) &&
                         std::all_of(name.begin(), name.end(),
                                     [](unsigned char c) { return std::isalnum(c) || c == '_'; });
    if (!is_word)
        throw UsageError(fmt::format("axis '{}': letters, digits and _ make a name", name));
    if (kReserved.contains(name) || is_mueller_name(name))
        throw UsageError(fmt::format("axis '{}': tables have a variable of this name", name));
}

void require_names(const Sweep& sweep) {
    std::set<std::string> seen;
    for (const std::string& name : axis_names(sweep)) {
        if (!seen.insert(name).second)
            throw UsageError(fmt::format("axis '{}' is there twice", name));
    }
    for (const Dimension& dimension : sweep.dimensions) {
        for (const Axis& axis : dimension.axes) {
            require_name(axis.name);
            Sweep unused;
            if (asked_axis(unused, axis.name) != nullptr) {
                throw UsageError(
                    fmt::format("axis '{}' holds for every scene and cannot be a column of "
                                "samples; give it a line of its own in [axes]",
                                axis.name));
            }
        }
        if (!dimension.is_coordinate() && dimension.name != "sample") require_name(dimension.name);
        if (!dimension.is_coordinate() && seen.contains(dimension.name))
            throw UsageError(
                fmt::format("'{}' is the name of an axis and of the samples that have "
                            "it; rename the samples",
                            dimension.name));
    }
}

void require_use(const Sweep& sweep) {
    std::set<std::string> used;
    for (const TemplateWord& word : sweep.words) {
        for (const WordValue& value : word.values) {
            if (const auto* text = std::get_if<std::string>(&value)) {
                for (const std::string& gap : gaps_in(*text)) used.insert(gap);
            }
        }
    }
    for (const std::string& name : scene_axis_names(sweep)) {
        if (!used.contains(name))
            throw UsageError(
                fmt::format("axis '{}' is not used: no word of [scene] has {{{}}}", name, name));
    }
}

void require_axis(const Axis& axis, const char* names, Output output) {
    if (axis.size() == 0)
        throw UsageError(fmt::format("the output {} needs an axis {}", name_of(output), names));
}

void require_outputs(const Sweep& sweep) {
    if (sweep.wavelength.size() == 0)
        throw UsageError(
            "a sweep needs wavelengths; write wavelength_nm = \"400:700:10\" in [axes]");
    for (const Output output : sweep.outputs) {
        const bool has_azimuth =
            output == Output::brdf || output == Output::mueller || output == Output::hdrf;
        if (has_azimuth || output == Output::plane_albedo ||
            output == Output::plane_transmittance || output == Output::emissivity)
            require_axis(sweep.incidence, "mu_in or theta_in_deg", output);
        if (!has_azimuth) continue;
        require_axis(sweep.reflection, "mu_out or theta_out_deg", output);
        require_axis(sweep.azimuth, "azimuth_deg", output);
    }
    const bool has_others = sweep.wants_spectra() || sweep.wants(Output::mueller);
    if (!sweep.derivatives.empty() && (has_others || sweep.for_eradiate()))
        throw UsageError(
            "derivatives exist for brdf, hdrf, albedos, emissivities and transmittances; leave "
            "out colour, contrast_ratio, mueller and layout = \"eradiate\"");
    if (sweep.wants_spectra() && !covers_the_visible(sweep.wavelength.numbers))
        throw UsageError(
            "the outputs colour and contrast_ratio need eight or more ascending wavelengths from "
            "430 nm or "
            "less to 650 nm or more");
    const bool uses_incidence = sweep.wants_matrices_or_brdf() ||
                                sweep.wants(Output::plane_albedo) ||
                                sweep.wants(Output::plane_transmittance) || sweep.wants_spectra() ||
                                sweep.wants(Output::emissivity);
    const auto refuse_unused = [](const Axis& axis, bool is_used) {
        if (axis.size() > 0 && !is_used)
            throw UsageError(fmt::format("axis '{}' is not used by these outputs", axis.name));
    };
    refuse_unused(sweep.incidence, uses_incidence);
    refuse_unused(sweep.reflection, sweep.wants_matrices_or_brdf());
    refuse_unused(sweep.azimuth, sweep.wants_matrices_or_brdf());
}

}  // namespace

void place_axis(Sweep& sweep, Axis axis) {
    Axis* place = asked_axis(sweep, axis.name);
    if (place == nullptr) {
        const std::string name = axis.name;
        sweep.dimensions.push_back({name, {std::move(axis)}});
        return;
    }
    require_range_of_name(axis, sweep.for_eradiate());
    if (place->size() > 0)
        throw UsageError(fmt::format("axes '{}' and '{}' are the same direction; give one of them",
                                     place->name, axis.name));
    *place = std::move(axis);
}

void zip_dimensions(Sweep& sweep) {
    Dimension sample{"sample", {}};
    std::vector<std::string> lengths;
    for (const Dimension& dimension : sweep.dimensions) {
        lengths.push_back(fmt::format("{} has {}", dimension.name, dimension.size()));
        sample.axes.insert(sample.axes.end(), dimension.axes.begin(), dimension.axes.end());
    }
    if (sample.axes.empty())
        throw UsageError("combine = \"zip\": there is no axis of scenes to combine");
    for (const Axis& axis : sample.axes) {
        if (axis.size() != sample.size())
            throw UsageError(
                fmt::format("zipped axes need the same length; {}", fmt::join(lengths, ", ")));
    }
    sweep.dimensions = {std::move(sample)};
}

Axis* find_axis(Sweep& sweep, const std::string& name) {
    return const_cast<Axis*>(std::as_const(sweep).find_axis(name));
}

std::vector<std::string> scene_axis_names(const Sweep& sweep) {
    std::vector<std::string> names;
    for (const Dimension& dimension : sweep.dimensions) {
        for (const Axis& axis : dimension.axes) names.push_back(axis.name);
    }
    return names;
}

std::vector<std::string> axis_names(const Sweep& sweep) {
    std::vector<std::string> names = scene_axis_names(sweep);
    for (const Axis* axis :
         {&sweep.wavelength, &sweep.incidence, &sweep.reflection, &sweep.azimuth}) {
        if (axis->size() > 0) names.push_back(axis->name);
    }
    return names;
}

std::vector<std::string> output_names() {
    std::vector<std::string> names;
    names.reserve(std::size(kOutputs) + 1);
    for (const Output output : kOutputs) names.emplace_back(name_of(output));
    names.emplace_back("transmittance");
    return names;
}

bool add_output(Sweep& sweep, const std::string& name) {
    if (name == "transmittance") {
        if (sweep.incidence.size() > 0) add_output(sweep, name_of(Output::plane_transmittance));
        return add_output(sweep, name_of(Output::spherical_transmittance));
    }
    for (const Output output : kOutputs) {
        if (name != name_of(output)) continue;
        if (!sweep.wants(output)) sweep.outputs.push_back(output);
        std::sort(sweep.outputs.begin(), sweep.outputs.end());
        return true;
    }
    return false;
}

void check_sweep(const Sweep& sweep) {
    double scenes = 1.0;
    for (const Dimension& dimension : sweep.dimensions) {
        scenes *= double(dimension.size());
        if (dimension.is_coordinate()) require_monotonic(dimension.axes.front());
    }
    if (!(scenes <= kMostScenes))
        throw UsageError(
            fmt::format("{:.0f} scenes; at most {:.0f} are allowed", scenes, kMostScenes));
    require_names(sweep);
    require_use(sweep);
    require_outputs(sweep);
    for (const Axis* axis :
         {&sweep.wavelength, &sweep.incidence, &sweep.reflection, &sweep.azimuth})
        require_monotonic(*axis);
    if (sweep.for_eradiate()) require_eradiate_axes(sweep);
    require_satellite_axes(sweep);
}

}  // namespace miebrdf::sweep
