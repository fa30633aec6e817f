// A solved BRDF made fast for rays: many wavelengths at once, in single precision.
#pragma once

#include <miebrdf/brdf.h>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/render/first_order_table.h"
#include "pipeline/render/render_brdf.h"
#include "pipeline/render/surface_term.h"
#include "pipeline/solve/smooth_part.h"

namespace miebrdf {
class SharpPart;
}

namespace miebrdf::render {

/// Nodes of the table of light scattered more than once.
struct TableSize {
    int cosines = 49;   ///< of either direction (table_nodes.h); at least 4
    int azimuths = 33;  ///< from 0 to 180 degrees; at least 4
};

/// BrdfTable, sampled. (mu_in + mu_out) R of light scattered more than once, which is smooth and
/// bounded, is interpolated cubically in both cosines and azimuth (table_nodes.h); what has narrow
/// features, light scattered once and the surface lobe, is evaluated at the very directions
/// (first_order_table.h, surface_term.h). Under refracting boundaries and over mirrors light
/// scattered once is in the table as well. The mirror reflection of a smooth boundary becomes a
/// lobe of a slope parameter of 0.02.
class RayTable : public RenderBrdf {
  public:
    /// @param tables  one, or several that differ in media and share their surface options; their
    ///                wavelengths are joined in order
    /// @throws UsageError  for sizes out of range and an empty list; InputError when a wavelength
    ///         has no physical solution
    explicit RayTable(const std::vector<BrdfTable>& tables, const TableSize& size = {});

    std::size_t wavelengths() const override { return wavelength_nm_.size(); }
    void evaluate(double mu_in, double mu_out, double cos_azimuth,
                  std::span<double> brdf) const override;
    double lobe_alpha() const override;

    const std::vector<double>& wavelength_nm() const { return wavelength_nm_; }

  private:
    using ScatteredOnce =
        std::function<void(double mu_in, double mu_out, std::span<const double> cos_azimuth,
                           std::span<double> reflection)>;
    /// Neighbours in the table, the same at all wavelengths.
    struct Place;
    Place place(double mu_in, double mu_out, double cos_azimuth) const;
    Lane multiple(const Place& place, std::size_t lane) const;
    Lane subsurface(const Place& place, std::size_t lane) const;
    static ScatteredOnce once_of(const SharpPart& sharp, std::size_t w);
    /// Column w of the table.
    /// @param once  R of light scattered once that the table is to hold too; empty: none
    void fill(std::size_t w, const SmoothPart& smooth, const ScatteredOnce& once,
              const std::vector<double>& cosines, const std::vector<double>& azimuth_deg);
    /// What a boundary reflects without letting it in, at every wavelength of the tables: a lobe, a
    /// very narrow one for the mirror reflection of a smooth boundary.
    void add_boundary(const std::vector<BrdfTable>& tables);

    std::vector<double> wavelength_nm_;
    BrdfPart part_ = BrdfPart::total;
    std::size_t cosines_ = 0;
    std::size_t azimuths_ = 0;
    std::size_t stride_ = 0;    ///< wavelengths, filled up to whole lanes
    std::vector<float> table_;  ///< [((i * cosines + o) * azimuths + a) * stride + w]
    std::optional<FirstOrderTable> first_order_;
    std::optional<SurfaceTerm> surface_;
};

/// Difference between a ray table and the exact BRDF at directions between the table's nodes,
/// relative to the largest value at that incidence and wavelength.
struct InterpolationError {
    double median = 0.0;
    double largest = 0.0;
};

/// Compares total BRDFs on 8 x 8 cosines from 0.05 to 0.98 and 7 azimuths, computed anew.
InterpolationError interpolation_error(const RayTable& table, const Brdf& exact);

}  // namespace miebrdf::render
