// Building a PhaseTable: which angles, and P there, in passes over the sizes.
#pragma once

#include <complex>
#include <memory>
#include <vector>

#include "mie/angular_functions.h"
#include "mie/phase_table.h"
#include "mie/sphere_block.h"

namespace miebrdf::mie {

/// Intensities of the sizes with even and with odd place, at the angles of one pass.
struct PhaseHalves {
    Eigen::MatrixXd intensity;  ///< angles x 2
    double scattered[2] = {0, 0};
};

/// The first pass covers graded panels; each further one the halves of the panels that had not
/// converged, until none is left or panels are as narrow as the phase function can vary. A panel
/// has converged when its last Chebyshev coefficients are below the tolerance, or below the error
/// that the number of sizes leaves there: half the difference between the two halves of the sizes.
///
/// Amplitudes are summed in single precision: 1e-5 of P at worst, half the time.
class PhaseTabulation {
  public:
    /// @param size_parameters, weights  as for compute_spheres, equally good in both halves
    /// @param tolerance  of the interpolation, relative to the largest P of a panel
    PhaseTabulation(std::complex<double> relative_index, std::vector<double> size_parameters,
                    std::vector<double> weights, double tolerance);

    int chunk_count() const;
    PhaseHalves compute(int chunk) const;  ///< safe to call from several threads
    void merge(const PhaseHalves& chunk);  ///< in order
    bool finish_pass();                    ///< true if another pass is needed
    PhaseTable table() const;              ///< after the last pass

  private:
    struct Panel {
        double lower, upper;
        Eigen::VectorXd values;  // P at its nodes
    };

    void prepare(std::vector<Panel> panels);
    bool has_converged(Panel& panel, const Eigen::MatrixXd& intensity);

    std::complex<double> relative_index_;
    std::vector<double> size_parameters_, weights_;
    double tolerance_;
    double narrowest_;
    std::vector<Panel> active_, done_;
    AngularFunctionsOf<float> angular_;
    PhaseHalves sums_;
    double interpolation_error_ = 0, size_error_ = 0;
};

}  // namespace miebrdf::mie
