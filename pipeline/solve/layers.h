// The layers of a scene without its surface, wavelength by wavelength: looked up in the cache or
// solved by Mie theory and radiative transfer.
#pragma once

#include <miebrdf/brdf.h>

#include <string>
#include <vector>

#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

enum class LayerQuantity {
    reflection,  ///< R at all combinations of the directions
    mueller,     ///< Mueller matrices there (rte::ReflectionTable)
    albedo,      ///< plane albedo at mu_in, then the spherical albedo
    /// Albedos of the light that the scene's surface lets in, and of what it lets out again
    /// (rte::SurfaceTransmission).
    albedo_through_surface,
};

/// The quantity of the layers that an albedo needs.
LayerQuantity albedo_quantity(const ResolvedScene& scene);
/// Values at directions, not albedos.
bool is_reflection(LayerQuantity quantity);
/// Albedos need moments only.
PhaseDemand phase_demand(LayerQuantity quantity);

/// A scene's layers, and what is wanted of them.
struct LayerRequest {
    const ResolvedScene& scene;
    Directions directions;
    SolverOptions solver;
    LayerQuantity quantity = LayerQuantity::reflection;
    bool keeps_errors = false;  ///< LayerSlice::errors
};

/// The tolerance for layers that are taken as hidden (visible_optics). It is 0 where transmittance
/// into a ground is wanted: then only layers that transmit nothing hide it.
double tolerance_of_hiding(const LayerRequest& request);

/// Nodes that the solver begins with, whatever Mie theory leaves it of the tolerance (at least
/// half).
int streams_of_first_pass(const LayerRequest& request);
/// The demand of those first nodes: moments of Mie theory cost more than the square of their
/// number, and few media need more nodes.
/// @param whole  what any number of nodes could make use of
OpticsDemand first_demand(const LayerRequest& request, const OpticsDemand& whole);

/// Wavelengths that need solving, each once.
struct LayerJob {
    std::size_t wavelength = 0;  ///< index of the first one that it serves
    std::string hash;            ///< names everything its result depends on
    bool closed_form = false;    ///< albedos of layers that absorb nothing: nothing to solve
};
struct LayerJobs {
    std::vector<LayerJob> jobs;
    std::vector<std::size_t> serving;  ///< [wavelength of the scene]: its job
};
/// @param request  its directions as the solver gets them (distinct_directions.h)
LayerJobs list_layer_jobs(const LayerRequest& request);

struct LayerSlice {
    /// The quantity itself. R and Mueller matrices at the directions, laid out as
    /// BrdfValues::Slice; of albedos, the plane albedo at each mu_in, then the spherical albedo.
    std::vector<double> values;
    /// At mu_in, beside `reflection` and `mueller`.
    std::vector<double> plane_albedo;
    /// Of `albedo`: net flux into the substrate over the incident flux, at each mu_in, then of
    /// uniform light.
    std::vector<double> transmittance;
    /// Of `albedo`: the part of the transmittance that is not scattered, at each mu_in.
    std::vector<double> unscattered_transmittance;
    std::vector<double> mirror_reflectance;  ///< at mu_in (matrices with `mueller`); empty: none
    /// Change of the plane albedo at mu_in for light that is polarised in the plane of incidence.
    /// Empty: not computed.
    std::vector<double> polarised_plane_albedo;
    /// Of `reflection`, each value's, relative to the largest at its incidence. Empty: not kept.
    std::vector<double> errors;
    WavelengthReport report;
};

class DistinctDirections;

/// A slice at the distinct directions, copied to all requested directions.
LayerSlice spread(LayerSlice slice, const DistinctDirections& distinct, LayerQuantity quantity);

/// The highest moment that so many nodes make use of.
int moments_of_nodes(int streams);

/// Whether the solution uses all moments of `demand`, while its nodes could use more and a medium
/// has them: these may change R.
bool lacks_moments(const OpticsDemand& demand, const WavelengthReport& solved,
                   const rte::Stack& stack);

/// One slice for each wavelength; wavelengths whose layers are the same (repeated, or of media that
/// do not change with it) are computed once. With control.cache, slices are stored as soon as they
/// are known: a run that is stopped keeps what it has done.
/// @throws UsageError, Cancelled
std::vector<LayerSlice> compute_layers(const LayerRequest& request, const Control& control);

/// Slices of a request for no values: one for each wavelength, converged.
std::vector<LayerSlice> without_values(const ResolvedScene& scene);

}  // namespace miebrdf
