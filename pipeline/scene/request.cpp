#include "pipeline/scene/request.h"

#include <fmt/format.h>

#include <cmath>

#include <miebrdf/error.h>

namespace miebrdf {
namespace {

void require_cosines(const std::vector<double>& cosines, const char* name) {
    for (const double mu : cosines) {
        if (!(mu > 0.0 && mu <= 1.0)) {
            throw UsageError(fmt::format("{}: {} is out of range; allowed: (0, 1]", name, mu));
        }
    }
}

void require_positive(double value, const char* name) {
    if (!(value > 0.0 && std::isfinite(value))) {
        throw UsageError(
            fmt::format("{}: {} is out of range; allowed: finite and > 0", name, value));
    }
}

void validate_sizes(const Medium& medium, const ParticleOptions& of_scene) {
    const LayerSizes own = sizes_of(medium);
    validate(own, describe(medium));
    // Radius and variance of a table are its own: another number would change nothing.
    if (of_scene.sizes.kind == mie::SizeDistributionKind::tabulated && own != LayerSizes{} &&
        !own.distribution) {
        throw UsageError(
            fmt::format("medium '{}': the scene's sizes are a table, so a layer with sizes of its "
                        "own needs a distribution, too",
                        describe(medium)));
    }
}

}  // namespace

void validate(const ParticleOptions& particles) {
    require_positive(particles.sizes.effective_radius_um, "--effective-radius (um)");
    if (particles.sizes.kind != mie::SizeDistributionKind::mono) {
        require_positive(particles.sizes.effective_variance, "--effective-variance");
    }
    require_positive(particles.host_index, "--host-index");
    if (!(particles.k_floor >= 0.0 && std::isfinite(particles.k_floor))) {
        throw UsageError(
            fmt::format("--k-floor: {} is out of range; allowed: >= 0", particles.k_floor));
    }
    if (!(particles.tolerance >= 0.0 && particles.tolerance < 1.0)) {
        throw UsageError(fmt::format("--mie-tolerance: {} is out of range; allowed: (0, 1)",
                                     particles.tolerance));
    }
}

void validate(const Request& request) {
    validate(request.scene.particles);
    validate_sizes(request.scene.base, request.scene.particles);
    for (const CoatMedium& coat : request.scene.coats)
        validate_sizes(coat.medium, request.scene.particles);
    for (const CoatMedium& coat : request.scene.coats) {
        if (!(coat.optical_depth >= 0.0)) {
            throw UsageError(fmt::format("coat {}: optical depth {} is out of range; allowed: >= 0",
                                         describe(coat.medium), coat.optical_depth));
        }
    }
    for (const double wavelength_nm : request.wavelength_nm) {
        require_positive(wavelength_nm, "--wavelengths (nm)");
    }
    if (request.wavelength_nm.empty()) throw UsageError("no wavelengths; write e.g. 400:700:10");
    require_cosines(request.directions.mu_in, "mu_in");
    require_cosines(request.directions.mu_out, "mu_out");
    for (const double azimuth : request.directions.azimuth_deg) {
        if (!(azimuth >= -360.0 && azimuth <= 360.0)) {
            throw UsageError(
                fmt::format("azimuth: {} is out of range; allowed: [-360, 360] degrees", azimuth));
        }
    }
    if (!(request.solver.tolerance > 0.0 && request.solver.tolerance < 1.0)) {
        throw UsageError(fmt::format("--tolerance: {} is out of range; allowed: (0, 1)",
                                     request.solver.tolerance));
    }
    const int streams = request.solver.streams;
    if (!(streams == 0 || (streams >= rte::kFewestNodes && streams <= rte::kMostNodes))) {
        throw UsageError(fmt::format("--streams: {} is out of range; allowed: {} to {}", streams,
                                     rte::kFewestNodes, rte::kMostNodes));
    }
    if (!(request.solver.coat_substeps >= 1 && request.solver.coat_substeps <= 1'000'000)) {
        throw UsageError(fmt::format("coat substeps: {} is out of range; allowed: 1 to 1000000",
                                     request.solver.coat_substeps));
    }
}

const Medium& top_medium(const Scene& scene) {
    return scene.coats.empty() ? scene.base : scene.coats.back().medium;
}

}  // namespace miebrdf
