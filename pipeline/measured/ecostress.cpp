// Spectra of the ECOSTRESS library and its forerunner, the ASTER library: lines "Name: value", a
// blank line, then wavelength and value. https://speclib.jpl.nasa.gov
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "materials/index/units.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/sheet.h"

namespace miebrdf::measured {
namespace {

using materials::lower_case;

bool looks_like_ecostress(const MeasuredFile& file) {
    const std::string start = lower_case(file.content.substr(0, 6000));
    return start.starts_with("name:") && start.find("x units:") != std::string::npos &&
           start.find("y units:") != std::string::npos;
}

Measurements read_ecostress(const MeasuredFile& file, const MeasuredOptions& options) {
    std::map<std::string, std::string> header;
    std::vector<double> nm, values;
    std::vector<int> lines;
    Measurements list;
    const auto asked = [&](const char* name) {
        const auto found = header.find(name);
        if (found == header.end()) refuse(file, 0, fmt::format("no line '{}:'", name));
        return found->second;
    };
    std::optional<materials::Unit> unit;
    double factor = 1.0;
    Conversion conversion = Conversion::none;
    MeasuredKind kind;
    NamedGeometry geometry;
    const auto end_header = [&] {
        const std::string y_units = lower_case(asked("y units")), x_units = asked("x units");
        const auto spectral = materials::spectral_name(x_units);
        unit = spectral ? spectral->unit : std::nullopt;
        if (!unit) {
            // "Wavelength (micrometers)", "Wavenumber (cm-1)": the unit stands in brackets.
            const std::size_t open = x_units.find('(');
            const std::size_t close = std::min(x_units.find(')'), x_units.size());
            if (open != std::string::npos && open < close)
                unit = materials::parse_unit(x_units.substr(open + 1, close - open - 1));
        }
        if (!unit) refuse(file, 0, fmt::format("X units '{}' are not understood", x_units));
        const auto meaning = value_meaning(y_units);
        if (!meaning || (!meaning->refused.empty() && options.quantity.empty())) {
            refuse(file, 0,
                   meaning ? refusal_of("Y units: " + y_units, meaning->refused)
                           : fmt::format("Y units '{}': neither reflectance nor transmittance",
                                         y_units));
        }
        kind = meaning->kind;
        conversion = meaning->conversion;
        if (conversion == Conversion::none)
            factor = share_factor(list, options, says_percent(y_units), "Y units");
        else
            list.facts.emplace_back("data", words_of(conversion, kind.quantity));
        for (const char* name : {"measurement", "type"}) {
            if (header.count(name) != 0) list.facts.emplace_back(name, header[name]);
        }
        if (header.count("measurement") != 0) geometry = geometry_in(header["measurement"]);
        kind.geometry = geometry.geometry;
        if (kind.geometry == MeasuredGeometry::directions &&
            kind.quantity == MeasuredQuantity::reflectance)
            kind.quantity = MeasuredQuantity::reflectance_factor;
    };
    int line = 0;
    bool in_header = true;
    for (const std::string_view text : materials::split_lines(file.content)) {
        ++line;
        const std::string_view content = materials::without_blanks(text);
        if (in_header) {
            const std::size_t colon = content.find(':');
            if (colon != std::string_view::npos) {
                header[lower_case(content.substr(0, colon))] =
                    materials::without_blanks(content.substr(colon + 1));
            } else if (content.empty() && header.count("y units") != 0) {
                in_header = false;
                end_header();
            }
            continue;
        }
        if (content.empty()) continue;
        const auto words = materials::split_words(content, " \t,");
        const auto x = materials::parse_number(words[0]);
        const auto y = words.size() == 2 ? measured_number(words[1]) : std::nullopt;
        if (!x || !y || !(*x > 0.0)) {
            refuse(file, line,
                   fmt::format("'{}': expected a wavelength above 0 and a value", content));
        }
        nm.push_back(materials::to_nm(*x, *unit));
        values.push_back(converted(*y, conversion) * factor);
        lines.push_back(line);
    }
    if (in_header) refuse(file, 0, "no blank line after its header, and no values");
    const auto count = header.find("number of x values");
    if (count != header.end()) {
        const auto said = materials::parse_number(count->second);
        if (said && *said != double(nm.size())) {
            list.doubts.push_back(fmt::format("{}: {} values; its header says {}", file.path,
                                              nm.size(), count->second));
        }
    }
    add_spectrum(list, asked("name"), kind, geometry.mu_in, nm, values, lines);
    return list;
}

}  // namespace

extern const Reader kEcostress;
constinit const Reader kEcostress{
    {"ecostress", "ECOSTRESS and ASTER libraries (.txt)"}, looks_like_ecostress, read_ecostress};

}  // namespace miebrdf::measured
