// ENVI spectral libraries: a header of text (.hdr) and a binary file of as many spectra as `lines`
// says, with `samples` channels each. Either of the two may be named.
// https://www.nv5geospatialsoftware.com/docs/ENVIHeaderFiles.html
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>

#include "materials/index/units.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/columns.h"
#include "pipeline/measured/sheet.h"

namespace miebrdf::measured {
namespace {

namespace fs = std::filesystem;

bool is_header(std::string_view text) {
    return text.starts_with("ENVI") && text.find('=') != std::string_view::npos;
}

/// The header beside a binary file: NAME.sli.hdr or NAME.hdr. Empty: none.
fs::path header_of(const std::string& path) {
    for (const fs::path& header :
         {fs::path(path + ".hdr"), fs::path(path).replace_extension("hdr")}) {
        std::error_code ignored;
        if (header != path && fs::is_regular_file(header, ignored) &&
            is_header(materials::read_bytes(header)))
            return header;
    }
    return {};
}

/// The binary file beside a header. Empty: none.
fs::path data_of(const std::string& header) {
    const std::string stem = fs::path(header).replace_extension("").string();
    for (const char* suffix : {"", ".sli", ".esl", ".lib", ".dat", ".img", ".bin"}) {
        std::error_code ignored;
        if (fs::is_regular_file(stem + suffix, ignored)) return stem + suffix;
    }
    return {};
}

bool looks_like_envi(const MeasuredFile& file) {
    const std::string ending = materials::lower_case(fs::path(file.path).extension().string());
    const bool is_binary = ending == ".sli" || ending == ".esl" ||
                           file.content.substr(0, 4096).find('\0') != std::string_view::npos;
    return is_header(file.content) || (is_binary && !header_of(file.path).empty());
}

/// "key = value", with values in braces over several lines.
std::map<std::string, std::string> fields_of(std::string_view text) {
    std::map<std::string, std::string> fields;
    std::string key, value;
    bool open = false;
    for (const std::string_view line : materials::split_lines(text)) {
        if (!open) {
            const std::size_t mark = line.find('=');
            if (mark == std::string_view::npos) continue;
            key = materials::lower_case(line.substr(0, mark));
            value = materials::without_blanks(line.substr(mark + 1));
            open = value.starts_with('{');
        } else {
            value += line;
        }
        if (open && line.find('}') == std::string::npos) continue;
        if (open) value = value.substr(1, value.find('}') - 1);
        open = false;
        fields[key] = materials::without_blanks(value);
    }
    return fields;
}

template <typename Number>
double number_at(std::string_view bytes, std::size_t index, bool big_endian) {
    char part[sizeof(Number)];
    std::memcpy(part, bytes.data() + index * sizeof(Number), sizeof(Number));
    if (big_endian != (std::endian::native == std::endian::big))
        std::reverse(part, part + sizeof(Number));
    Number number;
    std::memcpy(&number, part, sizeof number);
    return double(number);
}

struct NumberType {
    int code;
    std::size_t size;
    double (*at)(std::string_view bytes, std::size_t index, bool big_endian);
};
constexpr NumberType kTypes[] = {
    {1, 1, number_at<std::uint8_t>},   {2, 2, number_at<std::int16_t>},
    {3, 4, number_at<std::int32_t>},   {4, 4, number_at<float>},
    {5, 8, number_at<double>},         {12, 2, number_at<std::uint16_t>},
    {13, 4, number_at<std::uint32_t>},
};

Measurements read_envi(const MeasuredFile& file, const MeasuredOptions& options) {
    const bool named_header = is_header(file.content);
    const fs::path other_path = named_header ? data_of(file.path) : header_of(file.path);
    if (other_path.empty()) {
        refuse(file, 0,
               named_header ? "no binary file (.sli) beside it" : "no header (.hdr) beside it");
    }
    const std::string other = materials::read_bytes(other_path);
    const std::string_view bytes = named_header ? std::string_view(other) : file.content;
    auto fields = fields_of(named_header ? file.content : std::string_view(other));
    const auto number = [&](const char* name, double otherwise) {
        if (fields.count(name) == 0) return otherwise;
        const auto value = materials::parse_number(fields[name]);
        if (value && std::isfinite(*value)) return *value;
        refuse(file, 0,
               fmt::format("'{}' = '{}' is not a number", name, fields[name].substr(0, 40)));
    };
    const std::string type = materials::lower_case(fields["file type"]);
    if (type.find("spectral library") == std::string::npos)
        refuse(
            file, 0,
            fmt::format("an ENVI file of type '{}'; allowed: ENVI Spectral Library. Of an image, "
                        "save the spectra of regions as a library",
                        type));
    const double samples = number("samples", 0.0), lines = number("lines", 0.0),
                 offset = number("header offset", 0.0), code = number("data type", 4.0);
    const auto* kind = std::find_if(std::begin(kTypes), std::end(kTypes),
                                    [&](const NumberType& t) { return double(t.code) == code; });
    const bool whole = samples == std::floor(samples) && lines == std::floor(lines);
    if (!(samples >= 1.0 && lines >= 1.0 && offset >= 0.0 && whole &&
          samples * lines <= double(materials::ReadingBudget::kValues)) ||
        kind == std::end(kTypes) || number("bands", 1.0) != 1.0) {
        refuse(file, 0,
               fmt::format("{} spectra of {} channels, data type {}; allowed: whole numbers, up to "
                           "{} values, types 1 to 5, 12, 13, one band",
                           lines, samples, code, materials::ReadingBudget::kValues));
    }
    const auto channels = std::size_t(samples), spectra = std::size_t(lines);
    const double size = offset + samples * lines * double(kind->size);
    if (!(double(bytes.size()) >= size))
        refuse(file, 0, fmt::format("{} bytes of numbers; its header says {}", bytes.size(), size));
    const std::string_view numbers = bytes.substr(std::size_t(offset));
    std::vector<double> nm;
    for (const std::string_view word : materials::split_words(fields["wavelength"], " ,\t")) {
        const auto x = materials::parse_number(word);
        if (!x || !(*x > 0.0)) refuse(file, 0, fmt::format("wavelength '{}'", word));
        nm.push_back(*x);
    }
    if (nm.size() != channels)
        refuse(file, 0, fmt::format("{} wavelengths for {} channels", nm.size(), channels));
    const auto said = materials::parse_unit(materials::lower_case(fields["wavelength units"]));
    const bool is_nm = *std::max_element(nm.begin(), nm.end()) >= kLeastNm;
    const auto unit =
        said.value_or(is_nm ? materials::Unit::nanometre : materials::Unit::micrometre);
    for (double& x : nm) x = materials::to_nm(x, unit);
    Measurements list;
    list.facts.emplace_back("wavelengths", fmt::format("{}{}", materials::name_of(unit),
                                                       said ? "" : ", as their size tells"));
    const std::string titles = fields["z plot titles"];
    const std::string title = titles.substr(std::min(titles.find(',') + 1, titles.size()));
    const ValueMeaning meaning = value_meaning(title).value_or(ValueMeaning{});
    if (!meaning.refused.empty() && options.quantity.empty())
        refuse(file, 0, refusal_of(title, meaning.refused));
    // "reflectance [*10000]"
    const std::size_t star = std::min(title.find('*'), title.size()),
                      end = title.find_first_not_of("0123456789", std::min(star + 1, title.size()));
    const auto in_title = materials::parse_number(title.substr(
        std::min(star + 1, title.size()), end == std::string::npos ? end : end - star - 1));
    const double scale = number("reflectance scale factor", in_title.value_or(1.0)),
                 ignored = number("data ignore value", MeasuredValue::kNone);
    if (!(scale > 0.0)) refuse(file, 0, fmt::format("reflectance scale factor {}", scale));
    const double factor = share_factor(list, options, says_percent(title), "z plot titles") / scale;
    const auto names = materials::split_fields(fields["spectra names"]);
    const bool big = number("byte order", 0.0) == 1.0;
    for (std::size_t s = 0; s < spectra; ++s) {
        std::vector<double> values;
        for (std::size_t c = 0; c < channels; ++c) {
            const double x = kind->at(numbers, s * channels + c, big);
            values.push_back(x == ignored || is_fill(x)
                                 ? MeasuredValue::kNone
                                 : converted(x * factor, meaning.conversion));
        }
        const bool named = s < names.size() && !names[s].empty();
        add_spectrum(list, named ? materials::as_utf8(names[s]) : fmt::format("spectrum {}", s + 1),
                     meaning.kind, MeasuredValue::kNone, nm, values);
    }
    return list;
}

}  // namespace

extern const Reader kEnvi;
constinit const Reader kEnvi{
    {"envi", "ENVI spectral libraries (.hdr, .sli)"}, looks_like_envi, read_envi};

}  // namespace miebrdf::measured
