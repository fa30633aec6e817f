#include "rte/phase_mode.h"

#include "rte/math/legendre.h"

namespace miebrdf::rte {
namespace {

void orthogonalise_to_lowest(const ZenithGrid& grid, PhaseMode& mode) {
    for (Eigen::Index lowest = 0; lowest < std::min<Eigen::Index>(2, mode.at_nodes.cols());
         ++lowest) {
        const Eigen::VectorXd weighted = mode.at_nodes.col(lowest).cwiseProduct(grid.weights);
        const double norm = weighted.dot(mode.at_nodes.col(lowest));
        for (Eigen::Index c = lowest + 2; c < mode.at_nodes.cols(); c += 2) {
            const double overlap = weighted.dot(mode.at_nodes.col(c)) / norm;
            mode.at_nodes.col(c) -= overlap * mode.at_nodes.col(lowest);
            mode.at_requested.col(c) -= overlap * mode.at_requested.col(lowest);
        }
    }
}

Eigen::VectorXd every_second(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index first) {
    const Eigen::Index count = (values.size() - first + 1) / 2;
    return values(Eigen::seqN(first, count, 2));
}

}  // namespace

void make_phase_mode(int order, int degrees, const ZenithGrid& grid,
                     const RequestedDirections& requested, PhaseMode& mode) {
    mode.order = order;
    math::legendre_functions(order, degrees, grid.mu, mode.at_nodes);
    math::legendre_functions(order, degrees, requested.mu, mode.at_requested);
    if (order == 0) orthogonalise_to_lowest(grid, mode);
    mode.scaled_nodes.noalias() =
        (grid.weights.array() / grid.mu.array()).sqrt().matrix().asDiagonal() * mode.at_nodes;
}

ColumnsOfOneParity even_columns(const Eigen::MatrixXd& table) {
    return {table.data(), table.rows(), (table.cols() + 1) / 2,
            Eigen::OuterStride<>(2 * table.rows())};
}

ColumnsOfOneParity odd_columns(const Eigen::MatrixXd& table) {
    return {table.data() + (table.cols() > 1 ? table.rows() : 0), table.rows(), table.cols() / 2,
            Eigen::OuterStride<>(2 * table.rows())};
}

Eigen::VectorXd even_part(const Eigen::Ref<const Eigen::VectorXd>& strengths) {
    return every_second(strengths, 0);
}

Eigen::VectorXd odd_part(const Eigen::Ref<const Eigen::VectorXd>& strengths) {
    return every_second(strengths, 1);
}

Eigen::VectorXd alternating(const Eigen::Ref<const Eigen::VectorXd>& strengths) {
    Eigen::VectorXd result = strengths;
    for (Eigen::Index c = 1; c < result.size(); c += 2) result[c] = -result[c];
    return result;
}

}  // namespace miebrdf::rte
