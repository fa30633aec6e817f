// Tables that programs for satellites load: MAT-files of ISOFIT's surfaces, CRTM's table of snow.
//
// ISOFIT 4.1 (isofit/surface): `lut_surface` reads reflectances over a grid of states and of the
// angles SOLZEN and VIEWZEN in degrees, `multicomponent_surface` means and covariances of spectra.
// CRTM 3.2 (VISsnowCoeff, its issue 323): `Reflectance(n_Densities, n_Depths, n_Grain_Sizes,
// n_Frequencies, n_Angles)` over kg/m3, m, um, cm-1 and degrees, interpolated between four nodes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pipeline/sweep/layout.h"
#include "pipeline/sweep/table_writer.h"

namespace miebrdf::sweep {

/// @throws UsageError  for outputs and axes that the layout of the sweep has not
void require_satellite_axes(const Sweep& sweep);

inline bool is_mat_file(const Sweep& sweep) {
    return sweep.table_layout == TableLayout::isofit ||
           sweep.table_layout == TableLayout::isofit_surface;
}

/// A table of one output that is written when all of it is there.
class GatheredTable : public TableWriter {
  public:
    /// @param sweep, layout  must outlive the table
    GatheredTable(const Sweep& sweep, const Layout& layout) : sweep_(sweep), layout_(layout) {}
    void add(std::size_t first_scene, const std::vector<SceneResult>& results) override;

  protected:
    /// The output over these axes, the slowest first; axes that are left out have one value.
    std::vector<double> over(const std::vector<const Axis*>& axes) const;

    const Sweep& sweep_;
    const Layout& layout_;
    std::vector<double> error_estimates_;  ///< of each scene

  private:
    std::vector<double> values_;  ///< record after record
};

/// @throws InputError  when the file cannot be made
std::unique_ptr<TableWriter> make_isofit_writer(const Sweep& sweep, const Layout& layout,
                                                const std::string& file);

/// The identity of the sweep that a MAT-file is of; empty if it is none.
std::string identity_of_mat(const std::string& file);

}  // namespace miebrdf::sweep
