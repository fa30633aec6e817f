#include "rte/boundary/rough_top.h"

#include <Eigen/LU>
#include <algorithm>
#include <list>
#include <mutex>

#include "rte/fourier/fourier_mode.h"

namespace miebrdf::rte {
namespace {

// Orders are made for so many at once; most scenes need fewer.
constexpr int kFirstOrders = 12;
// 31 wavelengths with three numbers of nodes each.
constexpr std::size_t kMostKept = 100;

struct KeptBoundary {
    RoughSurface surface;
    int streams;
    std::shared_ptr<const RoughBoundary> boundary;
};

}  // namespace

std::shared_ptr<const RoughBoundary> shared_rough_boundary(double index,
                                                           const RoughSurface& surface, int streams,
                                                           int orders) {
    static std::mutex mutex;
    static std::list<KeptBoundary> kept;  // the last used first
    const auto is_wanted = [&](const KeptBoundary& one) {
        return one.boundary->index() == index && one.surface.alpha == surface.alpha &&
               one.surface.distribution == surface.distribution && one.streams == streams &&
               one.boundary->orders() >= orders;
    };
    {
        const std::lock_guard lock(mutex);
        const auto found = std::find_if(kept.begin(), kept.end(), is_wanted);
        if (found != kept.end()) {
            kept.splice(kept.begin(), kept, found);
            return kept.front().boundary;
        }
    }
    auto made = std::make_shared<const RoughBoundary>(index, surface, streams, orders);
    const std::lock_guard lock(mutex);
    kept.push_front({surface, streams, made});
    if (kept.size() > kMostKept) kept.pop_back();
    return made;
}

Eigen::VectorXd outer_lobe_scale(double index, const Boundary& boundary,
                                 const Eigen::VectorXd& mu_air) {
    // Facets know nothing of the medium's nodes.
    constexpr int streams = 16;
    const RoughSurface surface{boundary.roughness, boundary.distribution};
    return shared_rough_boundary(index, surface, streams, 1)->from_air(mu_air).lobe_scale;
}

RoughTop::RoughTop(double index, const Boundary& boundary, int streams,
                   const RequestedDirections& requested)
    : index_(index),
      surface_{boundary.roughness, boundary.distribution},
      streams_(streams),
      requested_(requested) {}

void RoughTop::need_orders(int count) {
    if (boundary_ != nullptr && boundary_->orders() >= count) return;
    // What a request at the zenith alone and an albedo need is order 0.
    int orders = boundary_ == nullptr && count == 1 ? 1 : kFirstOrders;
    while (orders < count) orders *= 2;
    boundary_ = shared_rough_boundary(index_, surface_, streams_, orders);
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
    math::ScratchMatrix out, in;
    gather_rows(entering, requested_.out, out);
    gather_rows(entering, requested_.in, in);
    result.multiple = (0.5 / n2) * (out * seen) * in.transpose();
    result.glow_at_nodes.resize(0);
    if (fourier_order > 0) return;
    result.specular = light_.outer_reflectance;
    const ZenithGrid medium = boundary_->grid().in_medium(index_);
    const Eigen::VectorXd air = flux_weights(boundary_->grid().in_medium(1.0));
    const Eigen::VectorXd D = flux_weights(medium);
    const Eigen::VectorXd enters = D - inside * D;  // of uniform light from air
    if (parts == ReflectorParts::sky) {
        result.sky_at_requested = entering * (seen * enters);
        const double spherical =
            boundary_->external_diffuse_reflectance() + 2.0 * n2 * enters.dot(seen * enters);
        result.sky_at_nodes = spherical * air;
    }
    if (below.glow_at_nodes.size() > 0) {
        const Eigen::VectorXd up = solver.solve(below.glow_at_nodes);
        result.glow_at_requested = entering * up;
        result.glow_at_nodes = 2.0 * n2 * enters.dot(up) * air;
    }
}

}  // namespace miebrdf::rte
