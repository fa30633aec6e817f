// The surface's share of a BRDF at one wavelength: its lobe, and what it lets in and out.
#pragma once

#include <miebrdf/brdf.h>

#include <vector>

#include "pipeline/solve/resolved_scene.h"

namespace miebrdf {

struct SurfacePart {
    std::vector<double> lobe;  ///< R_s, laid out as BrdfValues::Slice
    std::vector<double> in;    ///< share let in at each mu_in, 1 - rho
    std::vector<double> out;   ///< share let out at each mu_out
};

/// Adds everything that a scene's surface depends on at a wavelength.
void add_surface(JobKey& key, const ResolvedScene& scene, std::size_t w);

/// The parts of a surface that are needed.
enum class SurfaceDemand {
    lobe,   ///< the lobe alone: `in` and `out` stay empty
    whole,  ///< and what the surface lets in and out, an integral for each cosine
};

/// Remembered (remembered_numbers); repeated directions are computed
/// once, and the lobe at half of the pairs where mu_in and mu_out are the same list.
SurfacePart surface_part(const ResolvedScene& scene, std::size_t w, const Directions& directions,
                         SurfaceDemand demand, const Control& control);

/// Albedos of the layers as those of the whole, as eq. (5) adds them: rho + (1 - rho) A.
class SurfaceOverAlbedos {
  public:
    /// Of a scene with a surface.
    /// @param wavelengths  those that will be asked for
    SurfaceOverAlbedos(const ResolvedScene& scene, const std::vector<double>& mu_in,
                       const std::vector<std::size_t>& wavelengths, const Control& control);

    /// @param albedos  plane albedos at mu_in, then the spherical albedo, of the light that the
    ///                 surface lets in, counting what gets out again
    ///                 (LayerQuantity::albedo_through_surface)
    void add_to(std::size_t w, std::vector<double>& albedos) const;

  private:
    std::vector<std::vector<double>> rho_;  ///< [wavelength], of mu_in, then the mean's nodes
};

}  // namespace miebrdf
