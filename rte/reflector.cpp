#include "rte/reflector.h"

namespace miebrdf::rte {

Eigen::VectorXd flux_weights(const ZenithGrid& grid) {
    return (grid.weights.array() * grid.mu.array()).sqrt();
}

Eigen::MatrixXd reflected_moments(const Eigen::Ref<const Eigen::VectorXd>& mu,
                                  const Eigen::Ref<const Eigen::MatrixXd>& rows,
                                  const PhaseMode& mode) {
    // 2 R W Y = (2 R D) (W/M)^(1/2) Y.
    Eigen::MatrixXd moments = mu.asDiagonal() * (rows * mode.scaled_nodes);
    for (Eigen::Index c = 1; c < moments.cols(); c += 2) moments.col(c) = -moments.col(c);
    return moments;
}

Reflector no_reflection(const ZenithGrid& grid, const RequestedDirections& requested) {
    Reflector none;
    none.nodes = Eigen::MatrixXd::Zero(grid.size(), grid.size());
    none.rows = Eigen::MatrixXd::Zero(requested.mu.size(), grid.size());
    none.multiple = Eigen::MatrixXd::Zero(Eigen::Index(requested.out.size()),
                                          Eigen::Index(requested.in.size()));
    none.physical = true;
    return none;
}

Reflector lambertian_ground(double albedo, const PhaseMode& mode, const ZenithGrid& grid,
                            const RequestedDirections& requested) {
    Reflector ground = no_reflection(grid, requested);
    if (mode.order > 0) return ground;
    const Eigen::VectorXd D = flux_weights(grid);
    // A rule that does not integrate mu exactly must still return the fraction `albedo` of the
    // flux.
    const double reflection = albedo * 0.5 / D.squaredNorm();
    ground.nodes = 2.0 * reflection * D * D.transpose();
    ground.rows = 2.0 * reflection * Eigen::VectorXd::Ones(requested.mu.size()) * D.transpose();
    ground.multiple.setConstant(albedo);
    return ground;
}

}  // namespace miebrdf::rte
