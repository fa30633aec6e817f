#include "pipeline/fit/match_problem.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/fit/measured_values.h"
#include "pipeline/fit/problem.h"
#include "pipeline/fit/unknowns.h"
#include "pipeline/scene/scene_words.h"

namespace miebrdf {
namespace fitting {
namespace {

bool is_lab(const MeasuredValue& value) { return value.quantity >= MeasuredQuantity::lab_l; }

std::string words_text(const std::vector<SceneText>& scene, const char* separator) {
    std::vector<std::string> lines;
    for (const SceneText& word : scene) {
        const std::vector<WordValue> values(word.values.begin(), word.values.end());
        lines.push_back(toml_of(*find_scene_word(word.word), values));
    }
    return fmt::format("{}", fmt::join(lines, separator));
}

/// The spectrum of a target: its geometry at 400 to 700 nm; values are dummies.
FitData spectrum_of(const MatchTarget& target) {
    MeasuredWords words{.options = target.options};
    words.options.column.clear();
    if (words.options.quantity.empty()) words.options.quantity = "plane_albedo";
    const MeasuredKind kind = measured_kind(words.options.quantity);
    if (kind.geometry == MeasuredGeometry::directional && !words.options.mu_in)
        words.options.mu_in = std::cos(8.0 * std::numbers::pi / 180.0);
    for (int nm = 400; nm <= 700; nm += 10) words.wavelength_nm.push_back(nm);
    words.values.assign(words.wavelength_nm.size(), 0.5);
    FitData data{.name = target.name, .scene = target.scene};
    read_values(words, data);
    return data;
}

}  // namespace

Lab colour_of(const FitData& data, const Viewing& viewing) {
    Lab lab;
    std::vector<double> nm, spectrum;
    for (const MeasuredValue& value : data.values) {
        if (value.quantity == MeasuredQuantity::lab_l) lab.l = value.value;
        if (value.quantity == MeasuredQuantity::lab_a) lab.a = value.value;
        if (value.quantity == MeasuredQuantity::lab_b) lab.b = value.value;
        if (is_lab(value)) continue;
        nm.push_back(value.wavelength_nm);
        spectrum.push_back(value.quantity == MeasuredQuantity::brdf ? std::numbers::pi * value.value
                                                                    : value.value);
    }
    if (nm.empty()) return lab;
    if (!covers_the_visible(nm))
        throw UsageError(fmt::format(
            "{}: {} wavelengths from {} to {} nm; a colour needs eight or more from 430 to 650 nm, "
            "of one direction",
            data.name, nm.size(), nm.front(), nm.back()));
    return Colorimeter(nm, viewing)(spectrum).lab;
}

void set_geometry(MeasuredOptions& options, const MeasuredValue& value) {
    if (!is_lab(value)) {
        const auto fill = [](std::optional<double>& said, double has) {
            if (!std::isnan(has)) said = has;
        };
        fill(options.mu_in, value.mu_in);
        fill(options.mu_out, value.mu_out);
        fill(options.azimuth_deg, value.azimuth_deg);
        const bool is_plain = value.geometry == MeasuredGeometry::unknown ||
                              value.geometry == MeasuredGeometry::directional;
        if (value.quantity == MeasuredQuantity::transmittance) {
            options.quantity = "plane_transmittance";
        } else if (value.geometry == MeasuredGeometry::directions) {
            options.quantity = "reflectance_factor";
        } else if (options.quantity.empty() || options.quantity == "reflectance") {
            options.quantity = is_plain ? "plane_albedo" : word_of(value.geometry);
        }
    }
    if (options.quantity.empty() || options.quantity == "lab") options.quantity = "plane_albedo";
}

FitProblem spectra_of(const MatchProblem& problem, std::vector<std::size_t>& data_of_target) {
    FitProblem fit{.scene = problem.scene, .unknowns = problem.unknowns};
    std::vector<const MatchTarget*> of_data;
    const auto same = [](const MatchTarget& a, const MatchTarget& b) {
        const MeasuredOptions &p = a.options, &q = b.options;
        return a.scene == b.scene && p.quantity == q.quantity && p.mu_in == q.mu_in &&
               p.mu_out == q.mu_out && p.azimuth_deg == q.azimuth_deg;
    };
    data_of_target.clear();
    for (const MatchTarget& target : problem.targets) {
        std::size_t d = 0;
        while (d < of_data.size() && !same(*of_data[d], target)) ++d;
        if (d == of_data.size()) {
            of_data.push_back(&target);
            fit.data.push_back(spectrum_of(target));
        }
        data_of_target.push_back(d);
    }
    return fit;
}

void check_match(const MatchProblem& problem) {
    if (problem.targets.empty()) throw UsageError("nothing is wanted; add a [[target]]");
    if (!(problem.batch_grams > 0.0 && std::isfinite(problem.batch_grams)))
        throw UsageError("batch grams", problem.batch_grams, "> 0");
    if (problem.most_volume && !(*problem.most_volume > 0.0 && *problem.most_volume <= 1.0))
        throw UsageError("total_volume", *problem.most_volume, "(0, 1]: a share of the volume");
    if (problem.most_thickness_um && !(*problem.most_thickness_um > 0.0))
        throw UsageError("thickness_um", *problem.most_thickness_um, "> 0");
    for (const Unknown& unknown : problem.unknowns) {
        if (unknown.per_wavelength)
            throw UsageError(fmt::format(
                "unknown '{}': a recipe has one number for all wavelengths", unknown.name));
    }
    std::vector<std::size_t> unused;
    const FitProblem fit = checked(spectra_of(problem, unused));
    for (const FitData& data : fit.data) check_scene(fit, data);
}

std::string match_text(const MatchProblem& problem, const std::vector<double>& numbers,
                       const std::string& title) {
    std::string text =
        fmt::format("# {}\n[scene]\n{}\n\n[unknowns]\n", title, words_text(problem.scene, "\n"));
    for (std::size_t u = 0; u < problem.unknowns.size(); ++u) {
        const Unknown& unknown = problem.unknowns[u];
        const char* scale = unknown.scale == Unknown::Scale::logarithm          ? " log"
                            : unknown.scale == Unknown::Scale::log_of_one_minus ? " log1m"
                                                                                : "";
        text += fmt::format("{} = \"{} in {}:{}{}\"\n", unknown.name, numbers[u], unknown.low,
                            unknown.high, scale);
    }
    for (const MatchTarget& target : problem.targets) {
        for (const MatchColour& colour : target.colours) {
            const MeasuredOptions& o = target.options;
            text += fmt::format("\n[[target]]\nname = {}\nlab = [{}, {}, {}]\nlight = {}\n",
                                toml_quoted(target.name), colour.lab.l, colour.lab.a, colour.lab.b,
                                toml_quoted(colour.light));
            if (!o.quantity.empty())
                text += fmt::format("quantity = {}\n", toml_quoted(o.quantity));
            const auto add = [&](const char* key, const std::optional<double>& number) {
                if (number) text += fmt::format("{} = {}\n", key, *number);
            };
            if (measured_kind(o.quantity.empty() ? "plane_albedo" : o.quantity).geometry ==
                    MeasuredGeometry::directional ||
                o.mu_out)
                add("mu_in", o.mu_in);
            add("mu_out", o.mu_out);
            add("azimuth", o.azimuth_deg);
            if (!target.scene.empty())
                text += fmt::format("scene = {{ {} }}\n", words_text(target.scene, ", "));
        }
    }
    text += fmt::format("\n[batch]\ngrams = {}\n", problem.batch_grams);
    if (!problem.cost_per_kg.empty()) text += "\n[cost]\n";
    for (const auto& [name, cost] : problem.cost_per_kg)
        text += fmt::format("{} = {}\n", name, cost);
    if (problem.most_volume || problem.most_thickness_um) text += "\n[limits]\n";
    if (problem.most_volume) text += fmt::format("total_volume = {}\n", *problem.most_volume);
    if (problem.most_thickness_um)
        text += fmt::format("thickness_um = {}\n", *problem.most_thickness_um);
    return text;
}

}  // namespace fitting

void add_measured(MatchProblem& problem, const std::string& file, const std::string& column) {
    if (problem.measured.size() >= problem.targets.size())
        throw UsageError(fmt::format("{}: there are {} targets, and each has its measured file",
                                     file, problem.targets.size()));
    const MatchTarget& target = problem.targets[problem.measured.size()];
    fitting::MeasuredWords words{.file = file};
    words.options.column = column;
    words.options.mu_in = target.options.mu_in;
    FitData data{.name = file};
    try {
        fitting::read_values(words, data);
    } catch (const UsageError&) {  // of a geometry of its own
        words.options.mu_in.reset();
        fitting::read_values(words, data);
    }
    for (const MatchColour& colour : target.colours)
        fitting::colour_of(data, viewing(colour.light));
    problem.measured.push_back(std::move(data));
}

}  // namespace miebrdf
