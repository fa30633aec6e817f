// Texts of Ocean Optics' programs (OOIBase32, SpectraSuite, OceanView) and Jaz instruments: lines
// about the measurement, then wavelength and value below ">>>>>Begin Spectral Data<<<<<", in the
// language of the program; of a Jaz below names of columns, W(avelength), D(ark), R(eference),
// S(ample), P(rocessed). What the values are stands in the name of the file that the first line
// repeats ("Data from leaf_Reflection_0001.txt Node"), in the ending of OOIBase32's files
// ("leaf.Master.Transmission"), or nowhere.
#include <fmt/format.h>

#include <algorithm>

#include "materials/index/units.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/columns.h"
#include "pipeline/measured/reader.h"

namespace miebrdf::measured {
namespace {

bool is_mark(std::string_view line) {
    return line.starts_with(">>>>>") && line.find("<<<<<") != std::string_view::npos;
}

bool looks_like_ocean(const MeasuredFile& file) {
    const std::string_view start = file.content.substr(0, 8000);
    const std::size_t at = start.find(">>>>>");
    return at != std::string_view::npos && is_mark(start.substr(at, 80));
}

Measurements read_ocean(const MeasuredFile& file, const MeasuredOptions& options) {
    Measurements list;
    std::optional<ValueMeaning> said;
    std::string title;
    std::optional<double> pixels;
    bool in_data = false;
    double factor = 1.0;
    std::vector<double> nm, values;
    std::vector<int> lines;
    std::size_t columns = 2, of_values = 1;
    int line = 0;
    for (const std::string_view text : materials::split_lines(file.content)) {
        ++line;
        const std::string_view content = materials::without_blanks(text);
        if (content.empty()) continue;
        if (in_data && is_mark(content)) break;
        if (!in_data) {
            if (title.empty()) {
                title = materials::as_utf8(content);
                const std::string ending = std::filesystem::path(file.path).extension().string();
                said = value_meaning(content);
                if (!said && !ending.empty()) said = value_meaning(ending.substr(1));
            }
            if (content.starts_with("Number of Pixels in "))
                pixels = materials::parse_number(
                    materials::without_blanks(content.substr(content.rfind(':') + 1)));
            constexpr std::string_view kAxis = "XAxis mode:";
            if (content.starts_with(kAxis)) {
                const std::string axis =
                    materials::as_utf8(materials::without_blanks(content.substr(kAxis.size())));
                if (!materials::lower_case(axis).starts_with("wavelength"))
                    refuse(file, line, fmt::format("its axis is '{}'; allowed: Wavelengths", axis));
            }
            in_data = is_mark(content);
            if (!in_data) continue;
            if (options.quantity.empty() && !said) {
                refuse(file, line,
                       "the file does not say what its values are (Reflection, Transmission or "
                       "Absorbance in its first line): say so with the option quantity; they are "
                       "taken as percent");
            }
            if (options.quantity.empty() && !said->refused.empty())
                refuse(file, 1, refusal_of(title, said->refused));
            const bool is_converted = said && said->conversion != Conversion::none;
            if (!is_converted)
                factor = share_factor(list, options, true, "as these programs write");
            else
                list.facts.emplace_back("data", words_of(said->conversion, said->kind.quantity));
            continue;
        }
        const std::vector<std::string> words = materials::split_numbers(content);
        if (nm.empty() && words.front() == "W") {
            columns = words.size();
            of_values = std::size_t(std::find(words.begin(), words.end(), "P") - words.begin());
            if (of_values == columns)
                refuse(file, line, "no column P: no reference was stored, which makes shares");
            continue;
        }
        const bool whole = words.size() == columns;
        const auto x = whole ? measured_number(words[0]) : std::nullopt;
        const auto y = whole ? measured_number(words[of_values]) : std::nullopt;
        if (!x || !y || !(*x > 0.0)) {
            refuse(file, line,
                   fmt::format("'{}': expected a wavelength and a value", content.substr(0, 60)));
        }
        nm.push_back(*x);
        values.push_back(converted(*y, said ? said->conversion : Conversion::none) * factor);
        lines.push_back(line);
    }
    if (nm.empty()) refuse(file, 0, "no values below its line '>>>>>Begin Spectral Data<<<<<'");
    if (pixels && *pixels > double(nm.size())) {
        list.doubts.push_back(fmt::format("{}: {} values; its header says {}: it may be cut off",
                                          file.path, nm.size(), *pixels));
    }
    const MeasuredQuantity quantity = said ? said->kind.quantity : MeasuredQuantity::reflectance;
    add_spectrum(list, title, {quantity, MeasuredGeometry::unknown}, MeasuredValue::kNone, nm,
                 values, lines);
    return list;
}

}  // namespace

extern const Reader kOcean;
constinit const Reader kOcean{{"ocean", "Ocean Optics (.txt, .jaz)"}, looks_like_ocean, read_ocean};

}  // namespace miebrdf::measured
