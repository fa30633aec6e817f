// Fits and recipes: <miebrdf/fit.h>.
#include <miebrdf/fit.h>

#include <cmath>
#include <string>
#include <vector>

#include <pybind11/stl.h>
#include "tools/python/bindings.h"
#include "tools/python/long_call.h"

namespace miebrdf::python {
namespace {

/// Numbers of a list of results, by a function of each.
template <typename List, typename Number>
py::array_t<double> column(const List& list, const Number& number_of) {
    std::vector<double> numbers;
    for (const auto& one : list) numbers.push_back(number_of(one));
    return array_of(std::move(numbers));
}

py::dict values_of(const FitResult& result) {
    const auto& values = result.values;
    py::list unknowns, notes, bounds;
    for (const FittedValue& value : values) {
        unknowns.append(value.unknown);
        notes.append(value.note);
        bounds.append(value.at_bound);
    }
    py::dict columns;
    columns["unknown"] = unknowns;
    columns["wavelength_nm"] =
        column(values, [](const auto& v) { return v.wavelength_nm.value_or(std::nan("")); });
    columns["value"] = column(values, [](const auto& v) { return v.value; });
    columns["standard_error"] = column(values, [](const auto& v) { return v.standard_error; });
    columns["interval_low"] = column(values, [](const auto& v) { return v.interval_low; });
    columns["interval_high"] = column(values, [](const auto& v) { return v.interval_high; });
    columns["start"] = column(values, [](const auto& v) { return v.start; });
    columns["low"] = column(values, [](const auto& v) { return v.low; });
    columns["high"] = column(values, [](const auto& v) { return v.high; });
    columns["at_bound"] = bounds;
    columns["note"] = notes;
    return columns;
}

py::dict residuals_of(const FitProblem& problem, const FitResult& result) {
    const auto& residuals = result.residuals;
    py::list names, quantities;
    for (const FitResidual& residual : residuals) {
        names.append(problem.data[residual.data].name);
        quantities.append(word_of(residual.measured.quantity));
    }
    py::dict columns;
    columns["data"] = names;
    columns["quantity"] = quantities;
    columns["wavelength_nm"] = column(residuals, [](auto& r) { return r.measured.wavelength_nm; });
    columns["mu_in"] = column(residuals, [](auto& r) { return r.measured.mu_in; });
    columns["mu_out"] = column(residuals, [](auto& r) { return r.measured.mu_out; });
    columns["azimuth_deg"] = column(residuals, [](auto& r) { return r.measured.azimuth_deg; });
    columns["value"] = column(residuals, [](auto& r) { return r.measured.value; });
    columns["sigma"] = column(residuals, [](auto& r) { return r.measured.sigma; });
    columns["model"] = column(residuals, [](auto& r) { return r.model; });
    return columns;
}

py::dict run_fit(const std::string& text, const std::string& folder, const std::string& name,
                 int starts, const CallOptions& options) {
    FitProblem problem = read_fit_text(text, folder, name);
    if (starts > 0) problem.starts = starts;
    LongCall call(options);
    const FitResult result = call.run_until_stopped([&] { return fit(problem, call.control()); });
    py::dict facts;
    facts["values"] = values_of(result);
    facts["residuals"] = residuals_of(problem, result);
    facts["chi_squared"] = result.chi_squared;
    facts["degrees_of_freedom"] = result.degrees_of_freedom;
    facts["sigma_known"] = result.sigma_known;
    const auto n = static_cast<py::ssize_t>(result.values.size());
    facts["correlation"] = array_of(result.correlation, {n, n});
    facts["undetermined"] = result.undetermined;
    facts["notes"] = result.notes;
    py::list minima;
    for (const FitMinimum& minimum : result.minima) {
        py::dict one;
        one["chi_squared"] = minimum.chi_squared;
        one["starts"] = minimum.starts;
        one["values"] = array_of(minimum.values);
        minima.append(one);
    }
    facts["minima"] = minima;
    facts["converged"] = result.converged;
    facts["interrupted"] = result.interrupted;
    facts["reason"] = result.reason;
    facts["iterations"] = result.iterations;
    facts["solved_scenes"] = result.solved_scenes;
    facts["interpolation_shift"] = result.interpolation_shift;
    facts["scene_file"] = result.scene_file;
    return facts;
}

std::vector<double> numbers_of(const Lab& lab) { return {lab.l, lab.a, lab.b}; }

py::dict run_match(const std::string& text, const std::string& folder, const std::string& name,
                   const std::vector<std::string>& measured, const CallOptions& options) {
    MatchProblem problem = read_match_text(text, folder, name);
    for (const std::string& file : measured) add_measured(problem, file);
    LongCall call(options);
    const MatchResult result = call.run([&] { return match(problem, call.control()); });
    py::list recipes;
    for (const Recipe& recipe : result.recipes) {
        py::list parts, colours;
        for (const RecipePart& part : recipe.parts)
            parts.append(
                py::dict(py::arg("name") = part.name, py::arg("value") = part.value,
                         py::arg("grams") = part.grams, py::arg("weight_share") = part.weight_share,
                         py::arg("volume_share") = part.volume_share,
                         py::arg("delta_e_per_tenth_gram") = part.delta_e_per_tenth_gram,
                         py::arg("cost") = part.cost, py::arg("at_bound") = part.at_bound));
        for (const RecipeColour& colour : recipe.colours)
            colours.append(py::dict(py::arg("target") = colour.target,
                                    py::arg("light") = colour.light,
                                    py::arg("lab") = numbers_of(colour.lab),
                                    py::arg("wanted") = numbers_of(colour.wanted),
                                    py::arg("delta_e_2000") = colour.delta_e_2000));
        recipes.append(py::dict(
            py::arg("parts") = parts, py::arg("colours") = colours,
            py::arg("delta_e_2000") = recipe.delta_e_2000,
            py::arg("delta_e_second") = recipe.delta_e_second,
            py::arg("contrast_ratio") = recipe.contrast_ratio, py::arg("cost") = recipe.cost,
            py::arg("left_out") = recipe.left_out, py::arg("file") = recipe.file));
    }
    py::dict facts;
    facts["recipes"] = recipes;
    facts["reached"] = result.reached;
    facts["notes"] = result.notes;
    facts["solved_scenes"] = result.solved_scenes;
    return facts;
}

}  // namespace

void bind_fits(py::module_& module) {
    module.def("has_fit", &has_fit);
    module.def("fit", &run_fit, py::arg("text"), py::arg("folder"), py::arg("name"),
               py::arg("starts"), py::arg("options"));
    module.def("match", &run_match, py::arg("text"), py::arg("folder"), py::arg("name"),
               py::arg("measured"), py::arg("options"));
}

}  // namespace miebrdf::python
