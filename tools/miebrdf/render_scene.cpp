#include "tools/miebrdf/render_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/render/lighting.h"
#include "pipeline/render/mesh.h"
#include "pipeline/render/renderer.h"
#include "pipeline/scene/number_list.h"

namespace miebrdf::program {
namespace {

using render::Spectrum;

/// Under this irradiance a white surface that faces the light has radiance 1.
constexpr double kDefaultIrradiance = std::numbers::pi;

/// Distance of area lights in radii of the object.
constexpr double kLightDistance = 6.0;

/// A choice for pictures, not a model of the atmosphere: the sky lights level ground with this
/// share of what the sun gives to a surface that faces it, and the ground reflects that much.
constexpr double kSkyShare = 0.15;
constexpr double kGroundAlbedo = 0.2;

Spectrum scaled(Spectrum spectrum, double factor) {
    for (double& value : spectrum) value *= factor;
    return spectrum;
}

class LightParser {
  public:
    LightParser(const std::string& spectrum, const render::Bounds& object,
                const std::vector<double>& wavelength_nm)
        : spectrum_(render::light_spectrum(spectrum, wavelength_nm)),
          object_(object),
          wavelength_nm_(wavelength_nm) {}

    void add(const std::string& text) {
        const std::size_t colon = text.find(':');
        const std::string kind = text.substr(0, colon);
        const auto parts = split_list(colon == std::string::npos ? "" : text.substr(colon + 1));
        text_ = text;
        if (kind == "directional") return add_directional(numbers(parts, 2, 3));
        if (kind == "area") return add_area(numbers(parts, 3, 4));
        if (lighting.environment) {
            throw UsageError(fmt::format("light '{}': there is one environment already", text));
        }
        if (kind == "uniform") return add_uniform(numbers(parts, 1, 1));
        if (kind == "sky") return add_sky(numbers(parts, 2, 3));
        if (kind == "map") return add_map(parts);
        throw UsageError(fmt::format(
            "unknown light '{}'; allowed: directional:, area:, uniform:, sky:, map:", text));
    }

    render::Lighting lighting;

  private:
    std::vector<double> numbers(const std::vector<std::string>& parts, std::size_t least,
                                std::size_t most) const {
        if (parts.size() < least || parts.size() > most) {
            throw UsageError(fmt::format("light '{}': {} numbers; wanted: {} to {}", text_,
                                         parts.size(), least, most));
        }
        std::vector<double> values;
        values.reserve(parts.size());
        for (const std::string& part : parts)
            values.push_back(parse_number(part, "light '" + text_ + "'"));
        return values;
    }

    void require_strength(double value) const {
        if (!(value >= 0.0))
            throw UsageError(fmt::format("light '{}': {} is negative", text_, value));
    }

    void add_directional(const std::vector<double>& v) {
        const double irradiance = v.size() > 2 ? v[2] : kDefaultIrradiance;
        require_strength(irradiance);
        lighting.directional.push_back(
            {render::direction_from_angles(v[0], v[1]), scaled(spectrum_, irradiance)});
    }

    void add_area(const std::vector<double>& v) {
        const double irradiance = v.size() > 3 ? v[3] : kDefaultIrradiance;
        require_strength(irradiance);
        lighting.area.push_back(render::square_light(
            object_.centre(), render::direction_from_angles(v[0], v[1]),
            kLightDistance * object_.radius, v[2], scaled(spectrum_, irradiance)));
    }

    void add_uniform(const std::vector<double>& v) {
        require_strength(v[0]);
        lighting.environment = render::Environment::uniform(scaled(spectrum_, v[0]));
    }

