#include "pipeline/fit/fitted_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <miebrdf/error.h>
#include "pipeline/fit/derived.h"
#include "pipeline/fit/model.h"
#include "pipeline/fit/problem.h"
#include "pipeline/scene/scene_words.h"

namespace miebrdf::fitting {
namespace {

/// With the fitted values in its gaps. @param nm  of those that differ between
/// wavelengths
std::string filled(const std::string& text, const FitProblem& problem, const FitResult& result,
                   double nm) {
    std::string out = text;
    const auto replace = [&out](const std::string& name, double number) {
        const std::string gap = "{" + name + "}", word = fmt::format("{}", number);
        for (std::size_t at = out.find(gap); at != std::string::npos; at = out.find(gap, at))
            out.replace(at, gap.size(), word);
    };
    const auto number_of = [&](const std::string& name) {
        for (const FittedValue& value : result.values) {
            if (value.unknown == name && value.wavelength_nm.value_or(nm) == nm) return value.value;
        }
        throw UsageError(fmt::format("there is no unknown '{}'", name));
    };
    for (const std::string& name : gaps_in(text)) {
        if (const DerivedNumber* derived = find_derived(problem, name))
            replace(name, derived_number(*derived, nm, number_of));
    }
    for (const FittedValue& value : result.values) {
        if (value.wavelength_nm && *value.wavelength_nm != nm) continue;
        replace(value.unknown, value.value);
    }
    return out;
}

std::string word_line(const TemplateWord& word, const FitProblem& problem, const FitResult& result,
                      double nm) {
    std::vector<WordValue> values;
    for (const WordValue& value : word.values)
        values.emplace_back(filled(text_of(value), problem, result, nm));
    return toml_of(*find_scene_word(word.name), values) + "\n";
}

std::string list_line(const char* name, const std::set<double>& numbers) {
    return numbers.empty() ? "" : fmt::format("{} = [{}]\n", name, fmt::join(numbers, ", "));
}

/// Of the combinations of scattered directions so many numbers of each kind are written: a grid
/// that `miebrdf run` solves in seconds.
void thin(std::set<double>& numbers) {
    constexpr std::size_t kMost = 12;
    if (numbers.size() <= kMost) return;
    const std::vector<double> all(numbers.begin(), numbers.end());
    numbers.clear();
    for (std::size_t i = 0; i < kMost; ++i) numbers.insert(all[i * (all.size() - 1) / (kMost - 1)]);
}

/// The [[result]] of these values.
std::string result_text(const std::vector<TemplateWord>& words, const FitProblem& problem,
                        const FitData& data, const FitResult& result,
                        std::optional<double> only_nm) {
    std::set<double> nm, mu_in, mu_out, azimuth;
    bool has_view = false;
    for (const MeasuredValue& value : data.values) {
        if (only_nm && value.wavelength_nm != *only_nm) continue;
        if (value.wavelength_nm > 0.0) nm.insert(value.wavelength_nm);
        if (value.mu_in > 0.0) mu_in.insert(value.mu_in);
        if (!(value.mu_out > 0.0)) continue;
        has_view = true;
        mu_out.insert(value.mu_out);
        azimuth.insert(std::isnan(value.azimuth_deg) ? 0.0 : value.azimuth_deg);
    }
    if (nm.empty() && only_nm) return "";
    constexpr std::size_t kMostCombinations = 100'000;
    if (mu_in.size() * mu_out.size() * azimuth.size() > kMostCombinations) {
        thin(mu_in);
        thin(mu_out);
        thin(azimuth);
    }
    std::string text = fmt::format("\n[[result]]  # {}\ncommand = \"{}\"\n", data.name,
                                   has_view ? "brdf" : "albedo");
    for (const TemplateWord& word : words)
        text += word_line(word, problem, result, only_nm.value_or(0.0));
    text += nm.empty() ? "wavelengths = \"400:700:10\"\n" : list_line("wavelengths", nm);
    text += list_line("mu-in", mu_in);
    if (has_view) text += list_line("mu-out", mu_out) + list_line("azimuth", azimuth);
    return text;
}

}  // namespace

std::string fitted_scene(const FitProblem& problem, const FitResult& result) {
    std::string text = "# A fitted scene: miebrdf run THIS-FILE\n";
    for (const FittedValue& value : result.values) {
        if (!value.wavelength_nm)
            text += fmt::format("# {} = {:.6g}{}\n", value.unknown, value.value,
                                std::isfinite(value.standard_error)
                                    ? fmt::format(", standard error {:.2g}", value.standard_error)
                                    : ", without a standard error");
    }
    for (const FitData& data : problem.data) {
        const std::vector<TemplateWord> words = words_of(problem, data);
        const auto names = names_in(words);
        std::set<double> apart;
        for (const FittedValue& value : result.values) {
            if (value.wavelength_nm && names.contains(value.unknown))
                apart.insert(*value.wavelength_nm);
        }
        if (uses_derived(problem, words)) {
            for (const MeasuredValue& value : data.values) apart.insert(value.wavelength_nm);
        }
        if (apart.empty()) text += result_text(words, problem, data, result, {});
        for (const double nm : apart) text += result_text(words, problem, data, result, nm);
    }
    return text;
}

}  // namespace miebrdf::fitting
