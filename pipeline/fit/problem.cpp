#include "pipeline/fit/problem.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include <miebrdf/error.h>
#include "pipeline/fit/derived.h"
#include "pipeline/fit/model.h"
#include "pipeline/fit/start_advice.h"
#include "pipeline/fit/unknowns.h"

namespace miebrdf::fitting {
namespace {

bool is_lab(const MeasuredValue& value) { return value.quantity >= MeasuredQuantity::lab_l; }
bool has_view(const MeasuredValue& value) {
    return value.quantity == MeasuredQuantity::brdf ||
           value.quantity == MeasuredQuantity::reflectance_factor;
}

/// Shares may exceed 1 by the error of a measurement, and fall below 0, and no
/// more.
constexpr double kShareError = 0.05;

/// Of L*: a reflectance that is too large by twice kShareError.
constexpr double kWhitest = 104.0;

void check_value(const FitData& data, const MeasuredValue& value) {
    const auto refuse = [&](const std::string& reason) {
        throw InputError(fmt::format("{}: {}", describe(data, value), reason));
    };
    if (!std::isfinite(value.value)) refuse("the value is not a number; leave the row out");
    if (value.sigma < 0.0 || std::isinf(value.sigma))
        refuse(fmt::format("sigma {}; allowed: a standard deviation > 0", value.sigma));
    if (!is_lab(value) && !has_view(value) && value.value > 1.0 + kShareError && !data.free_scale)
        refuse(
            fmt::format("{} is more light than came in; check the white reference, or give "
                        "scale = \"free\" if the values are known up to a factor",
                        value.value));
    if (!is_lab(value) && value.value < -kShareError)
        refuse(fmt::format("{} is negative; leave the row out", value.value));
    if (is_lab(value)) {
        if (value.quantity == MeasuredQuantity::lab_l && value.value > kWhitest)
            refuse(fmt::format("L* is {}; allowed: up to {}: white is 100", value.value, kWhitest));
        if (!(value.mu_in > 0.0)) refuse("give mu_in or theta_in of the light; d8 is theta_in = 8");
        return;
    }
    if (!(value.wavelength_nm > 0.0))
        refuse("no wavelength; give a column wavelength_nm, or wavelength_nm = 532");
    const auto is_cosine = [](double mu) { return mu > 0.0 && mu <= 1.0; };
    if (!is_of_all_sides(value) && !is_cosine(value.mu_in))
        refuse(
            "where did the light come from? Give mu_in, in (0, 1], or theta_in, "
            "in [0, 90) "
            "degrees; quantity = \"hemispherical\" for light from all sides");
    if (has_view(value) && !is_cosine(value.mu_out))
        refuse("from where was it seen? Give mu_out or theta_out, and azimuth");
}

/// Whether a value is more than that of its own wavelength.
bool is_of_neighbours(const FitData& data) {
    return data.free_wavelength_shift || data.wavelength_shift_nm != 0.0 ||
           data.band_width_nm > 0.0 || data.correlation_length_nm > 0.0;
}

/// Spheres see a beam on the sample, and what comes back or passes.
void check_spheres(const FitData& data) {
    if (!data.spheres) return;
    validate(*data.spheres);
    for (const MeasuredValue& value : data.values) {
        const bool is_flux = value.quantity == MeasuredQuantity::reflectance ||
                             value.quantity == MeasuredQuantity::transmittance;
        if (is_flux && !is_of_all_sides(value) && value.geometry != MeasuredGeometry::d8_sce)
            continue;
        throw UsageError(data.name +
                         ": a sphere measures plane_albedo or plane_transmittance; "
                         "of specular excluded say unscattered_reflectance = 0 in sphere");
    }
}

/// What is said of the wavelengths of a spectrum.
void check_spectrum(const FitData& data) {
    constexpr double kWidestBand = 200.0, kLongestCorrelation = 1e4;
    if (!(std::abs(data.wavelength_shift_nm) <= kLargestShiftNm))
        throw UsageError(data.name + ": wavelength_shift in nm", data.wavelength_shift_nm,
                         "\"free\", or within +-20");
    if (!(data.band_width_nm >= 0.0 && data.band_width_nm <= kWidestBand))
        throw UsageError(data.name + ": band_width in nm", data.band_width_nm, "0 to 200");
    if (!(data.correlation_length_nm >= 0.0 && data.correlation_length_nm <= kLongestCorrelation))
        throw UsageError(data.name + ": correlation_length in nm", data.correlation_length_nm,
                         "0 to 10000");
    if (is_of_neighbours(data) && std::any_of(data.values.begin(), data.values.end(), is_lab))
        throw UsageError(data.name +
                         ": wavelength_shift, band_width and correlation_length belong to spectra; "
                         "leave them out of a colour");
}

std::vector<std::string> known_names(const FitProblem& problem) {
    std::vector<std::string> names;
    for (const Unknown& unknown : problem.unknowns) names.push_back(unknown.name);
    return names;
}

/// Every gap of the words is an unknown, and every unknown stands somewhere.
void check_names(const FitProblem& problem) {
    const std::vector<std::string> known = known_names(problem);
    std::set<std::string> used;
    for (const FitData& data : problem.data) {
        for (const std::string& name : unknowns_in(problem, words_of(problem, data))) {
            used.insert(name);
            if (std::find(known.begin(), known.end(), name) != known.end()) continue;
            throw UsageError(
                fmt::format("{{{0}}} stands in the scene, but "
                            "[unknowns] has no '{0}'; it has: {1}",
                            name, fmt::join(known, ", ")));
        }
        if (data.free_scale) used.insert(name_of_scale(data));
        if (data.free_wavelength_shift) used.insert(name_of_shift(data));
    }
    for (std::size_t i = 0; i < known.size(); ++i) {
        if (std::count(known.begin(), known.end(), known[i]) > 1)
            throw UsageError(fmt::format("unknown '{}' is there twice", known[i]));
        if (used.contains(known[i])) continue;
        throw UsageError(
            fmt::format("unknown '{0}' stands in no word of a scene "
                        "that was measured; write {{{0}}} where its "
                        "number belongs",
                        known[i]));
    }
}

/// There are at least as many values as unknowns, also at each wavelength.
void check_counts(const FitProblem& problem) {
    const std::vector<double> wavelengths = wavelengths_of(problem);
    std::map<double, int> values_at;
    std::size_t values = 0;
    for (const FitData& data : problem.data) {
        for (const MeasuredValue& value : data.values) ++values_at[value.wavelength_nm];
        values += data.values.size();
    }
    const std::size_t numbers = slots_of(problem.unknowns, wavelengths.size()).size();
    if (values < numbers) {
        throw UsageError(
            fmt::format("{} values cannot tell {} unknown numbers; "
                        "measure another quantity or geometry (over "
                        "black and over white, reflectance and "
                        "transmittance), or fix some of them",
                        values, numbers));
    }
    const auto apart = std::count_if(problem.unknowns.begin(), problem.unknowns.end(),
                                     [](const Unknown& u) { return u.per_wavelength; });
    for (const double nm : wavelengths) {
        if (values_at[nm] >= apart) continue;
        throw UsageError(
            fmt::format("{} nm: {} value(s) for {} unknowns per wavelength; "
                        "measure another quantity there, "
                        "let them share one number, or leave the wavelength out "
                        "(wavelengths = \"FIRST:LAST\")",
                        nm, values_at[nm], apart));
    }
}

void check_problem(const FitProblem& problem) {
    if (problem.unknowns.empty())
        throw UsageError(
            "nothing is unknown; write [unknowns] with radius = \"100 "
            "in 20:1000 log\" and "
            "{radius} in [scene]");
    if (problem.data.empty()) throw UsageError("nothing was measured; add a [[measured]]");
    check_search(problem);
    for (const FitData& data : problem.data) check_data(data);
    check_derived(problem);
    check_names(problem);
    check_counts(problem);
    const bool any_apart = std::any_of(problem.unknowns.begin(), problem.unknowns.end(),
                                       [](const Unknown& u) { return u.per_wavelength; });
    std::size_t with_sigma = 0, values = 0;
    for (const FitData& data : problem.data) {
        if (is_of_neighbours(data) && (any_apart || uses_derived(problem, words_of(problem, data))))
            throw UsageError(data.name +
                             ": wavelength_shift, band_width and correlation_length tie "
                             "wavelengths together; numbers that differ from one to the next do "
                             "without them");
        for (const MeasuredValue& value : data.values) {
            with_sigma += value.sigma > 0.0;
            ++values;
            if (is_lab(value) && any_apart)
                throw UsageError(
                    fmt::format("{}: a colour cannot tell numbers at each "
                                "wavelength; give a spectrum",
                                data.name));
        }
    }
    if (with_sigma != 0 && with_sigma != values)
        throw UsageError(
            fmt::format("{} of {} values have a sigma above 0; give sigma or relative_sigma for "
                        "each [[measured]], or for none",
                        with_sigma, values));
}

}  // namespace

void check_search(const FitProblem& problem) {
    if (problem.starts < 0 || problem.starts > 1000)
        throw UsageError("starts", double(problem.starts), "1 to 1000, or 0: as the scene needs");
    if (problem.most_iterations < 1 || problem.most_iterations > 10000)
        throw UsageError("iterations", double(problem.most_iterations), "1 to 10000");
    if (!(problem.loss_width > 0.0)) throw UsageError("loss width", problem.loss_width, "> 0");
}

void check_data(const FitData& data) {
    if (data.values.empty())
        throw InputError(fmt::format("{}: no values; a [[measured]] needs some", data.name));
    check_spectrum(data);
    check_spheres(data);
    // A spectrum has one value at each wavelength.
    std::set<std::tuple<double, double, MeasuredQuantity, MeasuredGeometry>> known;
    for (const MeasuredValue& value : data.values) {
        check_value(data, value);
        if (has_view(value) || is_lab(value)) continue;
        const double mu_in = is_of_all_sides(value) ? 0.0 : value.mu_in;
        if (!known.emplace(value.wavelength_nm, mu_in, value.quantity, value.geometry).second)
            throw InputError(
                fmt::format("{}: this wavelength is there twice; keep "
                            "one row, or their mean with its sigma",
                            describe(data, value)));
    }
}

void check_scene(const FitProblem& problem, const FitData& data) {
    const auto words = words_of(problem, data);
    const auto check = [&](const std::vector<double>& numbers) {
        const auto number_of = [&](const std::string& name) {
            for (std::size_t u = 0; u < problem.unknowns.size(); ++u) {
                if (problem.unknowns[u].name == name) return numbers[u];
            }
            throw UsageError(fmt::format("there is no unknown '{}'", name));
        };
        const auto text_of = [&](const std::string& name) {
            if (const DerivedNumber* derived = find_derived(problem, name))
                return fmt::format(
                    "{}", derived_number(*derived, data.values.front().wavelength_nm, number_of));
            return fmt::format("{}", number_of(name));
        };
        Request request;
        for (const TemplateWord& word : words) apply(word, text_of, request);
        validate(request.scene);
    };
    std::vector<double> starts;
    for (const Unknown& unknown : problem.unknowns) starts.push_back(unknown.start);
    try {
        check(starts);
    } catch (const UsageError& error) {
        const auto can_be = [&](const std::vector<double>& numbers) {
            try {
                check(numbers);
                return true;
            } catch (const UsageError&) {
                return false;
            }
        };
        throw UsageError(error.what() + start_that_works(problem.unknowns, can_be));
    }
}

std::set<std::string> names_in(const std::vector<TemplateWord>& words) {
    std::set<std::string> names;
    for (const TemplateWord& word : words) {
        for (const WordValue& value : word.values) {
            if (const auto* text = std::get_if<std::string>(&value)) {
                for (const std::string& name : gaps_in(*text)) names.insert(name);
            }
        }
    }
    return names;
}

std::string name_of_scale(const FitData& data) { return "scale of " + data.name; }

std::string name_of_shift(const FitData& data) { return "wavelength shift of " + data.name; }

double tolerance_of(const FitProblem& problem) {
    // Larger errors than the solver's own default are no reason to err more;
    // smaller ones than a spectrometer's, none to work for hours.
    double smallest = 1e-3;
    for (const FitData& data : problem.data) {
        for (const MeasuredValue& value : data.values) {
            if (value.sigma > 0.0 && value.value > 0.0)
                smallest = std::min(smallest, 0.1 * value.sigma / value.value);
        }
    }
    return std::max(smallest, 1e-5);
}

bool is_separable(const FitProblem& problem) {
    return std::all_of(problem.unknowns.begin(), problem.unknowns.end(),
                       [](const Unknown& unknown) { return unknown.per_wavelength; });
}

FitProblem at_wavelength(const FitProblem& problem, double wavelength_nm) {
    FitProblem part = problem;
    for (FitData& data : part.data) {
        std::erase_if(data.values,
                      [&](const MeasuredValue& v) { return v.wavelength_nm != wavelength_nm; });
    }
    return part;
}

std::string describe(const FitData& data, const MeasuredValue& value) {
    std::string text = data.name;
    if (value.wavelength_nm > 0.0) text += fmt::format(", {} nm", value.wavelength_nm);
    if (value.mu_in > 0.0) text += fmt::format(", mu_in {:.4g}", value.mu_in);
    if (value.mu_out > 0.0) text += fmt::format(", mu_out {:.4g}", value.mu_out);
    if (std::isfinite(value.azimuth_deg))
        text += fmt::format(", azimuth {:.4g}", value.azimuth_deg);
    return text;
}

bool is_of_all_sides(const MeasuredValue& value) {
    return value.geometry == MeasuredGeometry::hemispherical;
}

bool has_sigmas(const FitProblem& problem) {
    return std::all_of(problem.data.begin(), problem.data.end(), [](const FitData& data) {
        return std::all_of(data.values.begin(), data.values.end(),
                           [](const MeasuredValue& value) { return value.sigma > 0.0; });
    });
}

FitProblem checked(FitProblem problem) {
    for (const Unknown& unknown : problem.unknowns) validate(unknown);
    for (const FitData& data : problem.data) {
        if (data.free_scale)
            problem.unknowns.push_back({.name = name_of_scale(data),
                                        .start = 1.0,
                                        .low = 1e-3,
                                        .high = 1e3,
                                        .scale = Unknown::Scale::logarithm});
        if (data.free_wavelength_shift)
            problem.unknowns.push_back({.name = name_of_shift(data),
                                        .start = 0.0,
                                        .low = -kLargestShiftNm,
                                        .high = kLargestShiftNm});
    }
    for (const SceneText& text : problem.scene) {
        if (find_scene_word(text.word) == nullptr)
            throw UsageError(fmt::format("unknown word '{}' of a scene", text.word));
    }
    check_problem(problem);
    return problem;
}

}  // namespace miebrdf::fitting
