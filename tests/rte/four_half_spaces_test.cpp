// Four Fourier orders of a half-space side by side.
#include "rte/half_space/four_half_spaces.h"
#include "rte/fourier/eigenmodes.h"
#include "rte/half_space/half_space.h"
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

void solve_four(rte::FourHalfSpaces& four, const Problem& problem, int first, double tolerance) {
    rte::FourierModes modes;
    const Eigen::VectorXd strengths = problem.scaled.strengths();
    four.solve(first,
               {.strengths = strengths,
                .one_minus_albedo = problem.scaled.one_minus_albedo,
                .brightness = 0.0,
                .grid = problem.grid,
                .requested = problem.requested,
                .tolerance = tolerance},
               modes);
}

bool has_four_doubles(const Problem& problem) {
    rte::FourHalfSpaces four;
    solve_four(four, problem, 1, 1e-3);
    if (four.multiple(1) != nullptr) return true;
    WARN("skipped: this processor's registers do not hold four doubles");
    return false;
}

}  // namespace

TEST_CASE("four Fourier orders side by side are what eigenmodes find", "[rte][half_space]") {
    const int nodes = GENERATE(2, 5, 8, 12, 16, 21, 32);
    const double albedo = GENERATE(0.3, 0.99, 1.0);
    const double tolerance = GENERATE(1e-4, 1e-9);
    Problem problem(rte::henyey_greenstein_optics(albedo, 0.6), nodes, 3 * nodes);
    if (!has_four_doubles(problem)) return;
    const int begin = GENERATE(0, 1);
    rte::FourHalfSpaces four;
    int found = 0;
    for (int first = begin; first < problem.moments; first += 4) {
        solve_four(four, problem, first, tolerance);
        for (int m = first; m < std::min(problem.moments, first + 4); ++m) {
            const Eigen::MatrixXd* multiple = four.multiple(m);
            if (albedo == 1.0 && first == 0) {
                CHECK(multiple == nullptr);  // slow eigenmodes
                continue;
            }
            REQUIRE(multiple != nullptr);
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
    CHECK(found >= problem.moments - 4);
}

TEST_CASE("order 0 of four is all of a half-space", "[rte][half_space]") {
    const double albedo = GENERATE(0.3, 0.99, 0.9999);
    Problem problem(rte::henyey_greenstein_optics(albedo, 0.6), 12, 36);
    if (!has_four_doubles(problem)) return;
    rte::FourHalfSpaces four;
    solve_four(four, problem, 0, 1e-9);
    REQUIRE(four.multiple(0) != nullptr);
    rte::Reflector found;
    const double brightness = four.order_zero(found);
    problem.set(0);
    rte::FourierWork work;
    rte::Reflector one;
    rte::solve_half_space(rte::HalfSpaceMethod::automatic, problem.medium, problem.mode,
                          problem.grid, problem.requested, 1e-15, work, one);
    CAPTURE(albedo);
    CHECK(brightness == Approx(work.brightness).epsilon(1e-8));
    CHECK((found.nodes - one.nodes).cwiseAbs().maxCoeff() <= 1e-8);
    CHECK((found.rows - one.rows).cwiseAbs().maxCoeff() <= 1e-8);
}

TEST_CASE("few sweeps and means of matrices agree", "[rte][half_space]") {
    // Orders 6 to 9 take the one or the other by what the tolerance asks for.
    Problem problem(rte::henyey_greenstein_optics(0.9, 0.7), 12, 48);
    if (!has_four_doubles(problem)) return;
    rte::FourHalfSpaces loose, strict;
    solve_four(loose, problem, 6, 1e-3);
    solve_four(strict, problem, 6, 1e-12);
    for (int m = 6; m < 10; ++m) {
        const Eigen::MatrixXd difference = *loose.multiple(m) - *strict.multiple(m);
        CHECK(difference.cwiseAbs().maxCoeff() <= 3e-3 * strict.multiple(m)->cwiseAbs().maxCoeff());
    }
}

TEST_CASE("large problems are left to eigenmodes", "[rte][half_space]") {
    Problem problem(rte::henyey_greenstein_optics(0.5, 0.5), rte::FourHalfSpaces::kMostNodes + 1,
                    20);
    rte::FourHalfSpaces four;
    solve_four(four, problem, 5, 1e-5);
    CHECK(four.multiple(5) == nullptr);
}

TEST_CASE("equations without a physical solution are left to eigenmodes", "[rte][half_space]") {
    // Far more point values than the nodes integrate: U and V are not positive definite.
    Problem problem(rte::henyey_greenstein_optics(0.999, 0.95), 4, 60);
    problem.grid.panels.clear();
    rte::FourHalfSpaces four;
    solve_four(four, problem, 0, 1e-5);
    problem.set(0);
    const rte::Reflector one =
        rte::solve_half_space(rte::HalfSpaceMethod::automatic, problem.medium, problem.mode,
                              problem.grid, problem.requested, 1e-5);
    REQUIRE_FALSE(one.physical);
    CHECK(four.multiple(0) == nullptr);
}
