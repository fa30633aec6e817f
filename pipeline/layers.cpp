#include "pipeline/layers.h"

#include <optional>

#include "pipeline/packed_numbers.h"
#include "pipeline/parallel.h"
#include "pipeline/result_cache.h"

namespace miebrdf {
namespace {

/// Everything a slice depends on.
std::string hash_of(const Request& request, const SceneMedia& media, LayerQuantity quantity,
                    double wavelength_nm) {
    const rte::SolverOptions& solver = request.solver;
    JobKey key("layers");
    key.add(static_cast<int>(quantity));
    media.add_to(key, wavelength_nm);
    key.add(request.scene.particles.tolerance).add(solver.tolerance);
    key.add(static_cast<int>(solver.grid)).add(solver.streams);
    key.add(static_cast<int>(solver.half_space_method)).add(static_cast<int>(solver.coat_method));
    key.add(solver.coat_substeps).add(solver.delta_m ? 1 : 0);
    key.add(solver.single_scattering_correction ? 1 : 0);
    key.add(std::span<const double>(request.directions.mu_in));
    key.add(std::span<const double>(request.directions.mu_out));
    key.add(std::span<const double>(request.directions.azimuth_deg));
    return key.hash();
}

std::vector<double> packed(const LayerSlice& slice) {
    const rte::SolverReport& report = slice.report;
    NumberPacker packer;
    packer.add(slice.values).add(slice.mie_error_estimate).add(slice.error_estimate);
    packer.add(slice.converged ? 1 : 0).add(report.streams).add(report.moments);
    packer.add(report.azimuthal_orders).add(report.iterations).add(report.error_estimate);
    packer.add(report.converged ? 1 : 0).add(report.method);
    return packer.numbers();
}

LayerSlice unpacked(const std::vector<double>& numbers) {
    NumberUnpacker unpacker(numbers);
    LayerSlice slice;
    slice.values = unpacker.list();
    slice.mie_error_estimate = unpacker.number();
    slice.error_estimate = unpacker.number();
    slice.converged = unpacker.number() == 1;
    slice.report.streams = static_cast<int>(unpacker.number());
    slice.report.moments = static_cast<int>(unpacker.number());
    slice.report.azimuthal_orders = static_cast<int>(unpacker.number());
    slice.report.iterations = static_cast<int>(unpacker.number());
    slice.report.error_estimate = unpacker.number();
    slice.report.converged = unpacker.number() == 1;
    slice.report.method = unpacker.text();
    return slice;
}

LayerSlice solve(const Request& request, const SceneOptics& optics, LayerQuantity quantity) {
    LayerSlice slice;
    if (quantity == LayerQuantity::reflection) {
        rte::ReflectionTable table =
            rte::reflect(optics.stack, request.directions, request.solver);
        slice.values = std::move(table.reflection);
        slice.report = table.report;
    } else {
        rte::AlbedoTable table =
            rte::albedo(optics.stack, request.directions.mu_in, request.solver);
        slice.values = std::move(table.plane_albedo);
        slice.values.push_back(table.spherical_albedo);
        slice.report = table.report;
    }
    slice.mie_error_estimate = optics.mie_error_estimate;
    slice.error_estimate = slice.report.error_estimate + optics.mie_error_estimate;
    slice.converged = slice.report.converged && optics.converged;
    return slice;
}

}  // namespace

std::vector<LayerSlice> compute_layers(const Request& request, const SceneMedia& media,
                                       LayerQuantity quantity, const RunControl& control) {
    std::vector<LayerSlice> slices(request.wavelength_nm.size());
    std::vector<std::string> hashes(slices.size());
    std::vector<std::size_t> missing;
    std::vector<double> missing_nm;
    for (std::size_t w = 0; w < slices.size(); ++w) {
        std::optional<std::vector<double>> known;
        if (control.cache != nullptr) {
            hashes[w] = hash_of(request, media, quantity, request.wavelength_nm[w]);
            known = control.cache->find(hashes[w]);
        }
        if (known) {
            slices[w] = unpacked(*known);
        } else {
            missing.push_back(w);
            missing_nm.push_back(request.wavelength_nm[w]);
        }
    }
    const PhaseDemand phase = quantity == LayerQuantity::reflection ? PhaseDemand::whole
                                                                    : PhaseDemand::moments_only;
    const auto optics = media.optics(missing_nm, demand_of(request, phase), control);
    run_parallel("radiative transfer", missing.size(), control, [&](std::size_t i) {
        const std::size_t w = missing[i];
        slices[w] = solve(request, optics[i], quantity);
        if (control.cache != nullptr) control.cache->store(hashes[w], packed(slices[w]));
    });
    return slices;
}

}  // namespace miebrdf
