// A scene at one wavelength, solved once and then evaluated at any directions.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include <miebrdf/surface.h>
#include "pipeline/solve/brdf_source.h"
#include "pipeline/solve/scene_optics.h"
#include "pipeline/solve/smooth_part.h"
#include "rte/first_order/first_order.h"

namespace miebrdf::exports {

/// Which part of the BRDF is exported.
enum class Component { total, subsurface, surface };

/// Light scattered more than once is smooth and comes from a table (SmoothPart). What has sharp
/// features, the first order of scattering (FirstOrder) and the surface lobe, is evaluated exactly
/// at every direction. The BRDF is the sum of all.
class WavelengthSolution {
  public:
    /// @param surface_index  n + ik of a rough surface on top; empty: there is none
    WavelengthSolution(const SceneOptics& optics, std::optional<std::complex<double>> surface_index,
                       const Request& request, Component component);

    /// The surface's transmission included.
    const SmoothPart& smooth() const { return smooth_; }
    /// What scatters light once, without the surface; empty for the surface alone.
    const std::vector<rte::ScaledMedium>& media() const { return media_; }
    /// When their first order has been tabulated.
    void drop_media() { media_.clear(); }

    /// The surface lobe's BRDF; 0 without one.
    double lobe(const Direction& direction) const;
    /// What the surface lets through of light from below; 1 without one.
    double transmitted(double mu_in, double mu_out) const;
    bool has_surface() const { return lobe_.has_value(); }

    const rte::SolverReport& report() const { return report_; }
    /// Where the solver's error estimate is largest, among the directions that it was asked for.
    Direction worst_direction() const;

  private:
    void solve(const SceneOptics& optics, const Request& request);

    std::vector<rte::ScaledMedium> media_;
    SmoothPart smooth_;
    std::optional<rte::SurfaceLobe> lobe_;
    std::vector<double> factor_in_, factor_out_;  ///< of the surface, at the nodes
    rte::SolverReport report_;
};

/// Adds a smooth part to values of the BRDF at directions that share their cosines.
void add_smooth(const SmoothPart& smooth, std::span<const Direction> directions, double* values,
                std::size_t stride);

}  // namespace miebrdf::exports
