// miebrdf fit: from measurements to the numbers of a scene.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/fit.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <miebrdf/error.h>
#include "materials/database/user_file.h"
#include "pipeline/io/atomic_file.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/fit_chart.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {
namespace {

struct FitArguments {
    std::string file, scene_file, residuals_file, spectra_file, chart_file;
    int starts = 0;
    /// In place of a file: one data set, by options of the names of its keys.
    SceneArguments scene;
    std::vector<std::string> unknowns;
    std::map<std::string, std::string> measured_texts;
    std::map<std::string, std::optional<double>> measured_numbers;
    bool free_scale = false;
};

/// The fit file that the options stand for.
std::string fit_text(const FitArguments& arguments) {
    std::string text = "[scene]\n";
    for (const auto& [word, values] : arguments.scene.typed())
        text += toml_of(*find_scene_word(word), values) + "\n";
    text += "[unknowns]\n";
    for (const std::string& unknown : arguments.unknowns) {
        const std::size_t equals = unknown.find('=');
        if (equals == std::string::npos)
            throw UsageError(fmt::format(
                "--unknown '{}'; write NAME=START in LOW:HIGH, \"radius=100 in 20:1000 log\"",
                unknown));
        text += fmt::format("{} = {}\n", toml_quoted(unknown.substr(0, equals)),
                            toml_quoted(unknown.substr(equals + 1)));
    }
    text += "[[measured]]\n";
    for (const auto& [key, value] : arguments.measured_texts) {
        if (!value.empty()) text += fmt::format("{} = {}\n", key, toml_quoted(value));
    }
    for (const auto& [key, value] : arguments.measured_numbers) {
        if (value) text += fmt::format("{} = {}\n", key, *value);
    }
    return arguments.free_scale ? text + "scale = \"free\"\n" : text;
}

Cell cell(double value) { return std::isfinite(value) ? Cell(value) : Cell(); }

std::string label(const FittedValue& value) {
    return value.wavelength_nm ? fmt::format("{} at {} nm", value.unknown, *value.wavelength_nm)
                               : value.unknown;
}

/// Pairs that move together; weak ones say little, and there are many.
void add_correlations(Table& table, const FitResult& result) {
    constexpr double kTold = 0.3;
    const std::size_t n = result.values.size();
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            const double r = result.correlation[i * n + j];
            const bool few = !result.values[i].wavelength_nm && !result.values[j].wavelength_nm;
            if (!few || !(std::abs(r) >= kTold)) continue;
            table.facts.emplace_back(
                "correlation",
                fmt::format("{}, {}: {:.3f}", label(result.values[i]), label(result.values[j]), r));
        }
    }
}

/// Root mean squares of each data set.
void add_misfits(Table& table, const FitProblem& problem, const FitResult& result) {
    for (std::size_t d = 0; d < problem.data.size(); ++d) {
        double squares = 0.0, relative = 0.0, mean = 0.0;
        int count = 0;
        for (const FitResidual& residual : result.residuals) {
            if (residual.data != d) continue;
            squares += std::pow(residual.model - residual.measured.value, 2);
            relative += std::pow(residual.model / residual.measured.value - 1.0, 2);
            mean += std::abs(residual.measured.value);
            ++count;
        }
        const double rms = std::sqrt(squares / count);
        std::string text = fmt::format("{}: {:.4g} (", problem.data[d].name, rms);
        text += mean > 0.0 ? fmt::format("{:.3g} % of the mean", 100.0 * rms / (mean / count))
                           : "all measured values are 0";
        if (std::isfinite(relative))
            text += fmt::format("; relative to each value {:.3g} %",
                                100.0 * std::sqrt(relative / count));
        table.facts.emplace_back("residual_rms", fmt::format("{}) of {} values", text, count));
    }
}

Table residual_table(const FitProblem& problem, const FitResult& result) {
    Table table;
    table.columns = {"data",  "wavelength_nm", "mu_in", "mu_out",  "azimuth_deg",
                     "value", "sigma",         "model", "residual"};
    const auto of = [](double number) { return number > 0.0 ? Cell(number) : Cell(); };
    for (const FitResidual& residual : result.residuals) {
        const MeasuredValue& value = residual.measured;
        table.rows.push_back({problem.data[residual.data].name, of(value.wavelength_nm),
                              of(value.mu_in), of(value.mu_out), cell(value.azimuth_deg),
                              value.value, of(value.sigma), cell(residual.model),
                              cell(residual.model - value.value)});
    }
    return table;
}

/// The unknowns that differ between wavelengths, one column for each: what `paste:FILE` reads where
/// two of them are called mu_s_reduced and mu_a.
Table spectra_table(const FitResult& result) {
    Table table;
    table.columns = {"wavelength_nm"};
    std::map<double, std::vector<Cell>> rows;
    for (const FittedValue& value : result.values) {
        if (!value.wavelength_nm) continue;
        if (table.columns.back() != value.unknown) table.columns.push_back(value.unknown);
        rows[*value.wavelength_nm].emplace_back(cell(value.value));
    }
    for (auto& [nm, values] : rows) {
        values.insert(values.begin(), nm);
        table.rows.push_back(std::move(values));
    }
    return table;
}

