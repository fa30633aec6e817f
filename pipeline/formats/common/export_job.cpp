#include "pipeline/formats/common/export_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "pipeline/formats/common/rgb_source.h"

namespace miebrdf {
namespace {

int checked(const Format& format, const std::string& field, int value, int lowest, int highest,
            const std::string& unit) {
    if (value >= lowest && value <= highest) return value;
    throw UsageError(field, std::to_string(value),
                     fmt::format("{} to {} ({}: {})", lowest, highest, format.name, unit));
}

}  // namespace

ExportOptions ready_options(const Format& format, const ExportOptions& options) {
    ExportOptions ready = options;
    const Fineness& fineness = format.resolution;
    if (ready.resolution == 0 || fineness.lowest == fineness.highest) {
        ready.resolution = fineness.standard;
    }
    checked(format, "resolution", ready.resolution, fineness.lowest, fineness.highest,
            fineness.unit);
    for (const FormatOption& option : format.extra) {
        const auto [given, missing] = ready.extra.emplace(option.name, option.standard);
        checked(format, option.name, given->second, option.lowest, option.highest, option.help);
    }
    for (const auto& [name, value] : options.extra) {
        const auto has_name = [&name = name](const FormatOption& o) { return o.name == name; };
        if (std::none_of(format.extra.begin(), format.extra.end(), has_name)) {
            throw UsageError(fmt::format("format '{}' has no option '{}'", format.name, name));
        }
    }
    return ready;
}

std::uintmax_t expected_bytes(const Format& format, const ExportOptions& options,
                              std::size_t wavelengths) {
    if (format.expected_bytes == nullptr) return 0;
    return format.expected_bytes(ready_options(format, options), wavelengths);
}

void write_format(const Format& format, const FormatFile& file, const BrdfSource& source,
                  const ExportOptions& options, std::ostream& out, const Control& control) {
    const ExportOptions ready = ready_options(format, options);
    const RgbSource rgb(source, colours_of(format, ready, source));
    file.write({source, rgb, ready, control}, out);
}

RgbWeights colours_of(const Format& format, const ExportOptions& options,
                      const BrdfSource& source) {
    require_wavelengths(source, format.name);
    return format.takes_colours ? rgb_weights(options.rgb, source.wavelength_nm())
                                : nearest_wavelengths(source.wavelength_nm());
}

nlohmann::ordered_json metadata(const BrdfSource& source, const Conventions& conventions) {
    const Provenance& origin = source.provenance();
    nlohmann::ordered_json json;
    json["generator"] = origin.version;
    json["command"] = origin.command_line;
    json["title"] = origin.title;
    json["component"] = origin.component;
    json["format"] = conventions.format;
    const bool passes = origin.component == "transmitted";
    json["quantity"] =
        passes ? "BTDF: mu_out is the cosine on the far side, azimuth 0 goes straight on" : "BRDF";
    json["units"] = "1/sr";
    json["cosine"] =
        conventions.cosine_included ? "stored values are BRDF times cosine" : "not included";
    json["azimuth_zero"] = conventions.azimuth_zero;
    json["isotropic"] = true;
    if (source.wavelength_nm().empty()) {
        json["channels"] = source.channels();
    } else {
        json["wavelength_nm"] = source.wavelength_nm();
    }
    if (source.components() > 1) {
        json["mueller"] = fmt::format(
            "row = outgoing, column = incident component of ({}), Q = parallel minus "
            "perpendicular to the meridian plane of each ray (ray and normal); signs: "
            "docs/polarisation.md",
            source.components() == 4 ? "I, Q, U, V" : "I, Q, U");
    }
    if (!origin.polarisation.empty()) json["polarisation"] = origin.polarisation;
    if (!conventions.colour.empty()) json["colour"] = conventions.colour;
    if (!origin.accuracy.empty()) json["accuracy"] = origin.accuracy;
    if (!origin.left_out.empty()) json["left_out"] = origin.left_out;
    json["sources"] = origin.sources;
    return json;
}

std::string one_line(std::string text) {
    for (char& c : text) {
        if (c == '\n' || c == '\r') c = ' ';
    }
    return text;
}

std::string in_xml_comment(std::string text) {
    for (std::size_t at; (at = text.find("--")) != text.npos;) text.replace(at, 2, "- -");
    return text;
}

}  // namespace miebrdf
