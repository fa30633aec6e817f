#include "pipeline/formats/readers/exr_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include <miebrdf/error.h>

namespace miebrdf::exports {
namespace {

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

}  // namespace

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

}  // namespace miebrdf::exports
