// Building a PhaseTable: which angles, how many sizes for each, and P there.
#pragma once

#include <complex>
#include <vector>

#include "mie/angular_functions.h"
#include "mie/executor.h"
#include "mie/phase_table.h"
#include "mie/size_distribution.h"

namespace miebrdf::mie {

struct PhaseTabulationOptions {
    double interpolation_tolerance = 1e-3;  ///< relative to the largest P of each panel
    double size_tolerance = 1e-2;           ///< relative to the largest P of each panel, rms
    int first_moment = 0;                   ///< lowest one that will be asked of the table
    /// Scattering efficiency of the average times the area share of the range, when known: sizes
    /// that miss it have missed resonances too narrow for two levels of them to tell. 0: not known.
    double scattering_efficiency = 0;
    double moment_tolerance = 1.0;  ///< absolute, of what each panel gives to a moment
};

/// Each panel of scattering angles takes levels of sizes (nested_size_nodes) until what the last
/// one changed is below the tolerance: a quarter of the spheres will do between 20 and 130 degrees
/// of what a glory wants. Panels whose polynomial has not converged (its last two Chebyshev
/// coefficients are above the tolerance and above the noise of the sizes) are halved, and the
/// halves start anew.
///
/// Sizes are spread in equal ratios: equal spacing meets, at some angles, the same phase of an
/// interference in all its sizes (n = 2.95 at 550 nm: single angles wrong by up to 80 %).
///
/// Amplitudes are summed in single precision: 1e-5 of P at worst, half the time.
class PhaseTabulation {
  public:
    /// Computes everything.
    PhaseTabulation(std::complex<double> relative_index, const SizeDistribution& distribution,
                    const RadiusRange& range, double wave_number_per_um,
                    const PhaseTabulationOptions& options, const Executor& run);

    PhaseTable table() const;
    /// Absolute error of the table's moments from the number of sizes: panels err independently.
    double moment_error() const;

  private:
    struct Panel {
        double lower, upper;
        int level = -1;          // last one that has been summed
        Eigen::MatrixXd halves;  // intensities of two independent halves of the sizes, nodes x 2
        double scattered[2] = {0, 0};
        double noise = 0, tail = 0;  // relative to the largest P: of sizes, of interpolation
        double light = 0;            // largest P times solid angle over 4 pi
    };
    struct Halves {
        Eigen::MatrixXd intensity;
        double scattered[2] = {0, 0};
    };

    void start_panels();
    std::vector<Panel> take_lowest();
    Halves sum_level(int level, const AngularFunctionsOf<float>& angular) const;
    void add_level(Panel& panel, const Eigen::MatrixXd& intensity, const Halves& halves) const;
    void judge(Panel& panel) const;
    double moment_share(const Panel& panel) const;
    bool needs_more_sizes(const Panel& panel) const;
    void sort_in(Panel panel);

    std::complex<double> relative_index_;
    const SizeDistribution& distribution_;
    RadiusRange range_;
    double wave_number_per_um_;
    PhaseTabulationOptions options_;
    const Executor& run_;
    double narrowest_;  // panel, in radians
    int first_count_ = 1, last_level_ = 0, resolved_level_ = 0;
    std::vector<Panel> active_, done_;
};

}  // namespace miebrdf::mie
