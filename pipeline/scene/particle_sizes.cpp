#include "pipeline/scene/particle_sizes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <vector>

#include <miebrdf/error.h>
#include "materials/database/names.h"
#include "pipeline/scene/number_list.h"

namespace miebrdf {
namespace {

using Kind = mie::SizeDistributionKind;

const std::vector<std::string> kKeys = {"radius", "variance", "distribution"};

std::string without_blanks_around(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool is_known(const std::string& key) {
    for (const std::string& known : kKeys) {
        if (key == known) return true;
    }
    return false;
}

/// The key that was meant, perhaps by the name of its option (`effective-radius`).
std::string nearest_key(const std::string& key) {
    for (const std::string& known : kKeys) {
        if (key.find(known) != std::string::npos) return known;
    }
    const auto nearest = materials::nearest_names(key, kKeys, 1);
    return nearest.empty() ? "" : nearest.front();
}

[[noreturn]] void refuse_key(const std::string& key, const std::string& layer) {
    const std::string nearest = nearest_key(key);
    throw UsageError(fmt::format(
        "medium '{}': unknown key '{}'; allowed: {}{}", layer, key, fmt::join(kKeys, ", "),
        nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
}

mie::SizeDistributionKind parse_kind(const std::string& text, const std::string& layer) {
    try {
        return mie::parse_size_distribution(text);
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("medium '{}': {}", layer, error.what()));
    }
}

/// Sets a size that is not set yet.
template <typename Value>
void set_once(std::optional<Value>& size, const Value& value, const std::string& key,
              const std::string& layer) {
    if (size) throw UsageError(fmt::format("medium '{}': {} is given twice", layer, key));
    size = value;
}

void read_size(const std::string& key, const std::string& value, const std::string& layer,
               ParticleSizes& sizes) {
    const std::string what = fmt::format("medium '{}': {}", layer, key);
    if (key == "radius") {
        set_once(sizes.effective_radius_um, parse_number(value, what), key, layer);
    } else if (key == "variance") {
        set_once(sizes.effective_variance, parse_number(value, what), key, layer);
    } else {
        set_once(sizes.distribution, parse_kind(value, layer), key, layer);
    }
}

}  // namespace

mie::SizeDistribution sizes_of(const Medium& medium, const ParticleOptions& of_scene) {
    const ParticleSizes& own = medium.sizes;
    mie::SizeDistribution sizes = of_scene.sizes;
    if (own.effective_radius_um) sizes.effective_radius_um = *own.effective_radius_um;
    if (own.effective_variance) sizes.effective_variance = *own.effective_variance;
    if (own.distribution) {
        sizes.kind = *own.distribution;
        sizes.radii_um.clear();
        sizes.number_density.clear();
    }
    return sizes;
}

void validate(const ParticleSizes& sizes, const std::string& layer) {
    const auto refuse = [&](const char* key, double value, const char* allowed) {
        throw UsageError(fmt::format("medium '{}': {} {} is out of range; allowed: {}", layer, key,
                                     value, allowed));
    };
    const double radius_um = sizes.effective_radius_um.value_or(1.0);
    if (!(radius_um > 0.0 && std::isfinite(radius_um)))
        refuse("radius", radius_um, "finite and > 0, in um");
    const double variance = sizes.effective_variance.value_or(0.2);
    if (!(variance > 0.0 && variance <= 10.0)) refuse("variance", variance, "above 0, up to 10");
    if (sizes.distribution == Kind::tabulated) {
        throw UsageError(fmt::format(
            "medium '{}': a table of sizes belongs to the scene, not to a layer", layer));
    }
}

std::string describe(const ParticleSizes& sizes) {
    std::string text;
    if (sizes.effective_radius_um) text += fmt::format(",radius={}", *sizes.effective_radius_um);
    if (sizes.effective_variance) text += fmt::format(",variance={}", *sizes.effective_variance);
    if (sizes.distribution) text += ",distribution=" + name_of(*sizes.distribution);
    return text;
}

SizedText split_sizes(const std::string& text, bool only_sizes) {
    SizedText parts{text, {}};
    for (;;) {
        const std::size_t comma = parts.medium.rfind(',');
        if (comma == std::string::npos) break;
        const std::size_t equals = parts.medium.find('=', comma);
        if (equals == std::string::npos) break;
        const std::string key =
            without_blanks_around(parts.medium.substr(comma + 1, equals - comma - 1));
        if (!is_known(key)) {
            if (only_sizes) refuse_key(key, text);
            break;
        }
        read_size(key, without_blanks_around(parts.medium.substr(equals + 1)), text, parts.sizes);
        parts.medium = without_blanks_around(parts.medium.substr(0, comma));
    }
    validate(parts.sizes, text);
    return parts;
}

}  // namespace miebrdf