    void add_sky(const std::vector<double>& v) {
        const double scale = v.size() > 2 ? v[2] : 1.0;
        require_strength(scale);
        if (!(v[0] > 0.0 && v[0] <= 90.0)) {
            throw UsageError(
                fmt::format("light '{}': the sun at {} degrees; allowed: (0, 90]", text_, v[0]));
        }
        const Eigen::Vector3d sun = render::direction_from_angles(v[0], v[1]);
        const double sun_irradiance = scale * kDefaultIrradiance;
        const double sky_irradiance = kSkyShare * sun_irradiance;
        const double ground =
            kGroundAlbedo * (sky_irradiance + sun_irradiance * sun.y()) / std::numbers::pi;
        lighting.directional.push_back(
            {sun,
             scaled(render::light_spectrum("blackbody:5500", wavelength_nm_), sun_irradiance)});
        lighting.environment = render::Environment::from_map(
            render::clear_sky_map(sun, sky_irradiance, ground),
            {render::light_spectrum("blackbody:12000", wavelength_nm_),
             render::light_spectrum("blackbody:5500", wavelength_nm_),
             Spectrum(wavelength_nm_.size())},
            "sky");
    }

    void add_map(const std::vector<std::string>& parts) {
        if (parts.empty() || parts.size() > 2)
            throw UsageError(fmt::format("light '{}': wanted: map:FILE[,SCALE]", text_));
        const double scale =
            parts.size() > 1 ? parse_number(parts[1], "scale of a map of light") : 1.0;
        require_strength(scale);
        const std::string& path = parts[0];
        const bool is_hdr = path.size() > 4 && path.compare(path.size() - 4, 4, ".hdr") == 0;
        auto basis = render::colour_basis(wavelength_nm_);
        for (Spectrum& spectrum : basis) spectrum = scaled(spectrum, scale);
        lighting.environment = render::Environment::from_map(
            is_hdr ? render::read_hdr(path) : render::read_exr(path), basis, path);
    }

    Spectrum spectrum_;
    const render::Bounds& object_;
    const std::vector<double>& wavelength_nm_;
    std::string text_;
};

}  // namespace

render::RayScene parse_object(const std::string& text) {
    if (text == "sphere") return render::RayScene::sphere(Eigen::Vector3d::Zero(), 1.0);
    if (text == "knot") return render::RayScene::mesh(render::make_knot(), text);
    if (text == "plaque") return render::RayScene::mesh(render::make_plaque(), text);
    if (text.size() > 4 && text.compare(text.size() - 4, 4, ".obj") == 0) {
        return render::RayScene::mesh(render::read_obj(text), text);
    }
    throw UsageError(
        fmt::format("unknown object '{}'; allowed: sphere, knot, plaque, FILE.obj", text));
}

render::Lighting parse_lights(const std::vector<std::string>& texts, const std::string& spectrum,
                              const render::Bounds& object,
                              const std::vector<double>& wavelength_nm) {
    LightParser parser(spectrum, object, wavelength_nm);
    for (const std::string& text : texts) parser.add(text);
    return std::move(parser.lighting);
}

std::pair<double, double> parse_pair(const std::string& text, const std::string& what) {
    const auto parts = split_list(text);
    if (parts.size() != 2)
        throw UsageError(fmt::format("{}: '{}'; wanted: two numbers A,B", what, text));
    return {parse_number(parts[0], what), parse_number(parts[1], what)};
}

std::pair<int, int> parse_size(const std::string& text) {
    const auto refuse = [&] {
        throw UsageError(
            fmt::format("size: '{}'; allowed: WIDTH,HEIGHT, or one number for a square "
                        "picture, each a whole number of pixels in [1, {}]",
                        text, render::kLongestSide));
    };
    const auto parts = split_list(text);
    if (parts.empty() || parts.size() > 2) refuse();
    const auto pixels = [&](const std::string& part) {
        const double number = parse_number(part, "size");
        if (!(number >= 1.0 && number <= render::kLongestSide) || number != std::floor(number))
            refuse();
        return static_cast<int>(number);
    };
    return {pixels(parts.front()), pixels(parts.back())};
}

}  // namespace miebrdf::program
