// The list of formats, and files of all of them by their content.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <miebrdf/brdf_source.h>
#include <miebrdf/formats.h>
#include "materials/database/names.h"

// One line for each format; NAME_format() is in the room of that format.
#define MIEBRDF_FORMATS(FORMAT) \
    FORMAT(csv)                 \
    FORMAT(json)                \
    FORMAT(npz)                 \
    FORMAT(exr)                 \
    FORMAT(pbrt)                \
    FORMAT(pbsdf)               \
    FORMAT(rgl)                 \
    FORMAT(merl)                \
    FORMAT(ssdd)                \
    FORMAT(astm)                \
    FORMAT(radiance)            \
    FORMAT(klems)               \
    FORMAT(mtlx)                \
    FORMAT(spd)                 \
    FORMAT(irregular)           \
    FORMAT(scattering)

namespace miebrdf {

#define MIEBRDF_DECLARE(name) Format name##_format();
MIEBRDF_FORMATS(MIEBRDF_DECLARE)
#undef MIEBRDF_DECLARE

std::span<const Format> all_formats() {
#define MIEBRDF_ENTRY(name) name##_format(),
    static const std::vector<Format> formats = {MIEBRDF_FORMATS(MIEBRDF_ENTRY)};
#undef MIEBRDF_ENTRY
    return formats;
}

namespace {

/// Files are read whole; nothing that we write comes near.
constexpr std::uintmax_t kLargestFile = std::uintmax_t{4} << 30;

/// Messages may quote the file: nothing of it may reach a terminal as a control sequence.
std::string printable(std::string text) {
    for (char& c : text) {
        if (c < ' ' || c > '~') c = '?';
    }
    return text;
}

std::vector<std::string> names_of(std::span<const Format> formats) {
    std::vector<std::string> names;
    for (const Format& format : formats) names.push_back(format.name);
    return names;
}

/// The one that is surest, of equals the first; null when none is.
const Format* recognise(std::string_view content, std::span<const Format> known) {
    const Format* best = nullptr;
    Recognised surest = Recognised::no;
    for (const Format& format : known) {
        if (format.reader.recognise == nullptr) continue;
        const Recognised recognised = format.reader.recognise(content);
        if (recognised <= surest) continue;
        surest = recognised;
        best = &format;
    }
    return best;
}

}  // namespace

const Format& find_format(std::string_view name, std::span<const Format> known) {
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const Format& f) { return f.name == name; });
    if (found != known.end()) return *found;
    constexpr std::size_t kMostSuggestions = 3;
    const std::vector<std::string> names = names_of(known);
    const auto nearest = materials::nearest_names(std::string(name), names, kMostSuggestions);
    throw UsageError(fmt::format(
        "unknown format '{}'; allowed: {}{}", name, fmt::join(names, ", "),
        nearest.empty() ? "" : fmt::format("; did you mean {}?", fmt::join(nearest, " or "))));
}

std::string left_out_of(const Format& format, const Provenance& origin) {
    if (!format.holds_mirror || origin.mirror_index == 0.0) return origin.left_out;
    const std::size_t others = origin.left_out.find("; ");
    return others == std::string::npos ? "" : origin.left_out.substr(others + 2);
}

std::vector<std::string> options_of(const Format& format) {
    std::vector<std::string> names;
    if (format.takes_directions) names = {"mu_in", "mu_out", "azimuth_deg"};
    if (format.resolution.lowest < format.resolution.highest) names.emplace_back("resolution");
    for (const FormatOption& option : format.extra) names.push_back(option.name);
    if (format.takes_colours) names.emplace_back("rgb");
    if (format.content == FormatContent::sampled) {
        names.emplace_back("largest_error");
        names.emplace_back("accept_error");
    }
    return names;
}

void BrdfFile::evaluate(const Direction& direction, std::span<double> values) const {
    std::vector<Direction> storage;
    look_up(require_valid({&direction, 1}, values.size(), channels().size(), storage)[0], values);
}

void BrdfFile::evaluate_mueller(const Direction& direction, std::span<double> values) const {
    const auto elements = std::size_t(components() * components());
    std::vector<Direction> storage;
    look_up_mueller(
        require_valid({&direction, 1}, values.size(), channels().size() * elements, storage)[0],
        values);
}

std::optional<Direction> BrdfFile::sample(double, double, double) const { return {}; }

double BrdfFile::density(const Direction&) const { return 0.0; }

std::unique_ptr<BrdfFile> read_brdf_file(std::string content, const std::string& name,
                                         std::span<const Format> known) {
    const Format* format = recognise(content, known);
    if (format == nullptr) {
        std::vector<std::string> names;
        for (const Format& one : known) {
            if (one.reader.recognise != nullptr) names.push_back(one.name);
        }
        throw InputError(fmt::format("'{}' is no BRDF file of a known format ({})", name,
                                     fmt::join(names, ", ")));
    }
    try {
        return format->reader.read(std::move(content));
    } catch (const InputError& error) {
        throw InputError(fmt::format("'{}': {}", name, printable(error.what())));
    }
}

std::unique_ptr<BrdfFile> open_brdf_file(const std::string& path, std::span<const Format> known) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) throw InputError(fmt::format("'{}' cannot be read: {}", path, error.message()));
    if (size > kLargestFile) {
        throw InputError(
            fmt::format("'{}' has {} bytes; allowed: at most {}", path, size, kLargestFile));
    }
    std::string content(size, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(content.data(), static_cast<std::streamsize>(size));
    if (!file) throw InputError(fmt::format("'{}' cannot be read", path));
    return read_brdf_file(std::move(content), path, known);
}

}  // namespace miebrdf
