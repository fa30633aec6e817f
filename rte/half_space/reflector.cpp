#include "rte/half_space/reflector.h"

namespace miebrdf::rte {

Eigen::VectorXd flux_weights(const ZenithGrid& grid) {
    return (grid.weights.array() * grid.mu.array()).sqrt();
}

void reflected_moments(const Eigen::Ref<const Eigen::VectorXd>& mu,
                       const Eigen::Ref<const Eigen::MatrixXd>& rows, const PhaseMode& mode,
                       math::ScratchMatrix& moments) {
    // 2 R W Y = (2 R D) (W/M)^(1/2) Y.
    moments.resize(rows.rows(), mode.scaled_nodes.cols());
    moments.noalias() = rows * mode.scaled_nodes;
    for (Eigen::Index c = 0; c < moments.cols(); ++c) {
        if (c % 2 == 0) {
            moments.col(c).array() *= mu.array();
        } else {
            moments.col(c).array() *= -mu.array();
        }
    }
}

math::ScratchMatrix reflected_moments(const Eigen::Ref<const Eigen::VectorXd>& mu,
                                      const Eigen::Ref<const Eigen::MatrixXd>& rows,
                                      const PhaseMode& mode) {
    math::ScratchMatrix moments;
    reflected_moments(mu, rows, mode, moments);
    return moments;
}

void no_reflection(const ZenithGrid& grid, const RequestedDirections& requested, Reflector& none) {
    none.nodes.setZero(grid.size(), grid.size());
    none.rows.setZero(requested.mu.size(), grid.size());
    none.multiple.setZero(Eigen::Index(requested.out.size()), Eigen::Index(requested.in.size()));
    none.iterations = 0;
    none.residual = 0.0;
    none.converged = none.physical = true;
}

void lambertian_ground(double albedo, const PhaseMode& mode, const ZenithGrid& grid,
                       const RequestedDirections& requested, Reflector& ground) {
    no_reflection(grid, requested, ground);
    if (mode.order > 0) return;
    const Eigen::VectorXd D = flux_weights(grid);
    // A rule that does not integrate mu exactly must still return the fraction `albedo` of the
    // flux.
    const double reflection = albedo * 0.5 / D.squaredNorm();
    ground.nodes = 2.0 * reflection * D * D.transpose();
    ground.rows = 2.0 * reflection * Eigen::VectorXd::Ones(requested.mu.size()) * D.transpose();
    ground.multiple.setConstant(albedo);
}

}  // namespace miebrdf::rte