Table fit_table(const FitProblem& problem, const FitResult& result, bool with_residuals) {
    Table table;
    auto& facts = table.facts;
    facts.emplace_back("units", "value, standard_error: as the number stands in the scene's words");
    facts.emplace_back(result.sigma_known ? "chi_squared" : "sum_of_squares",
                       rounded(result.chi_squared, 6));
    facts.emplace_back("degrees_of_freedom", double(result.degrees_of_freedom));
    facts.emplace_back("standard_errors", result.sigma_known
                                              ? "from the sigmas of the data"
                                              : "from the residuals (the data have no sigmas)");
    add_misfits(table, problem, result);
    add_correlations(table, result);
    for (const std::string& line : result.undetermined) facts.emplace_back("undetermined", line);
    for (const std::string& line : result.notes) facts.emplace_back("note", line);
    for (const FitMinimum& minimum : result.minima) {
        if (result.minima.size() < 2) break;
        std::string text =
            fmt::format("{:.6g} from {} starts:", minimum.chi_squared, minimum.starts);
        for (std::size_t i = 0; i < minimum.values.size() && i < 8; ++i)
            text += fmt::format(" {} {:.5g}", label(result.values[i]), minimum.values[i]);
        facts.emplace_back("minimum", text);
    }
    facts.emplace_back("iterations", double(result.iterations));
    facts.emplace_back("solved_scenes", double(result.solved_scenes));
    if (result.interpolation_shift) {
        facts.emplace_back(
            "interpolated_sizes",
            fmt::format("averages over sizes were interpolated between sizes; direct averages "
                        "would move no number by more than {:.2g} of its standard error",
                        *result.interpolation_shift));
    }
    if (!result.converged) facts.emplace_back("not converged", result.reason);
    table.columns = {"unknown", "wavelength_nm", "value", "standard_error",
                     "start",   "low",           "high",  "note"};
    for (const FittedValue& value : result.values)
        table.rows.push_back({value.unknown, cell_of(value.wavelength_nm), cell(value.value),
                              cell(value.standard_error), value.start, value.low, value.high,
                              value.note});
    if (with_residuals) {
        Table residuals = residual_table(problem, result);
        table.report_columns = std::move(residuals.columns);
        table.report = std::move(residuals.rows);
    }
    return table;
}

/// A database that no word names is that of MIEBRDF_DATABASE, as for other
/// commands.
void complete(FitProblem& problem) {
    const std::string database = materials::from_environment("MIEBRDF_DATABASE");
    const bool is_named =
        std::any_of(problem.scene.begin(), problem.scene.end(),
                    [](const SceneText& text) { return text.word == "database"; });
    if (!database.empty() && !is_named) problem.scene.push_back({"database", {database}});
}

void write_file(const std::string& path, const std::function<void(std::ostream&)>& write) {
    AtomicFile file(path);
    write(file.stream());
    file.commit();
}

/// The unit in which a scene takes an unknown, with a blank: that behind "{soot}ppm".
std::string unit_of(const FitProblem& problem, const std::string& unknown) {
    const std::string place = "{" + unknown + "}";
    for (const SceneText& text : problem.scene) {
        for (const std::string& value : text.values) {
            const std::size_t at = value.find(place), end = at + place.size();
            if (at == std::string::npos) continue;
            const std::string unit = value.substr(end, value.find_first_of(",@[ ", end) - end);
            if (unit == "um" || (unit.empty() && value.substr(0, at).ends_with("radius=")))
                return " \u00b5m";
            return unit.empty() ? "" : " " + unit;
        }
    }
    return "";
}

/// "radius = 90.6 um, soot = 12 ppm": the numbers that wavelengths share.
std::string title_of(const FitProblem& problem, const FitResult& result) {
    std::string title;
    for (const FittedValue& value : result.values) {
        if (value.wavelength_nm) continue;
        // Two digits of the error: albedos near 1 are not 1.
        const double share = value.standard_error / std::abs(value.value);
        const int digits = share > 0.0 ? int(std::ceil(-std::log10(share))) + 1 : 4;
        title +=
            fmt::format("{}{} = {:.{}g}{}", title.empty() ? "" : ", ", value.unknown, value.value,
                        std::clamp(digits, 3, 15), unit_of(problem, value.unknown));
    }
    return title.empty() ? "measured (circles) and fitted (lines)" : title;
}

