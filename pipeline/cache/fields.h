// The fields of the types that results depend on or consist of, each listed once: cache keys and
// stored results are made from these lists. A field that is added to a type and not here does not
// compile, because a structured binding names as many as there are. Private types have their list
// beside them.
#pragma once

#include <miebrdf/brdf.h>
#include <miebrdf/ensemble.h>
#include <miebrdf/index.h>
#include <miebrdf/scene.h>
#include <miebrdf/solver.h>

#include <concepts>
#include <tuple>
#include <type_traits>

namespace miebrdf {

/// T or const T: reading a stored result writes the fields that making a key reads.
template <typename Any, typename T>
concept Is = std::same_as<std::remove_const_t<Any>, T>;

template <Is<mie::SizeDistribution> T>
auto fields(T& value) {
    auto& [kind, radius, variance, radii, density, exponent] = value;
    return std::tie(kind, radius, variance, radii, density, exponent);
}

template <Is<mie::ParticleCoating> T>
auto fields(T& value) {
    auto& [refractive_index, thickness_um, share_of_radius] = value;
    return std::tie(refractive_index, thickness_um, share_of_radius);
}

template <Is<GrainShape> T>
auto fields(T& value) {
    auto& [kind, aspect, asymmetry, absorption, by_t_matrix] = value;
    return std::tie(kind, aspect, asymmetry, absorption, by_t_matrix);
}

template <Is<MatrixExpansion> T>
auto fields(T& value) {
    auto& [a2, a3, a4, b1, b2] = value;
    return std::tie(a2, a3, a4, b1, b2);
}

template <Is<materials::IndexOptions> T>
auto fields(T& value) {
    auto& [interpolation, extrapolation, missing_k_is_zero] = value;
    return std::tie(interpolation, extrapolation, missing_k_is_zero);
}

template <Is<rte::Boundary> T>
auto fields(T& value) {
    auto& [roughness, distribution, matrices] = value;
    return std::tie(roughness, distribution, matrices);
}

template <Is<rte::SurfaceOptions> T>
auto fields(T& value) {
    auto& [alpha, distribution, shadowing, fresnel, shadowing_distribution] = value;
    return std::tie(alpha, distribution, shadowing, fresnel, shadowing_distribution);
}

template <Is<rte::SolverOptions> T>
auto fields(T& value) {
    auto& [tolerance, grid, streams, half_space, coat, substeps, delta_m, correction, stokes] =
        value;
    return std::tie(tolerance, grid, streams, half_space, coat, substeps, delta_m, correction,
                    stokes);
}

template <Is<rte::Directions> T>
auto fields(T& value) {
    auto& [mu_in, mu_out, azimuth_deg] = value;
    return std::tie(mu_in, mu_out, azimuth_deg);
}

template <Is<rte::SolverReport> T>
auto fields(T& value) {
    auto& [streams, moments, orders, iterations, error, share, worst, mu_in, mu_out, azimuth,
           converged, method] = value;
    return std::tie(streams, moments, orders, iterations, error, share, worst, mu_in, mu_out,
                    azimuth, converged, method);
}

template <Is<PhaseNoise> T>
auto fields(T& value) {
    auto& [largest, mu_in, mu_out, azimuth] = value;
    return std::tie(largest, mu_in, mu_out, azimuth);
}

template <Is<WavelengthReport> T>
auto fields(T& value) {
    auto& [wavelength_nm, solver, depths, mie_error, noise, stokes, left_out, error, converged] =
        value;
    return std::tie(wavelength_nm, solver, depths, mie_error, noise, stokes, left_out, error,
                    converged);
}

template <typename T>
concept HasFields = requires(T& value) {
    fields(value);
};

}  // namespace miebrdf
