#include "pipeline/solve/packed_layers.h"

#include "pipeline/cache/packed_numbers.h"
#include "pipeline/solve/surface_part.h"

namespace miebrdf {

std::string layer_hash(const Request& request, const SceneMedia& media, LayerQuantity quantity,
                       double wavelength_nm) {
    const rte::SolverOptions& solver = request.solver;
    JobKey key("layers");
    key.add(static_cast<int>(quantity));
    if (quantity == LayerQuantity::albedo_through_surface) {
        add_surface(key, media.surface_index_at(wavelength_nm), request.scene);
    }
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
    packer.add(slice.values)
        .add(slice.plane_albedo)
        .add(slice.mie_error_estimate)
        .add(slice.error_estimate);
    const PhaseNoise& noise = slice.phase_noise;
    packer.add(noise.largest).add(noise.mu_in).add(noise.mu_out).add(noise.azimuth_deg);
    packer.add(slice.converged ? 1 : 0).add(report.streams).add(report.moments);
    packer.add(report.fourier_orders).add(report.iterations).add(report.error_estimate);
    packer.add(report.converged ? 1 : 0).add(report.method).add(report.share_within_tolerance);
    packer.add(report.worst_mu_in).add(report.worst_mu_out).add(report.worst_azimuth_deg);
    return packer.numbers();
}

LayerSlice unpacked_layers(const std::vector<double>& numbers) {
    NumberUnpacker unpacker(numbers);
    LayerSlice slice;
    slice.values = unpacker.list();
    slice.plane_albedo = unpacker.list();
    slice.mie_error_estimate = unpacker.number();
    slice.error_estimate = unpacker.number();
    slice.phase_noise.largest = unpacker.number();
    slice.phase_noise.mu_in = unpacker.number();
    slice.phase_noise.mu_out = unpacker.number();
    slice.phase_noise.azimuth_deg = unpacker.number();
    slice.converged = unpacker.number() == 1;
    slice.report.streams = static_cast<int>(unpacker.number());
    slice.report.moments = static_cast<int>(unpacker.number());
    slice.report.fourier_orders = static_cast<int>(unpacker.number());
    slice.report.iterations = static_cast<int>(unpacker.number());
    slice.report.error_estimate = unpacker.number();
    slice.report.converged = unpacker.number() == 1;
    slice.report.method = unpacker.text();
    slice.report.share_within_tolerance = unpacker.number();
    slice.report.worst_mu_in = unpacker.number();
    slice.report.worst_mu_out = unpacker.number();
    slice.report.worst_azimuth_deg = unpacker.number();
    return slice;
}

}  // namespace miebrdf
