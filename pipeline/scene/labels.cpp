#include "pipeline/scene/labels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace miebrdf {
namespace {

/// "H2O_ice" -> "H2O ice"
std::string readable(std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

/// A species without its sizes and amounts.
std::string kind_text(const Species& species) {
    const std::vector<double>& p = species.parameters;
    if (species.kind == Species::Kind::material) return readable(species.name);
    if (species.kind == Species::Kind::index)
        return p[1] == 0.0 ? fmt::format("n = {:g}", p[0])
                           : fmt::format("n = {:g}, k = {:g}", p[0], p[1]);
    if (species.kind == Species::Kind::henyey_greenstein && !species.name.empty())
        return "Henyey-Greenstein of " + species.name;
    if (species.kind == Species::Kind::henyey_greenstein)
        return fmt::format("Henyey-Greenstein, albedo {:g}, g {:g}", p[0], p[1]);
    if (species.kind == Species::Kind::double_henyey_greenstein)
        return fmt::format("Henyey-Greenstein, albedo {:g}, {:.3g} % g {:g}, the rest g {:g}", p[0],
                           100.0 * p[3], p[1], p[2]);
    if (species.kind == Species::Kind::isotropic)
        return fmt::format("isotropic, albedo {:g}", p[0]);
    if (species.kind == Species::Kind::rayleigh) return fmt::format("Rayleigh, albedo {:g}", p[0]);
    if (species.kind == Species::Kind::moments) return "moments of " + species.name;
    return readable(species.name);
}

std::string share_text(double share, const std::string& of) {
    if (share < 1e-6) return fmt::format("{:.4g} ppb of the {}", 1e9 * share, of);
    if (share < 1e-4) return fmt::format("{:.4g} ppm of the {}", 1e6 * share, of);
    return fmt::format("{:.4g} % of the {}", 100.0 * share, of);
}

std::string amount_text(const Amount& amount) {
    switch (amount.kind) {
        case Amount::Kind::volume_fraction:
            return share_text(amount.value, "volume");
        case Amount::Kind::mass_fraction:
            return share_text(amount.value, "mass");
        case Amount::Kind::number_per_cm3:
            break;
    }
    return fmt::format("{:.4g} per cm\u00b3", amount.value);
}

std::string material_text(const Host& host, const std::string& what) {
    return host.name.empty() ? fmt::format("{} of index {:g}", what, host.index.real())
                             : readable(host.name);
}

std::string host_text(const Host& host) { return material_text(host, "a host"); }

std::string coating_text(const Coating& coating) {
    const std::string of = material_text(coating.material, "a coating");
    if (coating.share_of_radius > 0.0)
        return fmt::format("{:g} % of the radius of {}", 100.0 * coating.share_of_radius, of);
    return fmt::format("{:g} nm of {}", 1e3 * coating.thickness_um, of);
}

std::string species_text(const Species& species) {
    std::string text = kind_text(species);
    if (const auto radius = species.sizes.effective_radius_um)
        text += fmt::format(", radius {:g} \u00b5m", *radius);
    if (const auto variance = species.sizes.effective_variance)
        text += fmt::format(", variance {:g}", *variance);
    for (const Coating& coating : species.coatings)
        text += ", coated with " + coating_text(coating);
    if (species.amount) text += ", " + amount_text(*species.amount);
    if (const auto density = species.layer_density_kg_m3)
        text += fmt::format(", layer of {:g} kg/m\u00b3", *density);
    return text;
}

/// The surface or boundary above the layers; empty where there is none.
std::string top_text(const Scene& scene) {
    std::string text;
    if (scene.boundary) {
        text = scene.boundary->roughness > 0.0
                   ? fmt::format("boundary of roughness {:g}", scene.boundary->roughness)
                   : "smooth boundary";
    }
    if (scene.surface) {
        const bool is_ggx = scene.surface->distribution == rte::MicrofacetDistribution::ggx;
        text += fmt::format("{}roughness {:g}{}", text.empty() ? "" : ", ",
                            scene.surface->beckmann_alpha, is_ggx ? " (GGX)" : "");
    }
    return text;
}

std::string bottom_text(const Scene& scene) {
    return scene.substrate ? label_of(*scene.substrate) : label_of(scene.base);
}

bool differ(const std::vector<Scene>& scenes, const auto& part) {
    return std::any_of(scenes.begin(), scenes.end(),
                       [&](const Scene& scene) { return part(scene) != part(scenes.front()); });
}

/// Media of the layers, without their depths.
std::string media_text(const Scene& scene) {
    std::string text;
    for (const Layer& layer : scene.layers) text += describe(layer.medium) + "@";
    return text;
}

std::string depths_text(const Scene& scene) {
    std::string text;
    for (const Layer& layer : scene.layers)
        text += (text.empty() ? "" : ", ") + label_of(layer.depth);
    return text;
}

/// Leaves out the phrases that all texts have at their ends, then those at their beginnings.
void drop_common_phrases(std::vector<std::string>& texts) {
    const auto in_all = [&](const auto& has) {
        return std::all_of(texts.begin(), texts.end(), has);
    };
    for (std::size_t at = 0; at < texts.front().size(); ++at) {
        const std::string end = texts.front().substr(at);
        const bool is_phrase = end.starts_with(" on ") || end.starts_with(" in ") ||
                               end.starts_with(", ") || end.starts_with(" (");
        if (!is_phrase || !in_all([&](const std::string& t) { return t.ends_with(end); })) continue;
        for (std::string& text : texts) text.resize(text.size() - end.size());
        break;
    }
    for (std::size_t size = texts.front().size(); size > 0; --size) {
        const std::string start = texts.front().substr(0, size);
        const bool is_phrase =
            start.ends_with(" on ") || start.ends_with(" + ") || start.ends_with(", ");
        if (!is_phrase || !in_all([&](const std::string& t) { return t.starts_with(start); }))
            continue;
        for (std::string& text : texts) text.erase(0, size);
        break;
    }
}

}  // namespace

std::string label_of(const Medium& medium) {
    std::string text;
    for (const Species& species : medium.species)
        text += (text.empty() ? "" : " + ") + species_text(species);
    return medium.host ? text + " in " + host_text(*medium.host) : text;
}

std::string label_of(const Depth& depth) {
    if (depth.kind == Depth::Kind::mass_kg_per_m2)
        return fmt::format("{:g} kg/m\u00b2", depth.value);
    if (depth.kind == Depth::Kind::thickness_um) {
        if (depth.value >= 1e4) return fmt::format("{:g} cm", depth.value / 1e4);
        if (depth.value >= 1e3) return fmt::format("{:g} mm", depth.value / 1e3);
        return fmt::format("{:g} \u00b5m", depth.value);
    }
    if (std::isinf(depth.value)) return "opaque";
    const std::string text = fmt::format("\u03c4 = {:g}", depth.value);
    if (depth.wavelength_nm == 0.0 || depth.wavelength_nm == kDepthWavelengthNm) return text;
    return text + fmt::format(" at {:g} nm", depth.wavelength_nm);
}

std::string label_of(const Substrate& substrate) {
    switch (substrate.kind) {
        case Substrate::Kind::black:
            return "black ground";
        case Substrate::Kind::none:
            return "nothing";
        case Substrate::Kind::mirror:
            return "mirror of " + host_text(substrate.mirror);
        case Substrate::Kind::brdf:
            return "ground " + describe(substrate);
        case Substrate::Kind::lambertian:
            break;
    }
    return substrate.albedo.size() == 1 ? fmt::format("ground of albedo {:g}", substrate.albedo[0])
                                        : "ground of " + substrate.file;
}

std::string label_of(const Scene& scene) {
    std::string text;
    for (auto layer = scene.layers.rbegin(); layer != scene.layers.rend(); ++layer)
        text += fmt::format("{} ({}) on ", label_of(layer->medium), label_of(layer->depth));
    const std::string bottom = bottom_text(scene), top = top_text(scene);
    if (bottom.empty()) text.resize(text.size() - std::min<std::size_t>(text.size(), 4));  // " on "
    text += bottom;
    return top.empty() ? text : text + ", " + top;
}

std::string media_of(const Scene& scene) {
    std::string text;
    for (auto layer = scene.layers.rbegin(); layer != scene.layers.rend(); ++layer)
        text += label_of(layer->medium) + " on ";
    const std::string top = top_text(scene);
    return text + bottom_text(scene) + (top.empty() ? "" : ", " + top);
}

std::vector<std::string> labels_of(const std::vector<Scene>& scenes) {
    std::vector<std::string> labels(scenes.size());
    if (scenes.size() < 2) return labels;
    const bool media = differ(scenes, media_text), depths = differ(scenes, depths_text),
               bottoms = differ(scenes, bottom_text), tops = differ(scenes, top_text);
    std::vector<std::string> whole;
    for (const Scene& scene : scenes) whole.push_back(label_of(scene));
    drop_common_phrases(whole);
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const Scene& scene = scenes[i];
        if (depths && !media && !bottoms && !tops) {
            labels[i] = depths_text(scene);
        } else if (tops && !media && !depths && !bottoms) {
            labels[i] = top_text(scene).empty() ? "no surface" : top_text(scene);
        } else {
            labels[i] = whole[i];
        }
    }
    return labels;
}

}  // namespace miebrdf
