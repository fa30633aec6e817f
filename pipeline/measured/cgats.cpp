// CGATS.17 text: tables of samples between BEGIN_DATA and END_DATA, as programs for colour
// measurement write them (i1Profiler, ArgyllCMS, ColorPort): spectra and Lab.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "materials/index/units.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/columns.h"
#include "pipeline/measured/sheet.h"

namespace miebrdf::measured {
namespace {

using materials::lower_case;

/// Words of a line; quoted ones keep their blanks.
std::vector<std::string> cgats_words(std::string_view line) {
    std::vector<std::string> words;
    std::string word;
    bool quoted = false, any = false;
    const auto end = [&] {
        if (any) words.push_back(word);
        word.clear();
        any = false;
    };
    for (const char c : line) {
        if (c == '"') {
            quoted = !quoted;
            any = true;
        } else if (!quoted && c == '#') {
            break;
        } else if (!quoted && (c == ' ' || c == '\t')) {
            end();
        } else {
            word += c;
            any = true;
        }
    }
    end();
    return words;
}

struct CgatsTable {
    std::vector<std::string> fields;
    std::vector<std::pair<int, std::vector<std::string>>> rows;
    std::vector<std::pair<std::string, std::string>> keywords;

    std::string keyword(std::string_view name) const {
        for (const auto& [known, value] : keywords) {
            if (known == name) return value;
        }
        return {};
    }
};

CgatsTable parse_cgats(const MeasuredFile& file) {
    CgatsTable table;
    enum { kHeader, kFields, kData } part = kHeader;
    bool ended = false;
    int line = 0;
    std::size_t sets = 0, cells = 0;
    for (const std::string_view text : materials::split_lines(file.content)) {
        ++line;
        const std::vector<std::string> words = cgats_words(text);
        if (words.empty()) continue;
        materials::ReadingBudget::require_values(cells += words.size(), file.path, line);
        if (words[0] == "BEGIN_DATA_FORMAT") {
            if (ended) break;  // a second table
            part = kFields;
        } else if (words[0] == "END_DATA_FORMAT" || words[0] == "END_DATA") {
            ended = ended || (part == kData && words[0] == "END_DATA");
            part = kHeader;
        } else if (words[0] == "BEGIN_DATA") {
            if (ended) break;
            part = kData;
        } else if (part == kFields) {
            table.fields.insert(table.fields.end(), words.begin(), words.end());
        } else if (part == kData) {
            if (words.size() != table.fields.size()) {
                refuse(file, line,
                       fmt::format("{} fields; BEGIN_DATA_FORMAT names {}", words.size(),
                                   table.fields.size()));
            }
            table.rows.emplace_back(line, words);
        } else if (words.size() > 1 && !ended) {
            std::string value = words[1];
            for (std::size_t i = 2; i < words.size(); ++i) value += " " + words[i];
            if (words[0] == "NUMBER_OF_SETS")
                sets = static_cast<std::size_t>(materials::parse_number(value).value_or(0.0));
            table.keywords.emplace_back(words[0], value);
        }
    }
    if (!ended || table.fields.empty())
        refuse(file, 0, "no END_DATA, or no BEGIN_DATA_FORMAT: the file is cut off");
    if (sets != 0 && sets != table.rows.size()) {
        refuse(file, 0, fmt::format("{} rows; NUMBER_OF_SETS says {}", table.rows.size(), sets));
    }
    return table;
}

/// The value that spectral values are relative to: SPECTRAL_NORM says it; ArgyllCMS (SPEC_400) has
/// percent, others (SPECTRAL_NM400, nm400) shares.
double cgats_norm(const MeasuredFile& file, const CgatsTable& table, const std::string& field) {
    const std::string norm = table.keyword("SPECTRAL_NORM");
    if (norm.empty()) return lower_case(field).starts_with("spec_") ? 100.0 : 1.0;
    const auto value = materials::parse_number(norm);
    if (!value || !(*value > 0.0))
        refuse(file, 0, fmt::format("SPECTRAL_NORM '{}'; allowed: above 0", norm));
    return *value;
}

/// What the file says of the measurement: reflective, transmissive, or light of a source, of which
/// no share can be made. ArgyllCMS: MEAS_TYPE and DEVICE_CLASS.
ValueMeaning cgats_meaning(const MeasuredFile& file, const CgatsTable& table,
                           const MeasuredOptions& options) {
    ValueMeaning meaning;
    for (const char* keyword : {"MEAS_TYPE", "DEVICE_CLASS", "MEASUREMENT_TYPE"}) {
        const std::string word = table.keyword(keyword), text = lower_case(word);
        const auto has = [&](std::string_view part) {
            return text.find(part) != std::string::npos;
        };
        if (has("transm")) {
            meaning.kind.quantity = MeasuredQuantity::transmittance;
        } else if (has("emis") || has("ambient") || has("flash") || has("display") ||
                   has("sensitivity") || has("radian") || has("light")) {
            meaning.refused = "light of a source";
        }
        if (!meaning.refused.empty() && options.quantity.empty())
            refuse(file, 0, refusal_of(std::string(keyword) + " " + word, meaning.refused));
    }
    return meaning;
}

bool looks_like_cgats(const MeasuredFile& file) {
    return file.content.find("BEGIN_DATA_FORMAT") != std::string_view::npos;
}

Measurements read_cgats(const MeasuredFile& file, const MeasuredOptions& options) {
    const CgatsTable table = parse_cgats(file);
    const ValueMeaning meaning = cgats_meaning(file, table, options);
    const bool transmitted = meaning.kind.quantity == MeasuredQuantity::transmittance;
    Measurements list;
    NamedGeometry geometry;
    for (const char* name : {"MEASUREMENT_GEOMETRY", "GEOMETRY", "MEASUREMENT_SOURCE",
                             "INSTRUMENTATION", "DESCRIPTOR"}) {
        const std::string words = table.keyword(name);
        if (!words.empty()) list.facts.emplace_back(lower_case(name), words);
        if (geometry.geometry == MeasuredGeometry::unknown) geometry = geometry_in(words);
    }
    std::vector<std::pair<std::size_t, double>> spectral;  // field, nm
    std::array<std::ptrdiff_t, 3> lab{-1, -1, -1};
    std::vector<std::size_t> names;
    for (std::size_t f = 0; f < table.fields.size(); ++f) {
        const std::string field = lower_case(table.fields[f]);
        const auto place = static_cast<std::ptrdiff_t>(f);
        if (const auto nm = wavelength_in_name(field)) spectral.emplace_back(f, *nm);
        if (field == "lab_l") lab[0] = place;
        if (field == "lab_a") lab[1] = place;
        if (field == "lab_b") lab[2] = place;
        if (field == "sample_name" || field == "sample_id" || field == "sampleid" ||
            field == "sample_loc")
            names.push_back(f);
    }
    if (spectral.empty() && (lab[0] < 0 || transmitted)) {
        refuse(file, 0,
               fmt::format("neither spectra nor Lab; the fields are {} ...", table.fields.front()));
    }
    double factor = 1.0;
    if (!spectral.empty()) {
        const double norm = cgats_norm(file, table, table.fields[spectral.front().first]);
        factor = share_factor(list, options, norm == 100.0, "spectra relative to 100");
        if (norm != 100.0 && !options.percent) factor = 1.0 / norm;
    }
    for (const auto& numbered : table.rows) {
        const int line = numbered.first;
        const std::vector<std::string>& row = numbered.second;
        std::string name;
        for (const std::size_t f : names) name += (name.empty() ? "" : " ") + row[f];
        if (name.empty()) name = fmt::format("row {}", list.samples.size() + 1);
        const auto number = [&](const std::string& text) {
            const auto value = measured_number(text);
            if (!value) refuse(file, line, fmt::format("'{}' is not a number", text));
            return *value;
        };
        std::vector<double> nm, values;
        for (const auto& [f, wavelength] : spectral) {
            nm.push_back(wavelength);
            values.push_back(number(row[f]) * factor);
        }
        MeasuredKind kind = meaning.kind;
        if (!transmitted) kind.geometry = geometry.geometry;
        if (kind.geometry == MeasuredGeometry::d45_0)
            kind.quantity = MeasuredQuantity::reflectance_factor;
        add_spectrum(list, name, kind, transmitted ? MeasuredValue::kNone : geometry.mu_in, nm,
                     values, std::vector<int>(nm.size(), line));
        // Lab of transmitted light is no colour of a surface.
        if (transmitted || lab[0] < 0 || lab[1] < 0 || lab[2] < 0) continue;
        const auto at = [&](std::size_t c) {
            return number(row[static_cast<std::size_t>(lab[c])]);
        };
        add_lab(list, geometry.geometry, {at(0), at(1), at(2)}, line);
    }
    return list;
}

}  // namespace

extern const Reader kCgats;
constinit const Reader kCgats{{"cgats", "CGATS (.txt, .ti3)"}, looks_like_cgats, read_cgats};

}  // namespace miebrdf::measured
