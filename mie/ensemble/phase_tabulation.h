// Building a PhaseTable: which angles, how many sizes for each, and P there.
#pragma once

#include <complex>
#include <vector>

#include <miebrdf/sizes.h>
#include "mie/ensemble/executor.h"
#include "mie/ensemble/phase_panel.h"
#include "mie/ensemble/phase_table.h"
#include "mie/sizes/size_families.h"

namespace miebrdf::mie {

struct PhaseTabulationOptions {
    double interpolation_tolerance = 1e-3;  ///< relative to the largest P of each panel
    double size_tolerance = 1e-2;  ///< relative to max(P, floor), rms over the nodes of each panel
    double floor = 0;
    int first_moment = 0;  ///< lowest one that will be asked of the table
    /// Scattering efficiency of the average times the area share of the range, when known. 0: not.
    double scattering_efficiency = 0;
    double moment_tolerance = 1.0;  ///< absolute, of what each panel gives to a moment
};

/// Each panel of scattering angles takes levels of sizes (SizeFamilies) until the two families
/// agree within the tolerance: most panels need the first one only, interferences in step with a
/// family's spacing and some glories two or three. Panels whose polynomial has not converged (its
/// last two Chebyshev coefficients are above the tolerance and above the noise of the sizes) are
/// halved, and the halves start anew, together with all others of their generation. Neighbours
/// share the value at their common edge: that of the panel with more sizes.
///
/// Amplitudes are summed in single precision: 1e-5 of P at worst, half the time.
class PhaseTabulation {
  public:
    /// Computes everything.
    PhaseTabulation(std::complex<double> relative_index, const SizeDistribution& distribution,
                    const RadiusRange& range, double wave_number_per_um,
                    const PhaseTabulationOptions& options, const Executor& run);

    PhaseTable table() const;
    /// Absolute error of the table's moments from options.first_moment to highest_moment.
    double moment_error(int highest_moment) const;

  private:
    PhaseTable table_of(int family) const;
    std::vector<PhasePanel> take_next();
    void add_level(std::vector<PhasePanel> panels);
    bool needs_more_sizes(const PhasePanel& panel) const;
    void sort_in(PhasePanel panel);

    SizeFamilies sizes_;
    PhaseTabulationOptions options_;
    const Executor& run_;
    int terms_;
    double narrowest_;  // panel, in radians
    std::vector<PhasePanel> active_, done_;
};

}  // namespace miebrdf::mie
