// One Fourier order of a medium, ready for the solvers of half-spaces and of layers.
#pragma once

#include <Eigen/Core>

#include <utility>
#include <vector>

#include "rte/fourier/eigenmodes.h"
#include "rte/half_space/half_space.h"
#include "rte/phase/scaled_medium.h"

namespace miebrdf::support {

struct FourierProblem {
    rte::ZenithGrid grid;
    rte::FourierMode mode;
    rte::FourierMedium medium;
    rte::RequestedDirections requested;
};

/// @param mu  requested, as directions of incidence and as outgoing ones
inline FourierProblem make_problem(const rte::Optics& optics, int order, rte::ZenithGrid grid,
                                   int moments, std::vector<double> mu) {
    FourierProblem problem{std::move(grid), {}, {}, {}};
    problem.requested.mu = Eigen::Map<Eigen::VectorXd>(mu.data(), Eigen::Index(mu.size()));
    for (int k = 0; k < int(mu.size()); ++k) {
        problem.requested.in.push_back(k);
        problem.requested.out.push_back(k);
    }
    const auto scaled = rte::scale_optics(optics, moments, true);
    rte::LegendreSampling sampling;
    rte::make_fourier_mode(order, moments, problem.grid, problem.requested, sampling, problem.mode);
    problem.medium = {scaled.strengths().tail(moments - order), scaled.one_minus_albedo};
    return problem;
}

}  // namespace miebrdf::support
