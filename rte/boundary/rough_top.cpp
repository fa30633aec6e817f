#include "rte/boundary/rough_top.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "rte/fourier/fourier_mode.h"

namespace miebrdf::rte {
namespace {

// Orders are made for so many at once; most scenes need fewer.
constexpr int kFirstOrders = 12;
}  // namespace

RoughTop::RoughTop(RoughBoundaries& boundaries, double index, const Boundary& boundary,
                   const RefractionGrid& grid, const RequestedDirections& requested,
                   Eigen::VectorXd mirrored)
    : boundaries_(boundaries),
      index_(index),
      kind_(boundary),
      grid_(grid),
      requested_(requested),
      mirrored_(std::move(mirrored)) {}

void RoughTop::need_orders(int count) {
    if (boundary_ != nullptr && boundary_->orders() >= count) return;
    // What a request at the zenith alone and an albedo need is order 0.
    int orders = boundary_ == nullptr && count == 1 ? 1 : kFirstOrders;
    while (orders < count) orders *= 2;
    boundary_ = boundaries_.find(index_, kind_, grid_, orders);
    light_ = boundary_->from_air(requested_.mu);
}

void RoughTop::put_on(int fourier_order, const Reflector& below, ReflectorParts parts,
                      Reflector& result) {
    need_orders(fourier_order + 1);
    const Eigen::MatrixXd& X = below.nodes;
    const Eigen::MatrixXd& inside = boundary_->inside(fourier_order);
    const Eigen::MatrixXd& entering = light_.entering[std::size_t(fourier_order)];
    result.iterations = below.iterations;
    result.residual = below.residual;
    result.converged = below.converged;
    result.physical = below.physical;

    Eigen::MatrixXd returns = -X * inside;
    returns.diagonal().array() += 1.0;
    const Eigen::PartialPivLU<Eigen::MatrixXd> solver(returns);
    const Eigen::MatrixXd seen_once = solver.solve(X);  // (I - X Gamma)^-1 X
    const Eigen::MatrixXd seen = 0.5 * (seen_once + seen_once.transpose());
    const double n2 = index_ * index_;
    Eigen::MatrixXd out, in;
    gather_rows(entering, requested_.out, out);
    gather_rows(entering, requested_.in, in);
    result.multiple = (0.5 / n2) * (out * seen) * in.transpose();
    if (mirrored_.size() > 0) {
        const Eigen::MatrixXd& at_once = light_.entering_at_once[std::size_t(fourier_order)];
        gather_rows(at_once, requested_.out, out);
        gather_rows(at_once, requested_.in, in);
        result.multiple -= (0.5 / n2) * (out * mirrored_.asDiagonal()) * in.transpose();
    }
    result.has_transmittance = fourier_order == 0 && below.has_transmittance;
    if (fourier_order > 0) return;
    result.specular = light_.outer_reflectance;
    const ZenithGrid medium = boundary_->grid().in_medium(index_);
    const Eigen::VectorXd air = flux_weights(boundary_->grid().in_medium(1.0));
    const Eigen::VectorXd D = flux_weights(medium);
    const Eigen::VectorXd enters = D - inside * D;  // of uniform light from air
    if (parts == ReflectorParts::sky) {
        result.sky_at_requested = entering * (seen * enters);
        const double spherical = boundary_->external_diffuse_reflectance() +
                                 boundary_->sky_entering().dot(seen * enters);
        result.sky_at_nodes = spherical * air;
    }
    if (result.has_transmittance) {
        const Eigen::VectorXd up = solver.solve(below.transmittance_at_nodes);
        result.transmittance_at_requested = entering * up;
        result.transmittance_at_nodes = boundary_->sky_entering().dot(up) * air;
    }
}

}  // namespace miebrdf::rte
