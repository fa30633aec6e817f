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

/// "RHO0,K,THETA[,RHOC]"
std::string form_of(const rte::GroundModel& model) {
    std::string form = std::string(model.name) + ":";
    for (std::size_t i = 0; i < model.parameters.size(); ++i) {
        std::string name = model.parameters[i].name;
        std::transform(name.begin(), name.end(), name.begin(),
                       [](char c) { return char(std::toupper(static_cast<unsigned char>(c))); });
        form += i < model.needed ? (i > 0 ? "," : "") + name : "[," + name + "]";
    }
    return form;
}

std::optional<Substrate> natural_ground(const std::string& text) {
    const auto models = rte::ground_models();
    for (std::size_t m = 0; m < models.size(); ++m) {
        const rte::GroundModel& model = models[m];
        const std::string prefix = std::string(model.name) + ":";
        if (!text.starts_with(prefix)) continue;
        const std::vector<std::string> words = split_list(text.substr(prefix.size()));
        if (words.size() < model.needed || words.size() > model.parameters.size()) {
            throw UsageError(fmt::format("substrate '{}': {} numbers; expected {}", text,
                                         words.size(), form_of(model)));
        }
        Substrate ground{.kind = Substrate::Kind::brdf};
        ground.brdf.kind = static_cast<rte::GroundBrdf::Kind>(m);
        for (std::size_t i = 0; i < words.size(); ++i)
            ground.brdf.values[i] = parse_number(words[i], model.parameters[i].name);
        // Of the model as it was published, the hot spot has one number: rhoc is rho0.
        if (words.size() < model.parameters.size()) ground.brdf.values[3] = ground.brdf.values[0];
        validate(ground);
        return ground;
    }
    return std::nullopt;
}

}  // namespace

Substrate substrate(const std::string& text) {
    if (text == "black") return {.kind = Substrate::Kind::black};
    if (text == "none") return {.kind = Substrate::Kind::none};
    const std::string lambert = "lambert:", mirror = "mirror:";
    if (text.starts_with(mirror) && text.size() > mirror.size())
        return {.kind = Substrate::Kind::mirror, .mirror = host(text.substr(mirror.size()))};
    if (auto natural = natural_ground(text)) return *natural;
    if (!text.starts_with(lambert)) {
        throw UsageError(fmt::format(
            "substrate '{}': allowed: black, none (a free film), lambert:ALBEDO, lambert:FILE.csv, "
            "mirror:MATERIAL, mirror:index:N,K, {}; an infinitely deep medium is a base",
            text, forms_of_grounds()));
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

std::string forms_of_grounds() {
    std::vector<std::string> forms;
    forms.reserve(rte::ground_models().size());
    for (const rte::GroundModel& model : rte::ground_models()) forms.push_back(form_of(model));
    return fmt::format("{}", fmt::join(forms, ", "));
}

void validate(const Substrate& substrate) {
    if (substrate.kind == Substrate::Kind::brdf) {
        rte::validate(substrate.brdf);
        const double albedo = rte::energy_of(substrate.brdf).spherical_albedo;
        if (albedo <= 1.0 && albedo >= 0.0) return;
        throw UsageError(fmt::format(
            "substrate '{}' returns {:.3g} of uniform light; allowed: 0 to 1 (lower its first "
            "number)",
            describe(substrate), albedo));
    }
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
        case Substrate::Kind::brdf: {
            const rte::GroundModel& model = substrate.brdf.model();
            return fmt::format(
                "{}:{}", model.name,
                fmt::join(substrate.brdf.values.begin(),
                          substrate.brdf.values.begin() + std::ptrdiff_t(model.parameters.size()),
                          ","));
        }
        case Substrate::Kind::lambertian:
            break;
    }
    if (!substrate.file.empty()) return "lambert:" + substrate.file;
    return fmt::format("lambert:{}", substrate.albedo.empty() ? 0.0 : substrate.albedo.front());
}

}  // namespace miebrdf
