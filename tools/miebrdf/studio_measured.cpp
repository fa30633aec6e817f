#include "tools/miebrdf/studio_page.h"

#include <fmt/format.h>
#include <miebrdf/fit.h>
#include <miebrdf/measured.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <system_error>

#include <miebrdf/error.h>
#include "materials/database/user_file.h"
#include "tools/miebrdf/scratch_folder.h"

namespace miebrdf::program {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A fit solves the scene at each wavelength some ten times: more would be no page that answers.
constexpr std::size_t kMostFittedWavelengths = 31;
constexpr std::size_t kMostUnknowns = 8;
/// Values that a page is given to draw.
constexpr std::size_t kMostShown = 20000;

std::string bytes_of(const std::string& base64) {
    static const std::string kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned held = 0;
    int bits = 0;
    for (const char digit : base64) {
        if (digit == '=') break;
        const std::size_t value = kDigits.find(digit);
        if (value == std::string::npos) throw UsageError("content", base64.substr(0, 20), "base64");
        held = (held << 6 | unsigned(value)) & 0xffffu;
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        bytes += char(held >> bits & 0xffu);
    }
    return bytes;
}

/// Letters, digits and dots of a name, without its folders: readers look at endings.
std::string plain_name(const std::string& name) {
    std::string plain;
    for (const char c : name.substr(name.find_last_of("/\\") + 1)) {
        const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.';
        plain += is_plain ? c : '_';
    }
    constexpr std::size_t kMost = 80;
    if (plain.size() > kMost) plain = plain.substr(plain.size() - kMost);
    return plain.empty() || plain.front() == '.' ? "measured" + plain : plain;
}

Measurements read_dropped(const json& asked) {
    const ScratchFolder folder;
    // Some readers look for companions two folders above.
    const fs::path inner = folder.path() / "a" / "b" / "c";
    fs::create_directories(inner);
    const std::string name = plain_name(asked.at("name").get<std::string>());
    std::ofstream(inner / name, std::ios::binary)
        << bytes_of(asked.at("content").get<std::string>());
    MeasuredOptions options{.quantity = asked.value("quantity", std::string())};
    if (asked.contains("theta_in_deg"))
        options.mu_in = std::cos(asked.at("theta_in_deg").get<double>() * std::numbers::pi / 180.0);
    try {
        return read_measured(inner / name, options);
    } catch (const Error& error) {
        // The name that the page knows, in place of ours.
        std::string text = error.what();
        const std::string path = inner.string() + "/";
        for (std::size_t at = text.find(path); at != std::string::npos; at = text.find(path))
            text.erase(at, path.size());
        throw InputError(text);
    }
}

json number_or_null(double value) { return std::isfinite(value) ? json(value) : json(); }

/// The values of one sample in a range, of at most kMostFittedWavelengths, evenly chosen.
std::vector<MeasuredValue> fitted_values(const Measurements& list, const json& asked) {
    const auto sample = asked.value("sample", std::size_t{0});
    const double from = asked.value("from_nm", 0.0), to = asked.value("to_nm", 1e9);
    std::vector<MeasuredValue> values;
    std::set<double> wavelengths;
    for (const MeasuredValue& value : list.values) {
        if (value.sample != sample || value.wavelength_nm < from || value.wavelength_nm > to)
            continue;
        values.push_back(value);
        if (std::isfinite(value.wavelength_nm)) wavelengths.insert(value.wavelength_nm);
    }
    if (values.empty())
        throw InputError(
            fmt::format("{} has no values between {} and {} nm, the wavelengths of the "
                        "scene",
                        list.file, from, to));
    const std::vector<double> all(wavelengths.begin(), wavelengths.end());
    if (all.size() <= kMostFittedWavelengths) return values;
    std::set<double> kept;
    for (std::size_t k = 0; k < kMostFittedWavelengths; ++k)
        kept.insert(all[k * (all.size() - 1) / (kMostFittedWavelengths - 1)]);
    std::erase_if(values, [&](const MeasuredValue& value) {
        return std::isfinite(value.wavelength_nm) && !kept.contains(value.wavelength_nm);
    });
    return values;
}

}  // namespace

json measured_for_page(const json& asked) {
    const Measurements list = read_dropped(asked);
    json values = json::array();
    for (const MeasuredValue& value : list.values) {
        if (values.size() == kMostShown) break;
        values.push_back({{"sample", value.sample},
                          {"quantity", word_of(value.quantity)},
                          {"geometry", word_of(value.geometry)},
                          {"wavelength_nm", number_or_null(value.wavelength_nm)},
                          {"mu_in", number_or_null(value.mu_in)},
                          {"mu_out", number_or_null(value.mu_out)},
                          {"azimuth_deg", number_or_null(value.azimuth_deg)},
                          {"value", number_or_null(value.value)}});
    }
    return {{"format", list.format},
            {"samples", list.samples},
            {"doubts", list.doubts},
            {"values", std::move(values)}};
}

json fit_for_page(const SaidWords& said, const json& asked, const Control& control) {
    if (!has_fit())
        throw UsageError(
            "this build cannot fit; install libceres-dev, then configure and build again");
    const json& unknowns = asked.at("unknowns");
    if (!unknowns.is_object() || unknowns.empty() || unknowns.size() > kMostUnknowns)
        throw UsageError("unknowns", double(unknowns.size()), "1 to 8 numbers that are free");
    const Measurements list = read_dropped(asked.at("file"));
    FitProblem problem;
    for (const auto& [word, values] : said) {
        if (word == "wavelengths") continue;
        SceneText text{word, {}};
        for (const WordValue& value : values) {
            const bool* const flag = std::get_if<bool>(&value);
            text.values.push_back(flag == nullptr ? text_of(value) : *flag ? "true" : "false");
        }
        problem.scene.push_back(std::move(text));
    }
    if (const std::string database = materials::from_environment("MIEBRDF_DATABASE");
        !database.empty())
        problem.scene.push_back({"database", {database}});
    for (const auto& [name, text] : unknowns.items())
        problem.unknowns.push_back(unknown(name, text.get<std::string>()));
    problem.data.push_back({.name = list.file, .values = fitted_values(list, asked)});
    const FitResult result = fit(problem, control);
    json values = json::array();
    for (const FittedValue& value : result.values) {
        values.push_back({{"unknown", value.unknown},
                          {"value", number_or_null(value.value)},
                          {"standard_error", number_or_null(value.standard_error)},
                          {"note", value.note}});
    }
    std::vector<std::string> notes = result.undetermined;
    notes.insert(notes.end(), result.notes.begin(), result.notes.end());
    double squares = 0.0;
    for (const FitResidual& residual : result.residuals)
        squares += std::pow(residual.model - residual.measured.value, 2);
    return {{"values", std::move(values)},
            {"notes", notes},
            {"used", result.residuals.size()},
            {"residual_rms", number_or_null(std::sqrt(squares / double(std::max<std::size_t>(
                                                                    1, result.residuals.size()))))},
            {"converged", result.converged},
            {"reason", result.reason}};
}

}  // namespace miebrdf::program
