#include "rte/boundary/rough_top.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <list>
#include <mutex>
#include <utility>

#include "rte/boundary/facet_lobes.h"
#include "rte/fourier/fourier_mode.h"

namespace miebrdf::rte {
namespace {

// Orders are made for so many at once; most scenes need fewer.
constexpr int kFirstOrders = 12;
// 31 wavelengths with three numbers of nodes each.
constexpr std::size_t kMostKept = 100;

// Between these indices matrices follow a parabola, 3e-5 off at most. Closer to 1, where it would
// be 1e-4, they are followed; hosts are not found there.
constexpr double kFirstIndex = 1.2, kIndexStep = 0.01;
constexpr int kLastStep = 180;  // index 3

struct KeptBoundary {
    Boundary kind;
    std::shared_ptr<const RoughBoundary> boundary;
};

class KeptBoundaries {
  public:
    std::shared_ptr<const RoughBoundary> find(double index, const Boundary& kind,
                                              const RefractionGrid& grid, int orders) {
        const std::lock_guard lock(mutex_);
        const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const KeptBoundary& one) {
            return one.boundary->index() == index && one.kind == kind &&
                   one.boundary->grid() == grid && one.boundary->orders() >= orders;
        });
        if (found == kept_.end()) return nullptr;
        kept_.splice(kept_.begin(), kept_, found);
        return kept_.front().boundary;
    }

    void keep(KeptBoundary made) {
        const std::lock_guard lock(mutex_);
        kept_.push_front(std::move(made));
        if (kept_.size() > kMostKept) kept_.pop_back();
    }

  private:
    std::mutex mutex_;
    std::list<KeptBoundary> kept_;  // the last used first
};

std::shared_ptr<const RoughBoundary> between_steps(double index, Boundary kind, int streams,
                                                   int orders) {
    const int cell = int(std::floor((index - kFirstIndex) / (2 * kIndexStep)));
    const int first = std::clamp(2 * cell, 0, kLastStep - 2);
    kind.matrices = BoundaryMatrices::followed;
    std::array<std::shared_ptr<const RoughBoundary>, 3> neighbours;
    for (int k = 0; k < 3; ++k) {
        const double step = kFirstIndex + (first + k) * kIndexStep;
        neighbours[std::size_t(k)] =
            shared_rough_boundary(step, kind, RefractionGrid({step}, streams), orders);
    }
    return std::make_shared<const RoughBoundary>(index, std::move(neighbours));
}

}  // namespace

std::shared_ptr<const RoughBoundary> shared_rough_boundary(double index, const Boundary& kind,
                                                           const RefractionGrid& grid, int orders) {
    static KeptBoundaries kept;
    if (auto known = kept.find(index, kind, grid, orders)) return known;
    const RoughSurface surface{kind.roughness, kind.distribution};
    // Panels of several media move with each of their indices.
    const bool is_one_medium = grid.panels().size() == 2;
    const bool is_interpolated =
        kind.matrices == BoundaryMatrices::interpolated && is_one_medium && index >= kFirstIndex;
    auto made = is_interpolated
                    ? between_steps(index, kind, int(grid.size()), orders)
                    : std::make_shared<const RoughBoundary>(index, surface, grid, orders);
    kept.keep({kind, made});
    return made;
}

namespace {

// Facets know nothing of the medium's nodes.
constexpr int kStreamsOfLobes = 16;

std::shared_ptr<const RoughBoundary> boundary_of_lobes(double index, const Boundary& boundary) {
    return shared_rough_boundary(index, boundary, RefractionGrid({index}, kStreamsOfLobes), 1);
}

}  // namespace

Eigen::VectorXd outer_lobe_scale(double index, const Boundary& boundary,
                                 const Eigen::VectorXd& mu_air) {
    static std::mutex mutex;
    static std::list<
        std::pair<std::shared_ptr<const RoughBoundary>, std::shared_ptr<const OuterLobeScale>>>
        kept;
    const auto facets = boundary_of_lobes(index, boundary);
    std::shared_ptr<const OuterLobeScale> scale;
    {
        const std::lock_guard lock(mutex);
        auto found = std::find_if(kept.begin(), kept.end(),
                                  [&](const auto& one) { return one.first == facets; });
        if (found == kept.end()) {
            kept.emplace_front(facets, std::make_shared<const OuterLobeScale>(facets));
            if (kept.size() > kMostKept) kept.pop_back();
            found = kept.begin();
        }
        scale = found->second;
    }
    return scale->at(mu_air);
}

Eigen::VectorXd facet_compensation(double index, const Boundary& boundary,
                                   const Eigen::VectorXd& mu_air) {
    return boundary_of_lobes(index, boundary)->from_air(mu_air).compensation;
}

RoughTop::RoughTop(double index, const Boundary& boundary, const RefractionGrid& grid,
                   const RequestedDirections& requested, Eigen::VectorXd mirrored)
    : index_(index),
      kind_(boundary),
      grid_(grid),
      requested_(requested),
      mirrored_(std::move(mirrored)) {}

void RoughTop::need_orders(int count) {
    if (boundary_ != nullptr && boundary_->orders() >= count) return;
    // What a request at the zenith alone and an albedo need is order 0.
    int orders = boundary_ == nullptr && count == 1 ? 1 : kFirstOrders;
    while (orders < count) orders *= 2;
    boundary_ = shared_rough_boundary(index_, kind_, grid_, orders);
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
        const double spherical =
            boundary_->external_diffuse_reflectance() + 2.0 * n2 * enters.dot(seen * enters);
        result.sky_at_nodes = spherical * air;
    }
    if (result.has_transmittance) {
        const Eigen::VectorXd up = solver.solve(below.transmittance_at_nodes);
        result.transmittance_at_requested = entering * up;
        result.transmittance_at_nodes = 2.0 * n2 * enters.dot(up) * air;
    }
}

}  // namespace miebrdf::rte
