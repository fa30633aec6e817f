#include "pipeline/sweep/satellite.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <map>

namespace miebrdf::sweep {
namespace {

/// CRTM interpolates by averaged parabolas through four nodes.
constexpr std::size_t kCrtmNodes = 4;

void require_grid(const Sweep& sweep, const char* layout) {
    std::vector<const Axis*> axes = asked_axes(sweep);
    for (const Axis* axis : axes) {
        if (axis->name.rfind("mu_", 0) == 0)
            throw UsageError(
                fmt::format("layout {}: angles are degrees; write theta_{}_deg in place of {}",
                            layout, axis->name.substr(3), axis->name));
    }
    for (const Dimension& dimension : sweep.dimensions) {
        if (!dimension.is_coordinate() || dimension.axes.front().is_text())
            throw UsageError(fmt::format(
                "layout {}: '{}' is no axis of numbers of its own; the table is a grid of them",
                layout, dimension.name));
        axes.push_back(&dimension.axes.front());
    }
    for (const Axis* axis : axes) {
        if (!std::is_sorted(axis->numbers.begin(), axis->numbers.end()))
            throw UsageError(
                fmt::format("layout {}: axis {}: write ascending values", layout, axis->name));
    }
}

void require_isofit_axes(const Sweep& sweep, const char* layout) {
    if (sweep.outputs.size() != 1 || !sweep.derivatives.empty() ||
        !(sweep.wants(Output::plane_albedo) || sweep.wants(Output::spherical_albedo) ||
          sweep.wants(Output::hdrf)))
        throw UsageError(fmt::format(
            "layout {} holds one output: hdrf (with diffuse_fraction = 0: pi times the BRDF), "
            "plane_albedo or spherical_albedo, without derivatives",
            layout));
    require_grid(sweep, layout);
    if (sweep.azimuth.size() > 1)
        throw UsageError(fmt::format(
            "layout {}: ISOFIT has no azimuth; write one value of azimuth_deg", layout));
    if (sweep.dimensions.empty())
        throw UsageError(fmt::format(
            "layout {}: a surface has at least one axis of scenes, such as radius_um", layout));
}

void require_crtm_axes(const Sweep& sweep) {
    constexpr char kLayout[] = "crtm-snow";
    if (sweep.outputs != std::vector{Output::plane_albedo} || !sweep.derivatives.empty())
        throw UsageError(
            "layout crtm-snow: outputs = [\"plane_albedo\"] is all that it holds, without "
            "derivatives");
    require_grid(sweep, kLayout);
    for (const char* name :
         {"theta_in_deg", "wavelength_nm", "radius_um", "depth_m", "density_kg_m3"}) {
        const Axis* axis = sweep.find_axis(name);
        if (axis == nullptr || axis->size() < kCrtmNodes)
            throw UsageError(fmt::format(
                "layout crtm-snow: CRTM interpolates between four nodes of each axis; give {} "
                "{} values or more",
                name, kCrtmNodes));
    }
    if (sweep.dimensions.size() != 3)
        throw UsageError(
            "layout crtm-snow: the axes of scenes are radius_um, depth_m and density_kg_m3; "
            "others have no place");
}

}  // namespace

void require_satellite_axes(const Sweep& sweep) {
    if (sweep.table_layout == TableLayout::isofit) require_isofit_axes(sweep, "isofit");
    if (sweep.table_layout == TableLayout::isofit_surface)
        require_isofit_axes(sweep, "isofit-surface");
    if (sweep.table_layout == TableLayout::crtm_snow) require_crtm_axes(sweep);
}

void GatheredTable::add(std::size_t, const std::vector<SceneResult>& results) {
    values_.reserve(sweep_.scenes() * layout_.record);
    for (const SceneResult& result : results) {
        values_.insert(values_.end(), result.values.begin(), result.values.end());
        error_estimates_.push_back(result.error_estimate);
    }
}

std::vector<double> GatheredTable::over(const std::vector<const Axis*>& axes) const {
    std::vector<const Axis*> stored;
    for (const Dimension& dimension : sweep_.dimensions) stored.push_back(&dimension.axes.front());
    const std::vector<const Axis*>& asked = layout_.variables.front().axes;
    stored.insert(stored.end(), asked.begin(), asked.end());
    std::map<const Axis*, std::size_t> strides;
    std::size_t stride = 1;
    for (std::size_t i = stored.size(); i-- > 0; stride *= stored[i]->size())
        strides[stored[i]] = stride;
    std::vector<double> ordered(values_.size());
    for (std::size_t k = 0; k < ordered.size(); ++k) {
        std::size_t place = 0, rest = k;
        for (std::size_t a = axes.size(); a-- > 0; rest /= axes[a]->size())
            place += rest % axes[a]->size() * strides.at(axes[a]);
        ordered[k] = values_[place];
    }
    return ordered;
}

}  // namespace miebrdf::sweep
