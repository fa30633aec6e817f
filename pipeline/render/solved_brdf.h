// Materials for the renderer from the solver: computed once on a table, then evaluated anywhere.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/render/first_order_table.h"
#include "pipeline/render/render_brdf.h"
#include "pipeline/render/surface_term.h"
#include "pipeline/scene/request.h"
#include "pipeline/solve/run_control.h"

namespace miebrdf::render {

/// Which part of a material is shown.
enum class Component { total, subsurface, surface };

/// Nodes of the table of light scattered more than once.
struct TableSize {
    int cosines = 49;   ///< of either direction (table_nodes.h); at least 4
    int azimuths = 33;  ///< from 0 to 180 degrees; at least 4
};

/// BRDF of a scene. (mu_in + mu_out) R of light scattered more than once, which is smooth and
/// bounded, is interpolated cubically in both cosines and azimuth (table_nodes.h); what has narrow
/// features, light scattered once and the surface lobe, is evaluated at the very directions
/// (first_order_table.h, surface_term.h).
class SolvedBrdf : public RenderBrdf {
  public:
    std::size_t wavelengths() const override { return wavelength_nm_.size(); }
    void evaluate(double mu_in, double mu_out, double cos_azimuth,
                  std::span<double> brdf) const override;
    double lobe_alpha() const override;

    const std::vector<double>& wavelength_nm() const { return wavelength_nm_; }
    bool converged() const { return converged_; }
    double error_estimate() const { return error_estimate_; }  ///< of the solver, not of the table
    const std::vector<std::string>& sources() const { return sources_; }

  private:
    friend class SolvedBrdfBuilder;
    /// Neighbours in the table, the same at all wavelengths.
    struct Place;
    Place place(double mu_in, double mu_out, double cos_azimuth) const;
    Lane multiple(const Place& place, std::size_t lane) const;
    Lane subsurface(const Place& place, std::size_t lane) const;

    std::vector<double> wavelength_nm_;
    Component component_ = Component::total;
    std::size_t cosines_ = 0;
    std::size_t azimuths_ = 0;
    std::size_t stride_ = 0;    ///< wavelengths, filled up to whole lanes
    std::vector<float> table_;  ///< [((i * cosines + o) * azimuths + a) * stride + w]
    std::optional<FirstOrderTable> first_order_;
    std::optional<SurfaceTerm> surface_;
    bool converged_ = true;
    double error_estimate_ = 0.0;
    std::vector<std::string> sources_;
};

/// Solves a material.
/// @param requests  one, or several that differ in media and share nothing but their surface
/// options;
///                  their wavelengths are joined in order. Directions are ignored.
/// @throws UsageError, InputError, Cancelled; InputError too when a wavelength has no physical
///         solution
std::shared_ptr<const SolvedBrdf> solve_brdf(std::vector<Request> requests, Component component,
                                             const TableSize& size = {},
                                             const RunControl& control = {});

/// Difference between a material and compute_brdf at directions between the table's nodes, relative
/// to the largest value at that incidence and wavelength.
struct InterpolationError {
    double median = 0.0;
    double largest = 0.0;
};

/// Compares total BRDFs on 8 x 8 cosines from 0.05 to 0.98 and 7 azimuths: computes those anew.
InterpolationError interpolation_error(const SolvedBrdf& brdf, Request request,
                                       const RunControl& control = {});

}  // namespace miebrdf::render
