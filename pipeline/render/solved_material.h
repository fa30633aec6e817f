// Solved BRDFs as materials of a picture.
#pragma once

#include <miebrdf/brdf.h>

#include <span>

#include "pipeline/render/render_brdf.h"
#include "pipeline/solve/compact_table.h"

namespace miebrdf::render {

/// A CompactTable, with the narrow lobe that shows the mirror reflection of a smooth boundary.
class SolvedMaterial : public RenderBrdf {
  public:
    /// A picture's noise is seldom below a thousandth.
    static constexpr double kTolerance = 3e-4;

    /// @param tables  as of CompactTable
    explicit SolvedMaterial(std::span<const BrdfTable> tables,
                            const CompactOptions& options = {.tolerance = kTolerance,
                                                             .cosines = 49},
                            const Control& control = {})
        : table_(tables, options, control) {}

    std::size_t wavelengths() const override { return table_.wavelengths(); }
    void evaluate(double mu_in, double mu_out, double cos_azimuth,
                  std::span<double> brdf) const override;
    double lobe_alpha() const override { return table_.lobe() ? table_.lobe()->alpha : 0.0; }

    const CompactTable& table() const { return table_; }

  private:
    CompactTable table_;
};

/// Difference between a compact table and the exact BRDF at directions between the table's nodes,
/// relative to the largest value at that incidence and wavelength.
struct InterpolationError {
    double median = 0.0;
    double largest = 0.0;
};

/// Compares total BRDFs on 8 x 8 cosines from 0.05 to 0.98 and 7 azimuths, computed anew.
InterpolationError interpolation_error(const CompactTable& table, const Brdf& exact);

}  // namespace miebrdf::render
