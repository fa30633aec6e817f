// The surface's share of a BRDF at one wavelength: its lobe, and what it lets in and out.
#pragma once

#include <complex>
#include <vector>

#include "pipeline/cache/job_key.h"
#include "pipeline/scene/request.h"
#include "pipeline/solve/run_control.h"

namespace miebrdf {

struct SurfacePart {
    std::vector<double> lobe;  ///< R_s, laid out as in rte::ReflectionTable
    std::vector<double> in;    ///< share let in at each mu_in, 1 - rho
    std::vector<double> out;   ///< share let out at each mu_out
};

/// Adds everything that a scene's surface depends on; `index` is that of its medium.
void add_surface(JobKey& key, std::complex<double> index, const Scene& scene);

/// What of a surface part is needed.
enum class SurfaceDemand {
    lobe,   ///< the lobe alone: `in` and `out` stay empty
    whole,  ///< and what the surface lets in and out, an integral for each cosine
};

/// Looked up in control.cache, else computed and stored there; the lobe at half of the pairs where
/// mu_in and mu_out are the same list.
/// @param directions  distinct ones (distinct_directions.h)
SurfacePart surface_part(std::complex<double> index, const Scene& scene,
                         const rte::Directions& directions, SurfaceDemand demand,
                         const RunControl& control);

}  // namespace miebrdf
