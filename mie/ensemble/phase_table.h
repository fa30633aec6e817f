// A phase function known at graded angles: cheap at any angle, and the source of all its moments.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mie/ensemble/executor.h"

namespace miebrdf::mie {

/// P(cos Theta) of an ensemble as polynomials on panels of the scattering angle.
///
/// Panels are narrow forward and backward, where diffraction and glory have the scale pi / x, and
/// grow towards the sides; those whose polynomial does not converge are halved
/// (phase_tabulation.h). Copies and calls from several threads are safe; usable as
/// std::function<double(double)>.
class PhaseTable {
  public:
    static constexpr int panel_nodes = 8;  ///< Chebyshev points with both ends, in each panel

    /// What a table consists of, to be stored and made into a table again.
    struct Parts {
        std::vector<double> edges;     ///< radians, ascending from 0 to pi
        Eigen::MatrixXd coefficients;  ///< Chebyshev, panel_nodes x panels
        double mean = 1, interpolation_error = 0, size_error = 0;
        std::vector<double> noise;  ///< of each panel, relative to max(P, noise_floor); empty: 0
        double noise_floor = 0;
    };

    PhaseTable() = default;
    /// @throws std::invalid_argument  when edges and panels do not fit
    explicit PhaseTable(Parts parts);
    /// @param edges   of the panels, in radians, ascending from 0 to pi
    /// @param values  P at the nodes of each panel (nodes_of), one column per panel
    /// @param interpolation_error  relative to the largest P of the panel, the worst panel
    /// @param size_error  relative to P, from its finite number of sizes, the worst node
    /// @param noise  the same of each panel, rms over its nodes, relative to max(P, noise_floor)
    PhaseTable(std::vector<double> edges, const Eigen::MatrixXd& values, double interpolation_error,
               double size_error, std::vector<double> noise = {}, double noise_floor = 0);

    /// @param cos_theta  cosine of the scattering angle, taken as +-1 outside [-1, 1]
    double operator()(double cos_theta) const;
    /// What P there is expected to err by for its finite number of sizes (rms, absolute).
    double noise(double cos_theta) const;

    /// P averaged over the sphere before it was normalised; 1 but for the errors of the table.
    double mean() const { return parts_.mean; }
    double interpolation_error() const { return parts_.interpolation_error; }
    double size_error() const { return parts_.size_error; }
    int angle_count() const { return panel_nodes * (static_cast<int>(parts_.edges.size()) - 1); }
    const Parts& parts() const { return parts_; }

    /// chi_0 = 1 ... chi_highest: integrals of the polynomials against P_l by Gauss rules dense
    /// enough for order l. Absolute error about that of the table times the share of the light that
    /// it concerns; cost: highest_moment^2 steps of a recurrence, 8 at once.
    /// @param highest_moment  >= 0
    std::vector<double> moments(int highest_moment, const Executor& run = run_in_order) const;

    /// Angles in radians of the nodes of a panel, ascending from lower to upper.
    static std::vector<double> nodes_of(double lower, double upper);
    /// Chebyshev coefficients from the values at those nodes.
    static Eigen::VectorXd coefficients_of(const Eigen::VectorXd& values);

  private:
    std::size_t panel_at(double theta) const;
    double at_angle(double theta) const;

    Parts parts_;
};

}  // namespace miebrdf::mie
