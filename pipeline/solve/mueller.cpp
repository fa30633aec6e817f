// The Mueller matrix of a scene: light with its polarisation.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/transfer.h>

#include <cmath>
#include <numbers>

#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/layers.h"

namespace miebrdf {
namespace {

void require_index(std::size_t index, std::size_t count, const char* name) {
    if (index < count) return;
    throw UsageError(name, double(index), "0 to " + std::to_string(count == 0 ? 0 : count - 1));
}

}  // namespace

MuellerValues Brdf::mueller(const Directions& directions) const {
    rte::validate(directions);
    SolverOptions solver = state_->solver;
    if (solver.stokes < 3) solver.stokes = 3;
    const ResolvedScene& scene = state_->resolved;
    std::vector<LayerSlice> slices =
        compute_layers({scene, directions, solver, LayerQuantity::mueller}, state_->control);
    MuellerValues values;
    values.directions = directions;
    values.components = solver.stokes;
    values.tolerance = solver.tolerance;
    values.sources = scene.sources;
    values.notes = scene.notes;
    for (LayerSlice& slice : slices) {
        for (double& value : slice.values) value /= std::numbers::pi;
        values.wavelengths.push_back(slice.report);
        values.mueller.push_back(std::move(slice.values));
        values.plane_albedo.push_back(std::move(slice.plane_albedo));
        values.polarised_plane_albedo.push_back(std::move(slice.polarised_plane_albedo));
        if (!slice.mirror_reflectance.empty())
            values.mirror_mueller.push_back(std::move(slice.mirror_reflectance));
    }
    return values;
}

double MuellerValues::at(std::size_t wavelength, std::size_t in, std::size_t out,
                         std::size_t azimuth, int row, int column) const {
    const Directions& d = directions;
    const auto size = static_cast<std::size_t>(components);
    require_index(wavelength, mueller.size(), "wavelength");
    require_index(in, d.mu_in.size(), "mu_in");
    require_index(out, d.mu_out.size(), "mu_out");
    require_index(azimuth, d.azimuth_deg.size(), "azimuth_deg");
    require_index(static_cast<std::size_t>(row), size, "row");
    require_index(static_cast<std::size_t>(column), size, "column");
    const std::size_t pair = (in * d.mu_out.size() + out) * d.azimuth_deg.size() + azimuth;
    return mueller[wavelength][(pair * size + static_cast<std::size_t>(row)) * size +
                               static_cast<std::size_t>(column)];
}

double MuellerValues::degree_of_linear_polarisation(std::size_t wavelength, std::size_t in,
                                                    std::size_t out, std::size_t azimuth) const {
    const double I = at(wavelength, in, out, azimuth, 0);
    if (!(I > 0.0)) return 0.0;
    return std::hypot(at(wavelength, in, out, azimuth, 1), at(wavelength, in, out, azimuth, 2)) / I;
}

double MuellerValues::angle_of_polarisation_deg(std::size_t wavelength, std::size_t in,
                                                std::size_t out, std::size_t azimuth) const {
    const double Q = at(wavelength, in, out, azimuth, 1), U = at(wavelength, in, out, azimuth, 2);
    if (Q == 0.0 && U == 0.0) return 0.0;
    const double angle = 0.5 * std::atan2(U, Q) * 180.0 / std::numbers::pi;
    return angle < 0.0 ? angle + 180.0 : angle;
}

}  // namespace miebrdf