int run_fit(const FitProblem& problem, const FitArguments& arguments, const Shell& shell) {
    if (!arguments.spectra_file.empty() &&
        std::none_of(problem.unknowns.begin(), problem.unknowns.end(),
                     [](const Unknown& unknown) { return unknown.per_wavelength; }))
        throw UsageError(
            "--spectra needs an unknown that differs between wavelengths: \"per wavelength, START "
            "in LOW:HIGH\"");
    const FitResult result = fit(problem, shell.control());
    if (!arguments.scene_file.empty())
        write_file(arguments.scene_file, [&](std::ostream& out) { out << result.scene_file; });
    if (!arguments.residuals_file.empty())
        write_file(arguments.residuals_file,
                   [&](std::ostream& out) { write_csv(residual_table(problem, result), out); });
    if (!arguments.spectra_file.empty())
        write_file(arguments.spectra_file,
                   [&](std::ostream& out) { write_csv(spectra_table(result), out); });
    if (!arguments.chart_file.empty())
        plot::save_picture(
            draw_fit(problem, result, {title_of(problem, result), shell.command_line()}),
            arguments.chart_file);
    shell.write(fit_table(problem, result, shell.common().json));
    for (const std::string& line : result.undetermined) shell.note(line);
    for (const std::string& line : result.notes) shell.note(line);
    if (result.converged) return kGood;
    shell.set_advice(result.reason);
    return kNotConverged;
}

}  // namespace

void add_fit(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<FitArguments>();
    option(command, "fit", arguments->file, "FIT.toml",
           "fit file (TOML): a [scene] with {name} in place of unknown numbers, [unknowns], "
           "[[measured]]");
    option(command, "--scene", arguments->scene_file, "FILE", "also write the fitted scene (TOML)");
    option(command, "--residuals", arguments->residuals_file, "FILE",
           "also write every measured value beside the model's, as CSV");
    option(command, "--spectra", arguments->spectra_file, "FILE",
           "also write the unknowns that differ between wavelengths, as CSV with a column for "
           "each; with unknowns called mu_s_reduced and mu_a, paste:FILE reads it");
    option(command, "--plot", arguments->chart_file, "FILE",
           "also draw measured points, the fitted curve and residuals (.svg, .png)");
    option(command, "--starts", arguments->starts, "N",
           "search from N points within the bounds; 0: as many as the file says, else 6, or 1 if "
           "an unknown changes the spheres")
        ->check(CLI::Range(0, 1000));
    // Wavelengths are those of the data.
    arguments->scene.add_to(command, shell, scene_word_names("wavelengths"), "");
    const std::string group = "In place of a fit file, with the words of its scene";
    option(command, "--unknown", arguments->unknowns, "TEXT", "NAME=START in LOW:HIGH [log|log1m]")
        ->allow_extra_args(false)
        ->group(group);
    const auto add_text = [&](const char* name, const char* key, const char* help) {
        option(command, name, arguments->measured_texts[key], "", help)->group(group);
    };
    add_text("--measured", "file", "file of measured values");
    add_text("--column", "column", "one column or sample of this file");
    add_text("--quantity", "quantity",
             "what the values are: plane_albedo, hemispherical, brdf, d8-sci, ...");
    add_text("--wavelengths", "wavelengths", "FIRST:LAST: fit only values at these wavelengths");
    for (const char* const key :
         {"mu_in", "theta_in", "mu_out", "theta_out", "azimuth", "sigma", "relative_sigma"}) {
        std::string name = "--" + std::string(key);
        std::replace(name.begin(), name.end(), '_', '-');
        option(command, name, arguments->measured_numbers[key], "",
               "of values that lack it in the file, as in fit files")
            ->group(group);
    }
    command
        .add_flag("--free-scale", arguments->free_scale,
                  "the measured values are known up to a factor, which is fitted, too")
        ->group(group);
    shell.add_common_options(command);
    command.footer(
        "Example:\n  miebrdf fit docs/examples/fits/snow.toml --scene fitted.toml\n"
        "  miebrdf fit --base \"H2O_ice,radius={r}\" --unknown \"r=100 in 20:2000 log\" "
        "--measured snow.csv --quantity plane_albedo --mu-in 0.67");
    shell.on_prepare(command, [arguments, &shell]() -> Job {
        if (!has_fit())
            throw UsageError(
                "this build cannot fit; install libceres-dev, then "
                "configure and build again");
        if (!arguments->chart_file.empty()) plot::check_picture_path(arguments->chart_file);
        const bool has_options =
            !arguments->unknowns.empty() || !arguments->measured_texts["file"].empty();
        if (has_options == !arguments->file.empty())
            throw UsageError(
                "give a fit file, or its content by options: --unknown, --measured and the words "
                "of the scene");
        FitProblem problem = has_options ? read_fit_text(fit_text(*arguments), "", "options")
                                         : read_fit_file(arguments->file);
        if (arguments->starts > 0) problem.starts = arguments->starts;
        complete(problem);
        if (!arguments->chart_file.empty()) require_drawable(problem);
        return [problem, arguments, &shell] { return run_fit(problem, *arguments, shell); };
    });
}

}  // namespace miebrdf::program
