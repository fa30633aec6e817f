// A scene at one wavelength, solved once and then evaluated at any directions.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "pipeline/exports/brdf_source.h"
#include "pipeline/scene_optics.h"
#include "rte/layered_brdf.h"
#include "rte/narrow_features.h"
#include "rte/single_scattering.h"

namespace miebrdf::exports {

/// Which part of the BRDF is exported.
enum class Component { total, subsurface, surface };

/// Light scattered more than once is smooth: (mu_in + mu_out) R^m is taken from the solver on the
/// cosines sin^2(pi x / 2), x = 0, 1/48, ..., 1, and interpolated between them in x by sixth-order
/// Lagrange polynomials; at these cosines nothing is interpolated. What has sharp features, the
/// first order of scattering and the surface lobe, is evaluated exactly at every direction.
class WavelengthSolution {
  public:
    /// @param surface_index  n + ik of a rough surface on top; empty: there is none
    WavelengthSolution(const SceneOptics& optics, std::optional<std::complex<double>> surface_index,
                       const Request& request, Component component);

    /// BRDF at consecutive directions; those that share their cosines are done together.
    /// @param stride  distance between values of consecutive directions
    void evaluate(std::span<const Direction> directions, double* values, std::size_t stride) const;

    const rte::SolverReport& report() const { return report_; }

  private:
    static constexpr int kIntervals = 48;

    void solve(const SceneOptics& optics, const Request& request);
    /// How many directions from the first on share its cosines.
    static std::size_t same_pair(std::span<const Direction> directions);
    /// Adds what the surface lets through of the layers, for directions that share their cosines.
    void add_layers(std::span<const Direction> directions, double* values,
                    std::size_t stride) const;
    /// Fourier coefficients of the multiply scattered part at a pair, R^0 + sum a_m cos(m azimuth).
    void series_at(double mu_in, double mu_out, std::vector<double>& series) const;

    Component component_;
    bool exact_first_order_ = true;
    std::vector<rte::ScaledMedium> media_;
    rte::NarrowFeatures narrow_;
    std::size_t orders_ = 0;
    std::vector<double> modes_;  ///< [(i * (kIntervals + 1) + o) * orders_ + m], (mu + mu') a_m
    std::optional<rte::SurfaceLobe> lobe_;
    std::vector<double> factor_in_, factor_out_;  ///< of the surface, at the nodes
    rte::SolverReport report_;
};

}  // namespace miebrdf::exports
