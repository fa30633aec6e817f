#include "materials/database/models.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <miebrdf/error.h>
#include "materials/index/expression.h"
#include "materials/index/oscillators.h"
#include "materials/index/units.h"
#include "materials/readers/text.h"

namespace miebrdf::materials {
namespace {

// Models are used where nobody measured; these are the ends of what optics calls light.
constexpr double kShortest_nm = 10.0, kLongest_nm = 1e6;

constexpr char kAdvice[] =
    "; range=FROM:TO (nm) as the last argument keeps the model to where it is one";

[[noreturn]] void refuse_model(const std::string& name, const std::string& reason) {
    throw UsageError(fmt::format("model '{}': {}", name, reason));
}

struct Oscillator {
    const OscillatorKind* kind = nullptr;
    std::vector<double> parameters;
};

std::vector<double> read_numbers(const std::string& name, const Call& call) {
    std::vector<double> numbers;
    for (const std::string& argument : call.arguments) {
        const auto number = parse_number(argument);
        if (!number || !std::isfinite(*number))
            refuse_model(name, fmt::format("'{}' in {}(...) is not a number", argument, call.name));
        numbers.push_back(*number);
    }
    return numbers;
}

Oscillator make_oscillator(const std::string& name, const OscillatorKind& kind,
                           std::vector<double> parameters, bool after_epsilon) {
    const std::size_t count = parameters.size();
    if (count != kind.fewest_parameters && count != kind.parameters.size()) {
        std::string meanings;
        for (const OscillatorParameter& p : kind.parameters)
            meanings += fmt::format("{}{} {}", meanings.empty() ? "" : "; ", p.name, p.meaning);
        std::string form = form_of(kind);
        if (after_epsilon) form.insert(form.find('(') + 1, "EPS_INF,");
        refuse_model(name, fmt::format("{} parameter{} of {}; write {} ({})", count,
                                       count == 1 ? "" : "s", kind.name, form, meanings));
    }
    for (std::size_t i = 0; i < count; ++i) {
        const OscillatorParameter& p = kind.parameters[i];
        if (p.may_be_zero ? parameters[i] >= 0.0 : parameters[i] > 0.0) continue;
        refuse_model(name, fmt::format("{} of {} ({}) is {}; allowed: {} 0", p.name, kind.name,
                                       p.meaning, parameters[i], p.may_be_zero ? ">=" : ">"));
    }
    return {&kind, std::move(parameters)};
}

void require_epsilon(const std::string& name, double eps_inf) {
    if (!(eps_inf >= 0.0 && eps_inf <= 1e6))
        refuse_model(name, fmt::format("EPS_INF is {}; allowed: 0 to 1e6", eps_inf));
}

std::complex<double> root_of(std::complex<double> permittivity) {
    // A permittivity without absorption has Im = 0 of either sign.
    if (permittivity.imag() == 0.0) permittivity = permittivity.real();
    return std::sqrt(permittivity);
}

/// Wavelengths at which a model is tabulated for those who need a table.
std::vector<double> sample(double shortest_nm, double longest_nm,
                           const std::vector<Oscillator>& oscillators) {
    std::vector<double> grid;
    const double decades = std::log10(longest_nm / shortest_nm);
    const int count = std::max(200, int(std::ceil(200.0 * decades)));
    for (int i = 0; i <= count; ++i)
        grid.push_back(shortest_nm * std::pow(10.0, decades * i / count));
    grid.back() = longest_nm;
    for (const Oscillator& oscillator : oscillators) {
        const auto [centre, width] = oscillator.kind->feature(oscillator.parameters);
        for (int i = -30; i <= 30; ++i) {
            const double energy_ev = centre + 0.1 * i * width;
            if (!(energy_ev > 0.0)) continue;
            const double w = to_nm(energy_ev, Unit::electronvolt);
            if (w > shortest_nm && w < longest_nm) grid.push_back(w);
        }
    }
    std::sort(grid.begin(), grid.end());
    grid.erase(std::unique(grid.begin(), grid.end(),
                           [](double a, double b) { return !(b > a * (1 + 1e-9)); }),
               grid.end());
    return grid;
}

/// Takes `range=FROM:TO` off the end.
std::pair<double, double> take_range(const std::string& name, Call& call) {
    constexpr std::string_view kKey = "range=";
    if (call.arguments.empty() || !call.arguments.back().starts_with(kKey))
        return {kShortest_nm, kLongest_nm};
    const std::string text = call.arguments.back().substr(kKey.size());
    call.arguments.pop_back();
    const std::size_t colon = text.find(':');
    const auto from =
        colon == std::string::npos ? std::nullopt : parse_number(text.substr(0, colon));
    const auto to =
        colon == std::string::npos ? std::nullopt : parse_number(text.substr(colon + 1));
    if (!from || !to || !(*from > 0.0 && *from < *to && std::isfinite(*to)))
        refuse_model(name,
                     fmt::format("range '{}'; write FROM:TO in nm, e.g. range=400:700", text));
    return {*from, *to};
}

std::string described(const Oscillator& oscillator) {
    return fmt::format("{}({})", oscillator.kind->name, fmt::join(oscillator.parameters, ","));
}

Model model_of(double eps_inf, std::vector<Oscillator> oscillators, double shortest_nm,
               double longest_nm) {
    Model model;
    std::vector<std::string> references;
    model.title = fmt::format("oscillators: permittivity {}", eps_inf);
    for (const Oscillator& oscillator : oscillators) {
        model.title += " + " + described(oscillator);
        const std::string reference = oscillator.kind->reference;
        if (std::find(references.begin(), references.end(), reference) == references.end())
            references.push_back(reference);
    }
    model.reference = fmt::format("{}", fmt::join(references, "; "));
    model.index.shortest_nm = shortest_nm;
    model.index.longest_nm = longest_nm;
    model.index.advice = kAdvice;
    model.index.grid_nm = sample(shortest_nm, longest_nm, oscillators);
    model.index.at = [eps_inf, oscillators = std::move(oscillators)](double wavelength_nm) {
        const double energy_ev = from_nm(wavelength_nm, Unit::electronvolt);
        std::complex<double> sum = eps_inf;
        for (const Oscillator& oscillator : oscillators)
            sum += oscillator.kind->susceptibility(oscillator.parameters, energy_ev);
        return root_of(sum);
    };
    return model;
}

Model one_oscillator(const std::string& name, const OscillatorKind& kind, Call call) {
    const auto [shortest_nm, longest_nm] = take_range(name, call);
    std::vector<double> numbers = read_numbers(name, call);
    if (numbers.empty()) refuse_model(name, "write EPS_INF, then the parameters");
    const double eps_inf = numbers.front();
    require_epsilon(name, eps_inf);
    numbers.erase(numbers.begin());
    return model_of(eps_inf, {make_oscillator(name, kind, std::move(numbers), true)}, shortest_nm,
                    longest_nm);
}

Model several_oscillators(const std::string& name, Call call) {
    const auto [shortest_nm, longest_nm] = take_range(name, call);
    const auto eps_inf =
        call.arguments.empty() ? std::nullopt : parse_number(call.arguments.front());
    if (!eps_inf) refuse_model(name, "write EPS_INF first: oscillators(1,drude(9,0.07))");
    require_epsilon(name, *eps_inf);
    std::vector<Oscillator> oscillators;
    for (std::size_t i = 1; i < call.arguments.size(); ++i) {
        const auto term = parse_call(call.arguments[i], {});
        const OscillatorKind* kind = term ? find_oscillator_kind(term->name) : nullptr;
        if (kind == nullptr) {
            std::vector<std::string> forms;
            for (const OscillatorKind& known : oscillator_kinds()) forms.push_back(form_of(known));
            refuse_model(name, fmt::format("'{}' is no oscillator; known: {}", call.arguments[i],
                                           fmt::join(forms, ", ")));
        }
        oscillators.push_back(make_oscillator(name, *kind, read_numbers(name, *term), false));
    }
    return model_of(*eps_inf, std::move(oscillators), shortest_nm, longest_nm);
}

Model formula_model(const std::string& name, Call call) {
    const auto [shortest_nm, longest_nm] = take_range(name, call);
    std::map<std::string, Expression> parts;
    for (const std::string& argument : call.arguments) {
        const std::size_t equals = argument.find('=');
        const std::string part(without_blanks(argument.substr(0, equals)));
        const bool known = part == "n" || part == "k" || part == "eps1" || part == "eps2";
        if (equals == std::string::npos || !known)
            refuse_model(name,
                         fmt::format("'{}'; write n=..., k=..., or eps1=..., eps2=...", argument));
        if (!parts.try_emplace(part, argument.substr(equals + 1)).second)
            refuse_model(name, fmt::format("{} twice", part));
    }
    const bool as_index = parts.contains("n"), as_permittivity = parts.contains("eps1");
    if (as_index == as_permittivity || parts.contains(as_index ? "eps2" : "k"))
        refuse_model(name, "write n and perhaps k, or eps1 and perhaps eps2");
    const Expression real = parts.at(as_index ? "n" : "eps1");
    const auto found = parts.find(as_index ? "k" : "eps2");
    std::optional<Expression> imaginary;
    if (found != parts.end()) imaginary = found->second;
    Model model;
    model.title = name;
    model.reference = "formula of the user";
    model.index.shortest_nm = shortest_nm;
    model.index.longest_nm = longest_nm;
    model.index.advice = kAdvice;
    model.index.grid_nm = sample(shortest_nm, longest_nm, {});
    model.index.k_known = !as_index || imaginary;
    model.index.at = [as_index, real, imaginary](double wavelength_nm) {
        const std::complex<double> value(real.at(wavelength_nm),
                                         imaginary ? imaginary->at(wavelength_nm) : 0.0);
        return as_index ? value : root_of(value);
    };
    return model;
}

}  // namespace

std::optional<Call> parse_call(const std::string& text, std::string_view label) {
    std::string name(without_blanks(text));
    const std::string ending = ")/" + std::string(label);
    if (!label.empty() && name.ends_with(ending)) name.resize(name.size() - label.size() - 1);
    const std::size_t open = name.find('(');
    if (open == std::string::npos || !name.ends_with(')')) return std::nullopt;
    Call call{std::string(without_blanks(name.substr(0, open))), {}};
    const std::string inside = name.substr(open + 1, name.size() - open - 2);
    if (without_blanks(inside).empty()) return call;
    int depth = 0;
    std::string argument;
    for (const char c : inside) {
        depth += c == '(' ? 1 : c == ')' ? -1 : 0;
        if (depth < 0) return std::nullopt;  // a(b) + c(d)
        if (c == ',' && depth == 0) {
            call.arguments.emplace_back(without_blanks(argument));
            argument.clear();
        } else {
            argument += c;
        }
    }
    call.arguments.emplace_back(without_blanks(argument));
    return call;
}

std::optional<Model> parse_model(const std::string& name) {
    auto call = parse_call(name, kModelLabel);
    if (!call) return std::nullopt;
    if (call->name == "oscillators") return several_oscillators(name, *std::move(call));
    if (call->name == "formula") return formula_model(name, *std::move(call));
    const OscillatorKind* kind = find_oscillator_kind(call->name);
    if (kind == nullptr) return std::nullopt;
    return one_oscillator(name, *kind, *std::move(call));
}

}  // namespace miebrdf::materials
