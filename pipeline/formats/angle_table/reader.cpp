// Tables over listed angles: SSDD (as libbsdf reads it) and ASTM E1392.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>

#include "pipeline/formats/common/byte_reader.h"
#include "pipeline/formats/common/grid_file.h"
#include "pipeline/formats/common/text_lines.h"

namespace miebrdf {
namespace {

constexpr double kDegreesOfRadian = 180.0 / std::numbers::pi;

/// Entries of the header up to DATA, which is the last.
std::map<std::string, std::string> read_ssdd_header(TextLines& lines) {
    std::map<std::string, std::string> entries;
    for (std::string_view line; lines.next(line);) {
        if (line.empty() || line[0] == '#') continue;
        const std::size_t space = std::min(line.find(' '), line.size());
        const std::string name(line.substr(0, space));
        entries[name] = line.substr(std::min(space + 1, line.size()));
        if (name == "DATA") return entries;
    }
    throw InputError("ssdd: no entry DATA");
}

void require(const std::map<std::string, std::string>& entries, const char* name,
             std::string_view wanted) {
    const auto found = entries.find(name);
    const std::string value = found == entries.end() ? "nothing" : found->second;
    if (value != wanted)
        throw InputError(fmt::format("ssdd: {} is '{}'; only '{}' is read", name, value, wanted));
}

/// Reads as many numbers from text.
std::vector<double> text_values(TextLines& lines, std::size_t count) {
    std::vector<double> values;
    for (std::string_view line; lines.next(line) && values.size() < count;) {
        if (line.empty() || line[0] == '#') continue;
        const std::vector<double> row = lines.numbers(line, " \t");
        values.insert(values.end(), row.begin(), row.end());
    }
    if (values.size() != count)
        throw InputError(fmt::format("ssdd: {} values; expected {}", values.size(), count));
    return values;
}

Recognised recognise_ssdd(std::string_view content) {
    const bool found = content.starts_with("VERSION ") &&
                       content.substr(0, 1 << 20).find("\nDATA_TYPE ") != content.npos;
    return found ? Recognised::by_first_bytes : Recognised::no;
}

std::unique_ptr<BrdfFile> read_ssdd(std::string whole) {
    const auto content = std::make_shared<const std::string>(std::move(whole));
    TextLines lines(*content, "ssdd");
    const auto entries = read_ssdd_header(lines);
    require(entries, "DATA_TYPE", "brdf");
    require(entries, "COLOR_MODEL", "spectrum");
    require(entries, "PARAM_TYPE", "spherical_coordinate_system");
    const auto list = [&](const char* name) {
        const auto found = entries.find(name);
        return found == entries.end() ? std::vector<double>() : lines.numbers(found->second, " \t");
    };
    if (list("PARAM1_LIST").size() > 1) throw InputError("ssdd: anisotropic data are not read");
    GridTable table;
    table.format = "ssdd";
    table.elevation = Elevation::angle_deg;
    table.wavelength_nm = list("WAVELENGTH_LIST");
    table.in = list("PARAM0_LIST");
    table.out = list("PARAM2_LIST");
    const std::vector<double> azimuths = list("PARAM3_LIST");  // 0 = towards the source
    for (auto azimuth = azimuths.rbegin(); azimuth != azimuths.rend(); ++azimuth) {
        table.azimuth_deg.push_back(180.0 - *azimuth);
    }
    const std::size_t w = table.wavelength_nm.size(), i = table.in.size(), o = table.out.size(),
                      a = azimuths.size();
    std::uint64_t count = 1;
    for (const std::size_t extent : {w, i, o, a}) {
        count *= extent;
        if (count > content->size())
            throw InputError("ssdd: the lists announce more values than the file has bytes");
    }
    // Stored by azimuth (from the source, ours runs from the mirror side), outgoing and incident
    // angle, then wavelength.
    const auto stored = [=](std::size_t index) {
        const std::size_t azimuth = a - 1 - index % a, out = index / a % o, in = index / a / o % i;
        return ((azimuth * o + out) * i + in) * w + index / a / o / i;
    };
    table.count = count;
    if (entries.at("DATA") == "binary") {
        ByteReader bytes(lines.rest());
        table.value = [content, stored, floats = bytes.view<float>(count)](std::size_t index) {
            return double(floats[stored(index)]);
        };
    } else {
        table.value = [stored, values = text_values(lines, count)](std::size_t index) {
            return values[stored(index)];
        };
    }
    return make_grid_file(std::move(table));
}

constexpr std::string_view kAstmVariables = "VARS theta_i,phi_i,theta_s,phi_s,";

Recognised recognise_astm(std::string_view content) {
    const bool found = content.substr(0, 1 << 20).find(kAstmVariables) != content.npos;
    return found ? Recognised::by_structure : Recognised::no;
}

std::unique_ptr<BrdfFile> read_astm(std::string content) {
    TextLines lines(content, "astm");
    std::vector<double> wavelengths;
    for (std::string_view line; wavelengths.empty() && lines.next(line);) {
        if (!line.starts_with(kAstmVariables)) continue;
        std::string_view names = line.substr(kAstmVariables.size());
        while (!names.empty()) {
            const std::size_t comma = std::min(names.find(','), names.size());
            std::string_view name = names.substr(0, comma);
            if (!name.ends_with("nm")) lines.refuse("only spectral columns ('550nm') are read");
            wavelengths.push_back(lines.number(name.substr(0, name.size() - 2)));
            names.remove_prefix(std::min(comma + 1, names.size()));
        }
    }
    // Each number takes two bytes at least, whatever the lists announce.
    const auto line_count =
        static_cast<std::size_t>(std::count(content.begin(), content.end(), '\n'));
    GridCollector rows("astm", wavelengths.size(),
                       std::min(line_count, content.size() / 2 / (4 + wavelengths.size())));
    // Angles are rounded in the file; a microdegree tells directions apart.
    const auto degrees = [](double radians) {
        return std::round(radians * kDegreesOfRadian * 1e6) / 1e6;
    };
    for (std::string_view line; lines.next(line);) {
        if (line.empty()) continue;
        const std::vector<double> row = lines.numbers(line, ",");
        if (row.size() != 4 + wavelengths.size()) {
            lines.refuse(fmt::format("{} fields; expected {}", row.size(), 4 + wavelengths.size()));
        }
        rows.add(0.0, degrees(row[0]), degrees(row[2]),
                 degrees(std::numbers::pi - (row[3] - row[1])), std::span(row).subspan(4));
    }
    GridTable table = std::move(rows).table(Elevation::angle_deg);
    table.wavelength_nm = wavelengths;
    return make_grid_file(std::move(table));
}

}  // namespace

FormatReader ssdd_reader() { return {recognise_ssdd, read_ssdd}; }
FormatReader astm_reader() { return {recognise_astm, read_astm}; }

}  // namespace miebrdf
