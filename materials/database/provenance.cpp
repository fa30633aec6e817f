#include "materials/database/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "materials/readers/delimited.h"

namespace miebrdf::materials {
namespace {

using Field = std::pair<const char*, std::string Dataset::*>;
constexpr Field fields[] = {
    {"material", &Dataset::material},       {"title", &Dataset::title},
    {"formula", &Dataset::formula},         {"label", &Dataset::label},
    {"source", &Dataset::source},           {"key", &Dataset::key},
    {"reference", &Dataset::reference},     {"doi", &Dataset::doi},
    {"licence", &Dataset::licence},         {"ray", &Dataset::ray},
    {"composition", &Dataset::composition}, {"note", &Dataset::note},
};

std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    std::replace(text.begin(), text.end(), '\r', ' ');
    return text;
}

}  // namespace

std::vector<std::string> provenance_lines(const Dataset& dataset) {
    std::vector<std::string> lines;
    for (const auto& [name, member] : fields) {
        const std::string& value = dataset.*member;
        if (!value.empty()) lines.push_back(fmt::format("{}: {}", name, one_line(value)));
    }
    if (dataset.temperature_k)
        lines.push_back(fmt::format("temperature_k: {}", *dataset.temperature_k));
    for (const std::string& correction : dataset.corrections) {
        lines.push_back("correction: " + one_line(correction));
    }
    return lines;
}

void read_provenance_line(Dataset& dataset, std::string_view line) {
    const std::size_t colon = line.find(": ");
    if (colon == std::string_view::npos) return;
    const std::string_view name = without_blanks(line.substr(0, colon));
    const std::string value(without_blanks(line.substr(colon + 2)));
    for (const auto& [known, member] : fields) {
        if (name == known && (dataset.*member).empty()) dataset.*member = value;
    }
    if (name == "temperature_k") {
        const auto kelvin = parse_number(value);
        if (kelvin && *kelvin > 0 && *kelvin < 1e6) dataset.temperature_k = kelvin;
    }
    if (name == "correction") dataset.corrections.push_back(value);
    if (dataset.ray != "o" && dataset.ray != "e") dataset.ray.clear();
}

}  // namespace miebrdf::materials
