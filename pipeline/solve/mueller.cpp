// The Mueller matrix of a scene: light with its polarisation.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/cache/job_key.h"
#include "pipeline/cache/packed_numbers.h"
#include "pipeline/cache/result_cache.h"
#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/checks.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/polarisation.h"
#include "rte/stokes/stokes_reflection.h"

namespace miebrdf {
namespace {

struct MuellerSlice {
    std::vector<double> values;  ///< 1/sr
    std::vector<double> plane_albedo, polarised_plane_albedo;
    std::vector<double> mirror;  ///< as of MuellerValues
    WavelengthReport report;
};

std::string mueller_hash(const LayerRequest& request, std::size_t w) {
    JobKey key("mueller");
    request.scene.add_to(key, w);
    key.add(request.scene.particles.tolerance).add(request.solver).add(request.directions);
    return key.hash();
}

std::vector<double> packed(const MuellerSlice& slice) {
    const auto& [values, plane_albedo, polarised, mirror, report] = slice;
    return NumberPacker()
        .add(values)
        .add(plane_albedo)
        .add(polarised)
        .add(mirror)
        .add(report)
        .take();
}

MuellerSlice unpacked_mueller(const std::vector<double>& numbers) {
    NumberUnpacker unpacker(numbers);
    MuellerSlice slice;
    unpacker.read(slice.values);
    unpacker.read(slice.plane_albedo);
    unpacker.read(slice.polarised_plane_albedo);
    unpacker.read(slice.mirror);
    unpacker.read(slice.report);
    return slice;
}

MuellerSlice mueller_slice(const LayerRequest& request, const SceneOptics& optics) {
    SolverOptions solver = request.solver;
    solver.tolerance = rest_of_tolerance(request.solver.tolerance, optics.mie_error_estimate);
    rte::MuellerTable table =
        rte::reflect_polarised(optics.stack, request.directions, request.solver.stokes, solver);
    MuellerSlice slice;
    slice.values = std::move(table.reflection);
    for (double& value : slice.values) value /= std::numbers::pi;
    slice.plane_albedo = std::move(table.plane_albedo);
    slice.polarised_plane_albedo = std::move(table.polarised_plane_albedo);
    slice.mirror = std::move(table.mirror_reflection);
    slice.report.solver = table.report;
    slice.report.optical_depths = optics.optical_depths;
    slice.report.stokes = request.solver.stokes;
    judge(slice.report, optics.mie_error_estimate, optics.converged, request.solver.tolerance);
    return slice;
}

std::vector<MuellerSlice> compute_mueller(const LayerRequest& request, const Control& control) {
    const std::size_t count = request.scene.wavelength_nm.size();
    std::vector<MuellerSlice> slices(count);
    std::vector<std::size_t> missing;
    std::vector<std::string> hashes;
    for (std::size_t w = 0; w < count; ++w) {
        choose_light(request, w);  // refuses what cannot be computed
        hashes.push_back(mueller_hash(request, w));
        const auto known = control.cache != nullptr ? control.cache->find(hashes[w]) : std::nullopt;
        if (known) {
            slices[w] = unpacked_mueller(*known);
        } else {
            missing.push_back(w);
        }
    }
    OpticsDemand demand =
        demand_of(request.solver, request.scene.particles.tolerance, PhaseDemand::whole);
    demand.polarisation = true;
    const auto optics = visible_optics(request.scene, request.directions, request.solver.tolerance,
                                       missing, demand, control);
    run_parallel("radiative transfer", missing.size(), control, [&](std::size_t i) {
        const std::size_t w = missing[i];
        slices[w] = mueller_slice(request, optics[i]);
        if (control.cache != nullptr) control.cache->store(hashes[w], packed(slices[w]));
    });
    for (std::size_t w = 0; w < count; ++w)
        slices[w].report.wavelength_nm = request.scene.wavelength_nm[w];
    return slices;
}

void require_index(std::size_t index, std::size_t count, const char* name) {
    if (index < count) return;
    throw UsageError(name, double(index), "0 to " + std::to_string(count == 0 ? 0 : count - 1));
}

}  // namespace

MuellerValues Brdf::mueller(const Directions& directions) const {
    require_valid(directions);
    SolverOptions solver = state_->solver;
    if (solver.stokes < 3) solver.stokes = 3;
    const ResolvedScene& scene = state_->resolved;
    std::vector<MuellerSlice> slices =
        compute_mueller({scene, directions, solver, LayerQuantity::reflection}, state_->control);
    MuellerValues values;
    values.directions = directions;
    values.components = solver.stokes;
    values.tolerance = solver.tolerance;
    values.sources = scene.sources;
    values.notes = scene.notes;
    for (MuellerSlice& slice : slices) {
        values.wavelengths.push_back(slice.report);
        values.mueller.push_back(std::move(slice.values));
        values.plane_albedo.push_back(std::move(slice.plane_albedo));
        values.polarised_plane_albedo.push_back(std::move(slice.polarised_plane_albedo));
        if (!slice.mirror.empty()) values.mirror_mueller.push_back(std::move(slice.mirror));
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
