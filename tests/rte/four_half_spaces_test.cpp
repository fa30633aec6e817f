// Four Fourier orders of a half-space side by side.
#include "rte/half_space/four_half_spaces.h"
#include "rte/fourier/eigenmodes.h"
#include "rte/half_space/half_space.h"
#include "rte/half_space/sweeps.h"
#include "rte/phase/scaled_medium.h"
#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

struct Problem {
    int moments;
    rte::ZenithGrid grid;
    rte::ScaledOptics scaled;
    rte::RequestedDirections requested;
    rte::LegendreSampling sampling = {};
    rte::FourierMode mode = {};
    rte::FourierMedium medium = {};

    Problem(const rte::Optics& optics, int nodes, int moments_kept)
        : moments(moments_kept),
          grid(rte::make_mapped_gauss_grid(nodes)),
          scaled(rte::scale_optics(optics, moments, true)),
          requested(rte::collect({0.05, 0.3, 1.0, 0.3}, {0.1, 0.3, 0.5, 0.7, 0.95})) {}

    void set(int order) {
        rte::make_fourier_mode(order, moments, grid, requested, sampling, mode);
        medium = {scaled.strengths().tail(moments - order), scaled.one_minus_albedo, order};
    }
};

// From `first` on until the degrees end or an order is too slow.
rte::FourHalfSpaces solve_four(Problem& problem, int first, double tolerance) {
    rte::FourHalfSpaces four;
    rte::FourierWork work;
    if (!four.begin(first, problem.grid.size(), problem.requested)) return four;
    for (int m = first; m < std::min(problem.moments, first + 4); ++m) {
        problem.set(m);
        rte::form_sides(problem.medium, problem.mode, problem.grid, work);
        if (!four.add(problem.medium, tolerance, work)) return four;
    }
    four.solve(problem.requested, work);
    return four;
}

bool has_four_doubles(Problem& problem) {
    rte::FourHalfSpaces four;
    if (four.begin(1, problem.grid.size(), problem.requested)) return true;
    WARN("skipped: this processor's registers do not hold four doubles");
    return false;
}

}  // namespace

TEST_CASE("four Fourier orders side by side are what eigenmodes find", "[rte][half_space]") {
    const int nodes = GENERATE(2, 5, 8, 12, 16);
    const double albedo = GENERATE(0.3, 0.99, 1.0);
    const double tolerance = GENERATE(1e-4, 1e-9);
    Problem problem(rte::henyey_greenstein_optics(albedo, 0.6), nodes, 3 * nodes);
    if (!has_four_doubles(problem)) return;
    int found = 0;
    for (int first = 1; first < problem.moments; first += 4) {
        const rte::FourHalfSpaces four = solve_four(problem, first, tolerance);
        for (int m = first; m < std::min(problem.moments, first + 4); ++m) {
            const Eigen::MatrixXd* multiple = four.multiple(m);
            if (multiple == nullptr) continue;
            ++found;
            problem.set(m);
            // Eigenmodes, to rounding.
            const rte::Reflector one =
                rte::solve_half_space(rte::HalfSpaceMethod::automatic, problem.medium, problem.mode,
                                      problem.grid, problem.requested, 1e-15);
            double largest = 0.0, once = 0.0;
            for (std::size_t i = 0; i < problem.requested.in.size(); ++i) {
                for (std::size_t o = 0; o < problem.requested.out.size(); ++o) {
                    const double sum = problem.requested.mu[problem.requested.in[i]] +
                                       problem.requested.mu[problem.requested.out[o]];
                    const auto row = Eigen::Index(o), column = Eigen::Index(i);
                    largest = std::max(
                        largest,
                        4.0 * sum * std::abs((*multiple)(row, column) - one.multiple(row, column)));
                }
            }
            // What the tolerance is relative to: light scattered once.
            const Eigen::MatrixXd single = problem.mode.at_nodes *
                                           rte::alternating(problem.medium.strengths).asDiagonal() *
                                           problem.mode.at_nodes.transpose();
            once = single.cwiseAbs().maxCoeff();
            CAPTURE(m, once);
            // Nodes and rows err by the tolerance each, and a pair is made of two rows.
            CHECK(largest <= 3.0 * tolerance * once + 1e-14);
        }
    }
    CHECK(found >= problem.moments - 5);  // the first four may take too many sweeps
}

TEST_CASE("orders that take many sweeps and large problems are left to eigenmodes",
          "[rte][half_space]") {
    Problem slow(rte::henyey_greenstein_optics(0.999, 0.9), 12, 48);
    if (!has_four_doubles(slow)) return;
    CHECK(solve_four(slow, 1, 1e-5).multiple(1) == nullptr);
    CHECK(solve_four(slow, 20, 1e-5).multiple(20) != nullptr);
    CHECK(solve_four(slow, 20, 1e-5).multiple(24) == nullptr);
    Problem large(rte::henyey_greenstein_optics(0.5, 0.5), rte::FourHalfSpaces::kMostNodes + 1, 20);
    CHECK(solve_four(large, 5, 1e-5).multiple(5) == nullptr);
}
