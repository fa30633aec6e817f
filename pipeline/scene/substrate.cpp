// What lies below the layers in place of a base: from words, and back.
#include <fmt/format.h>
#include <miebrdf/error.h>
#include <miebrdf/scene.h>

#include <filesystem>
#include <fstream>

#include "pipeline/scene/number_list.h"
#include "pipeline/scene/scene_parts.h"

namespace miebrdf {
namespace {

void check_albedo(double albedo, const std::string& where) {
    if (!(albedo >= 0.0 && albedo <= 1.0)) {
        throw UsageError(
            fmt::format("substrate: albedo {}{} is out of range; allowed: [0, 1]", albedo, where));
    }
}

Substrate read_ground_file(const std::string& path) {
    std::ifstream file(path);
    if (!file) throw InputError(fmt::format("ground file '{}' cannot be read", path));
    Substrate ground{.kind = Substrate::Kind::lambertian, .file = path};
    std::string line;
    bool has_header = false;
    for (int number = 1; std::getline(file, line); ++number) {
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (line.empty() || line[0] == '#') continue;
        const auto parts = split_list(line);
        const std::string where = fmt::format("ground file '{}', line {}", path, number);
        if (!has_header) {
            has_header = true;
            if (parts == std::vector<std::string>{"wavelength_nm", "albedo"}) continue;
            throw InputError(fmt::format("{}: the first line must be wavelength_nm,albedo", where));
        }
        if (parts.size() != 2) throw InputError(where + ": not wavelength_nm,albedo");
        try {
            ground.wavelength_nm.push_back(parse_number(parts[0], "wavelength_nm"));
            ground.albedo.push_back(parse_number(parts[1], "albedo"));
            check_albedo(ground.albedo.back(), "");
        } catch (const UsageError& error) {
            throw InputError(fmt::format("{}: {}", where, error.what()));
        }
        const std::size_t last = ground.wavelength_nm.size() - 1;
        if (last > 0 && !(ground.wavelength_nm[last] > ground.wavelength_nm[last - 1]))
            throw InputError(where + ": wavelengths must ascend");
    }
    if (ground.albedo.empty()) throw InputError(fmt::format("ground file '{}' is empty", path));
    return ground;
}

}  // namespace

Substrate substrate(const std::string& text) {
    if (text == "black") return {.kind = Substrate::Kind::black};
    if (text == "none") return {.kind = Substrate::Kind::none};
    const std::string lambert = "lambert:", mirror = "mirror:";
    if (text.starts_with(mirror) && text.size() > mirror.size())
        return {.kind = Substrate::Kind::mirror, .mirror = host(text.substr(mirror.size()))};
    if (!text.starts_with(lambert)) {
        throw UsageError(fmt::format(
            "substrate '{}': allowed: black, none (a free film), lambert:ALBEDO, lambert:FILE.csv, "
            "mirror:MATERIAL, mirror:index:N,K; a medium without end is a base",
            text));
    }
    const std::string value = text.substr(lambert.size());
    if (std::filesystem::exists(value)) return read_ground_file(value);
    Substrate ground{.kind = Substrate::Kind::lambertian};
    try {
        ground.albedo = {parse_number(value, "albedo")};
    } catch (const UsageError&) {
        throw UsageError(fmt::format(
            "substrate '{}': '{}' is neither an albedo in [0, 1] nor a file that exists", text,
            value));
    }
    check_albedo(ground.albedo.front(), "");
    return ground;
}

void validate(const Substrate& substrate) {
    if (substrate.kind == Substrate::Kind::mirror) validate(substrate.mirror);
    if (substrate.kind != Substrate::Kind::lambertian) return;
    const std::size_t count = substrate.albedo.size();
    const bool fits =
        count == 1 ? substrate.wavelength_nm.size() <= 1 : substrate.wavelength_nm.size() == count;
    if (count == 0 || !fits) {
        throw UsageError(
            fmt::format("substrate: {} albedos at {} wavelengths; allowed: one, or "
                        "one for each wavelength",
                        count, substrate.wavelength_nm.size()));
    }
    for (const double albedo : substrate.albedo) check_albedo(albedo, "");
}

std::string describe(const Substrate& substrate) {
    switch (substrate.kind) {
        case Substrate::Kind::black:
            return "black";
        case Substrate::Kind::none:
            return "none";
        case Substrate::Kind::mirror:
            return "mirror:" + describe(substrate.mirror);
        case Substrate::Kind::lambertian:
            break;
    }
    if (!substrate.file.empty()) return "lambert:" + substrate.file;
    return fmt::format("lambert:{}", substrate.albedo.empty() ? 0.0 : substrate.albedo.front());
}

}  // namespace miebrdf
