#include "pipeline/fit/derived.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include <miebrdf/error.h>
#include "materials/index/expression.h"
#include "pipeline/fit/problem.h"

namespace miebrdf::fitting {
namespace {

const std::string kWavelength = "wavelength_nm";

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) || c == '.'; }

/// The formula with every name replaced; the e of 1e5 is none.
std::string replaced(const std::string& formula,
                     const std::function<std::string(const std::string& name)>& text_of) {
    std::string out;
    for (std::size_t i = 0; i < formula.size();) {
        std::size_t end = i + 1;
        if (is_letter(formula[i])) {
            while (end < formula.size() && (is_letter(formula[end]) || is_digit(formula[end])))
                ++end;
            out += text_of(formula.substr(i, end - i));
        } else {
            const auto is_of_number = [&](std::size_t k) {
                const bool is_sign =
                    (formula[k] == '-' || formula[k] == '+') && std::tolower(formula[k - 1]) == 'e';
                return is_digit(formula[k]) || std::tolower(formula[k]) == 'e' || is_sign;
            };
            while (is_digit(formula[i]) && end < formula.size() && is_of_number(end)) ++end;
            out += formula.substr(i, end - i);
        }
        i = end;
    }
    return out;
}

const Unknown* find_unknown(const FitProblem& problem, const std::string& name) {
    const auto found = std::find_if(problem.unknowns.begin(), problem.unknowns.end(),
                                    [&](const Unknown& unknown) { return unknown.name == name; });
    return found == problem.unknowns.end() ? nullptr : &*found;
}

}  // namespace

const DerivedNumber* find_derived(const FitProblem& problem, const std::string& name) {
    const auto found =
        std::find_if(problem.derived.begin(), problem.derived.end(),
                     [&](const DerivedNumber& derived) { return derived.name == name; });
    return found == problem.derived.end() ? nullptr : &*found;
}

bool uses_derived(const FitProblem& problem, const std::vector<TemplateWord>& words) {
    const auto names = names_in(words);
    return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
        return find_derived(problem, name) != nullptr;
    });
}

std::set<std::string> unknowns_in(const FitProblem& problem,
                                  const std::vector<TemplateWord>& words) {
    std::set<std::string> all;
    for (const std::string& name : names_in(words)) {
        const DerivedNumber* derived = find_derived(problem, name);
        if (derived == nullptr) {
            all.insert(name);
            continue;
        }
        replaced(derived->formula, [&](const std::string& part) {
            if (find_unknown(problem, part) != nullptr) all.insert(part);
            return std::string();
        });
    }
    return all;
}

double derived_number(const DerivedNumber& derived, double wavelength_nm,
                      const std::function<double(const std::string& unknown)>& number_of) {
    const std::string formula = replaced(derived.formula, [&](const std::string& name) {
        return name == kWavelength ? "nm" : fmt::format("({})", number_of(name));
    });
    const double value = materials::Expression(formula).at(wavelength_nm);
    if (!std::isfinite(value))
        throw UsageError(fmt::format("{} = '{}' is {} at {} nm; allowed: a finite number",
                                     derived.name, derived.formula, value, wavelength_nm));
    return value;
}

void check_derived(const FitProblem& problem) {
    for (const DerivedNumber& derived : problem.derived) {
        if (derived.name.empty() || !is_letter(derived.name[0]) ||
            find_unknown(problem, derived.name) != nullptr ||
            find_derived(problem, derived.name) != &derived)
            throw UsageError(
                fmt::format("derived number '{}': a name begins with a letter, and stands once in "
                            "[unknowns] and [derived]",
                            derived.name));
    }
}

}  // namespace miebrdf::fitting
