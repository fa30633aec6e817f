// Materials that are computed: oscillators and formulas as names.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <miebrdf/index.h>

namespace miebrdf::materials {

/// "name(a,b(c,d))" taken apart: the name, and what stands between its commas.
struct Call {
    std::string name;
    std::vector<std::string> arguments;
};

/// Nothing when the text is no call. "/label" may follow, the label of its dataset.
std::optional<Call> parse_call(const std::string& text, std::string_view label);

struct Model {
    IndexFunction index;
    std::string title;
    std::string reference;
};

/// Label of the one dataset that a model has.
inline constexpr std::string_view kModelLabel = "model";

/// A model by its name:
///   drude(EPS_INF,EP,G), lorentz(EPS_INF,S,E0,G), tauc-lorentz(EPS_INF,...), cody-lorentz(...)
///   oscillators(EPS_INF,drude(EP,G),lorentz(S,E0,G),...)
///   formula(n=TEXT[,k=TEXT]), formula(eps1=TEXT[,eps2=TEXT])
/// all in eV; `range=FROM:TO` in nm may stand last. Nothing when the text names none.
/// @throws UsageError  for a model that is written wrongly
std::optional<Model> parse_model(const std::string& name);

}  // namespace miebrdf::materials
