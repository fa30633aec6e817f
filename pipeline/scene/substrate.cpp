// Reads and writes the words for what lies below the layers in place of a base.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>
#include <miebrdf/scene.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include "pipeline/measured/reader.h"
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

/// Reflectances of any file of measurements, of one sample: hemispherical ones where there are
/// others beside them.
Substrate read_ground_file(const std::string& path) {
    const Measurements list = measured::read_with(measured::readers(), path, {});
    const auto is_albedo = [](const MeasuredValue& v) {
        return (v.quantity == MeasuredQuantity::reflectance ||
                v.quantity == MeasuredQuantity::reflectance_factor) &&
               v.geometry != MeasuredGeometry::directions && !std::isnan(v.wavelength_nm);
    };
    const bool hemispherical = std::any_of(list.values.begin(), list.values.end(), [&](auto& v) {
        return is_albedo(v) && v.geometry == MeasuredGeometry::hemispherical;
    });
    const auto refuse = [&](int line, const std::string& reason) {
        throw materials::ImportError(path, line, reason);
    };
    std::map<double, double> spectrum;  // in order of wavelength
    std::optional<std::size_t> sample;
    for (const MeasuredValue& v : list.values) {
        if (!is_albedo(v) || (hemispherical && v.geometry != MeasuredGeometry::hemispherical))
            continue;
        if (sample.value_or(v.sample) != v.sample) {
            refuse(0, fmt::format("which column or sample? It has {}; a ground is one of them: a "
                                  "file that has it alone, as wavelength_nm,albedo",
                                  fmt::join(list.samples, ", ")));
        }
        sample = v.sample;
        if (!(v.value >= 0.0 && v.value <= 1.0))
            refuse(v.line, fmt::format("albedo {}; allowed: [0, 1]", v.value));
        if (!spectrum.emplace(v.wavelength_nm, v.value).second)
            refuse(v.line, fmt::format("{} nm is there twice", v.wavelength_nm));
    }
    if (spectrum.empty()) refuse(0, "has no reflectance over wavelengths, which a ground needs");
    Substrate ground{.kind = Substrate::Kind::lambertian, .file = path};
    for (const auto& [nm, value] : spectrum) {
        ground.wavelength_nm.push_back(nm);
        ground.albedo.push_back(value);
    }
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
            "mirror:MATERIAL, mirror:index:N,K; an infinitely deep medium is a base",
            text));
    }
    const std::string value = text.substr(lambert.size());
    if (std::filesystem::exists(value)) return read_ground_file(value);
    Substrate ground{.kind = Substrate::Kind::lambertian};
    try {
        ground.albedo = {value.ends_with('%')
                             ? parse_number(value.substr(0, value.size() - 1), "albedo") / 100.0
                             : parse_number(value, "albedo")};
    } catch (const UsageError&) {
        const std::string reason = fmt::format(
            "substrate '{}': '{}' is neither an albedo in [0, 1] (or 80%) nor a file that exists",
            text, value);
        if (value.find_first_of("./\\") == std::string::npos) throw UsageError(reason);
        throw InputError(reason);  // it is meant to be a file
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
