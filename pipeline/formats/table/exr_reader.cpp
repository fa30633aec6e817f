// Spectral OpenEXR tables of ours: channels by wavelength, directions from attributes.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>

#include "pipeline/formats/common/grid_file.h"
#include "pipeline/io/exr_file.h"

namespace miebrdf {
namespace {

/// A compressed image of one value can be a thousand times smaller than itself; more is an attack.
constexpr std::uint64_t kLargestExpansion = 2048;

std::uint32_t little_endian(std::string_view content, std::size_t position) {
    std::uint32_t value = 0;
    for (int byte = 3; byte >= 0; --byte) {
        value = value << 8 | static_cast<unsigned char>(content[position + std::size_t(byte)]);
    }
    return value;
}

/// Lines and offsets are allocated for the whole window when the file is opened.
void check_window(std::string_view content, std::size_t position) {
    const auto coordinate = [&](std::size_t which) {
        return std::int64_t{
            static_cast<std::int32_t>(little_endian(content, position + 4 * which))};
    };
    const std::int64_t width = coordinate(2) - coordinate(0) + 1;
    const std::int64_t height = coordinate(3) - coordinate(1) + 1;
    const auto largest =
        static_cast<std::int64_t>(kLargestExpansion * content.size() / sizeof(float));
    if (width < 1 || height < 1 || width > largest / height) {
        throw InputError(fmt::format("exr: a window of {} x {} pixels in a file of {} bytes", width,
                                     height, content.size()));
    }
}

/// OpenEXR reads types of one size, and channels up to an empty name, whatever size is claimed;
/// what follows must not be taken for something else. Other types than these are in no
/// file of ours.
bool fits_type(std::string_view type, std::string_view value) {
    static const std::map<std::string_view, std::size_t> sizes = {
        {"box2i", 16},      {"box2f", 16},   {"chromaticities", 32},
        {"compression", 1}, {"double", 8},   {"envmap", 1},
        {"float", 4},       {"int", 4},      {"keycode", 28},
        {"lineOrder", 1},   {"m33f", 36},    {"m44f", 64},
        {"rational", 8},    {"timecode", 8}, {"v2f", 8},
        {"v2i", 8},         {"v3f", 12},     {"v3i", 12}};
    if (const auto known = sizes.find(type); known != sizes.end()) {
        return value.size() == known->second;
    }
    if (type == "chlist") {
        constexpr std::size_t channel = 16;  // behind its name
        while (!value.empty() && value.front() != '\0') {
            const std::size_t end = value.find('\0');
            if (end == std::string_view::npos || value.size() - end - 1 < channel) return false;
            value.remove_prefix(end + 1 + channel);
        }
        return value.size() == 1;
    }
    if (type == "floatvector") return value.size() % sizeof(float) == 0;
    return type == "string";
}

/// Checks what the header claims before the library believes it: it is a list of name, type, size
/// and that many bytes, up to an empty name. OpenEXR allocates what a size claims before it reads:
/// sizes beyond the file are refused here. Files of several parts, which have several headers, are
/// none of ours.
void check_exr_header(std::string_view content) {
    constexpr unsigned char kDeepOrParts = 0x18;  // bits 11 and 12 of the version
    if (content.size() < 8 || (static_cast<unsigned char>(content[5]) & kDeepOrParts) != 0) {
        throw InputError("exr: not an image of one flat part");
    }
    std::size_t position = 8;  // magic number and version
    const auto word = [&] {
        const std::size_t end = content.find('\0', std::min(position, content.size()));
        if (end == std::string_view::npos) throw InputError("exr: the header ends early");
        const std::string_view found = content.substr(position, end - position);
        position = end + 1;
        return found;
    };
    for (std::string_view name = word(); !name.empty(); name = word()) {
        const std::string_view type = word();
        if (content.size() - position < 4) throw InputError("exr: the header ends early");
        const std::uint32_t size = little_endian(content, position);
        position += 4;
        if (size > content.size() - position) {
            throw InputError(fmt::format("exr: attribute '{}' claims {} bytes of the {} left", name,
                                         size, content.size() - position));
        }
        if (!fits_type(type, content.substr(position, size))) {
            throw InputError(
                fmt::format("exr: attribute '{}' of type '{}' has {} bytes", name, type, size));
        }
        if (name == "dataWindow" && size == 16) check_window(content, position);
        position += size;
    }
}

std::vector<double> list_attribute(const ExrReader& file, const char* name) {
    const auto list = file.list(name);
    if (!list) throw InputError(fmt::format("exr: no attribute '{}'", name));
    return {list->begin(), list->end()};
}

/// Values are the BRDF times this: pi in reflectance factors; 1 where nothing is said, as in
/// files of before.
double brdf_factor(const ExrReader& file) {
    const double factor = file.number("brdf_factor").value_or(1.0);
    if (!(factor > 0.0 && std::isfinite(factor)))
        throw InputError(fmt::format("exr: brdf_factor is {}; allowed: > 0", factor));
    return factor;
}

/// Wavelength of T.550,000000nm; 0 for other channels.
double wavelength_of(const std::string& channel) {
    if (!channel.starts_with("T.") || !channel.ends_with("nm")) return 0.0;
    std::string number = channel.substr(2, channel.size() - 4);
    std::replace(number.begin(), number.end(), ',', '.');
    double value = 0.0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    return error == std::errc() && end == number.data() + number.size() ? value : 0.0;
}

GridTable read_table(std::string_view content) {
    check_exr_header(content);
    const ExrReader file(content);
    GridTable table;
    table.format = "exr";
    table.in = list_attribute(file, "mu_in");
    table.out = list_attribute(file, "mu_out");
    table.azimuth_deg = list_attribute(file, "azimuth_deg");
    std::vector<std::pair<double, std::string>> spectral;
    for (const std::string& channel : file.channels()) {
        const double wavelength = wavelength_of(channel);
        if (wavelength > 0) spectral.emplace_back(wavelength, channel);
    }
    std::sort(spectral.begin(), spectral.end());
    const std::int64_t width = file.width(), height = file.height();
    if (!file.begins_at_origin() || width != static_cast<std::int64_t>(table.azimuth_deg.size()) ||
        height != static_cast<std::int64_t>(table.in.size() * table.out.size())) {
        throw InputError("exr: the image does not fit the attributes mu_in, mu_out, azimuth_deg");
    }
    const auto pixels = static_cast<std::uint64_t>(width * height);
    if (pixels * spectral.size() * sizeof(float) > kLargestExpansion * content.size()) {
        throw InputError(fmt::format("exr: {} x {} x {} values in a file of {} bytes", width,
                                     height, spectral.size(), content.size()));
    }
    std::vector<float> values(pixels * spectral.size());
    std::vector<ExrPlane<float>> planes;
    for (std::size_t c = 0; c < spectral.size(); ++c) {
        table.wavelength_nm.push_back(spectral[c].first);
        planes.push_back({spectral[c].second, &values[c * pixels], 1, std::size_t(width)});
    }
    file.read(planes);
    table.count = values.size();
    table.value = [values = std::move(values), factor = brdf_factor(file)](std::size_t i) {
        return double(values[i]) / factor;
    };
    return table;
}

Recognised recognise_exr(std::string_view content) {
    return content.starts_with("\x76\x2f\x31\x01") ? Recognised::by_first_bytes : Recognised::no;
}

std::unique_ptr<BrdfFile> read_exr(std::string content) {
    try {
        return make_grid_file(read_table(content));
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {  // OpenEXR's own
        throw InputError(fmt::format("exr: {}", error.what()));
    }
}

}  // namespace

FormatReader exr_reader() { return {recognise_exr, read_exr}; }

}  // namespace miebrdf
