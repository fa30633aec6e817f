#include "tools/miebrdf/studio_page.h"

#include <cmath>
#include <complex>
#include <numbers>

#include <miebrdf/error.h>
#include "materials/database/user_file.h"
#include "pipeline/plot/panel.h"
#include "pipeline/solve/named_index.h"

namespace miebrdf::program {
namespace {

using nlohmann::json;

json value_or_null(const std::optional<double>& value) { return value ? json(*value) : json(); }

std::vector<double> at_the_only_incidence(const AlbedoValues& values) {
    std::vector<double> spectrum;
    for (const std::vector<double>& at : values.plane_albedo) spectrum.push_back(at.front());
    return spectrum;
}

json chip_of(const std::string& name, const Control& control) {
    // What a colour needs at least: it tells red from yellow, which is all that a chip is for.
    static const std::vector<double> wavelength_nm{420, 460, 500, 540, 580, 620, 660, 700};
    Scene scene;
    scene.database = materials::from_environment("MIEBRDF_DATABASE");
    scene.index.missing_k_is_zero = true;
    Materials materials(scene.database, scene.index);
    // A name of the database and nothing else: other words could read a file.
    if (!materials.open().resolve_exactly(name)) return {};
    scene.base = medium(name + ",radius=0.15 in index:1.5");
    const std::vector<std::complex<double>> index =
        resolve_index(scene.base.species.front(), wavelength_nm, 0.0, materials).index;
    double k = 0.0;
    std::vector<double> reflectance;
    for (const std::complex<double>& m : index) {
        k += m.imag() / double(index.size());
        reflectance.push_back(std::norm((m - 1.0) / (m + 1.0)));
    }
    const bool is_mirror = k > 1.0;
    if (!is_mirror) {
        reflectance = solve(scene, wavelength_nm, {.tolerance = 0.05, .stokes = 1}, control)
                          .albedo({1.0})
                          .spherical_albedo;
    }
    return {{"hex", plot::css_colour(Colorimeter(wavelength_nm)(reflectance).srgb)},
            {"of", is_mirror ? "mirror" : "pigment"}};
}

}  // namespace

json drawdown_for_page(const Request& request, const Viewing& light, bool is_preview,
                       const Control& control) {
    double depth = 0.0;
    for (const Layer& layer : request.scene.layers) depth += layer.depth.value;
    if (!(depth > 0.0 && std::isfinite(depth))) {
        throw UsageError(
            "nothing to draw down: the scene has no film of finite depth, and what is infinitely "
            "deep hides every ground; add a layer, e.g. TiO2,radius=0.13,volume=15% in PMMA, 40um");
    }
    DrawdownOptions options{.viewing = light};
    if (is_preview) options.hiding_contrast_ratio = 0.0;
    const double mu = std::cos(8.0 * std::numbers::pi / 180.0);
    const Drawdown film =
        draw_down(request.scene, request.wavelength_nm, {mu}, options, request.solver, control);
    const Hiding& hiding = film.hiding.front();
    return {{"over_black", at_the_only_incidence(film.over_dark)},
            {"over_white", at_the_only_incidence(film.over_light)},
            {"white", kWhiteChartAlbedo},
            {"contrast_ratio", hiding.contrast_ratio},
            {"relative_depth", value_or_null(hiding.relative_depth)},
            {"thickness_um", value_or_null(hiding.thickness_um)},
            {"spreading_rate_m2_per_l", value_or_null(hiding.spreading_rate_m2_per_l)},
            {"converged", film.over_dark.converged() && film.over_light.converged()}};
}

json MaterialChips::of(const std::vector<std::string>& names, const Control& control) {
    const std::lock_guard lock(mutex_);
    json chips = json::object();
    for (const std::string& name : names) {
        auto found = known_.find(name);
        if (found == known_.end()) {
            json chip;
            try {
                chip = chip_of(name, control);
            } catch (const Cancelled&) {
                throw;
            } catch (const Error&) {
                // Its table ends within visible light, or has no n: no chip.
            }
            found = known_.emplace(name, std::move(chip)).first;
        }
        chips[name] = found->second;
    }
    return chips;
}

}  // namespace miebrdf::program
