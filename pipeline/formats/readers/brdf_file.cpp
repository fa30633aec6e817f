#include "pipeline/formats/readers/brdf_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include <miebrdf/error.h>

namespace miebrdf::exports {
namespace {

/// Files are read whole; nothing that we write comes near.
constexpr std::uintmax_t kLargestFile = std::uintmax_t{4} << 30;

struct Format {
    bool (*recognises)(std::string_view);
    std::unique_ptr<BrdfFile> (*read)(std::string);
};

/// Formats with an unmistakable beginning first.
constexpr Format kFormats[] = {
    {looks_like_pbrt, read_pbrt}, {looks_like_rgl, read_rgl},
    {looks_like_exr, read_exr},   {looks_like_npz, read_npz},
    {looks_like_merl, read_merl}, {looks_like_radiance, read_radiance},
    {looks_like_json, read_json}, {looks_like_ssdd, read_ssdd},
    {looks_like_astm, read_astm}, {looks_like_csv, read_csv},
};

/// Messages may quote the file: nothing of it may reach a terminal as a control sequence.
std::string printable(std::string text) {
    for (char& c : text) {
        if (c < ' ' || c > '~') c = '?';
    }
    return text;
}

}  // namespace

std::optional<Direction> BrdfFile::sample(double, double, double) const { return {}; }

double BrdfFile::density(const Direction&) const { return 0.0; }

std::unique_ptr<BrdfFile> read_brdf_file(std::string content, const std::string& name) {
    for (const Format& format : kFormats) {
        if (!format.recognises(content)) continue;
        try {
            return format.read(std::move(content));
        } catch (const InputError& error) {
            throw InputError(fmt::format("'{}': {}", name, printable(error.what())));
        }
    }
    throw InputError(
        fmt::format("'{}' is no BRDF file of a known format (csv, json, npz, exr, pbrt, "
                    "rgl, merl, ssdd, astm, radiance)",
                    name));
}

std::unique_ptr<BrdfFile> open_brdf_file(const std::string& path) {
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
    return read_brdf_file(std::move(content), path);
}

}  // namespace miebrdf::exports
