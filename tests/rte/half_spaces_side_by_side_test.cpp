// Four or eight Fourier orders of a half-space side by side.
#include "rte/half_space/half_spaces_side_by_side.h"
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

void solve_some(rte::HalfSpacesSideBySide& some, const Problem& problem, int first,
                double tolerance, double brightness = 0.0) {
    rte::FourierModes modes;
    rte::KernelsSideBySide kernels;
    const Eigen::VectorXd strengths = problem.scaled.strengths();
    some.solve(first, {.strengths = strengths,
                       .one_minus_albedo = problem.scaled.one_minus_albedo,
                       .brightness = brightness,
                       .grid = problem.grid,
                       .requested = problem.requested,
                       .tolerance = tolerance,
                       .orders = int(strengths.size()) - first,
                       .kernels = kernels,
                       .modes = modes});
}

bool has_registers(const Problem& problem) {
    rte::HalfSpacesSideBySide some;
    solve_some(some, problem, 1, 1e-3);
    if (some.multiple(1) != nullptr) return true;
    WARN("skipped: not compiled for registers that hold four doubles");
    return false;
}

}  // namespace

namespace {

// Largest 4 (mu + mu') |difference|: what the tolerance is for.
double largest_bounded_difference(const Problem& problem, const Eigen::MatrixXd& multiple,
                                  const Eigen::MatrixXd& other) {
    double largest = 0.0;
    for (std::size_t i = 0; i < problem.requested.in.size(); ++i) {
        for (std::size_t o = 0; o < problem.requested.out.size(); ++o) {
            const double sum = problem.requested.mu[problem.requested.in[i]] +
                               problem.requested.mu[problem.requested.out[o]];
            const auto row = Eigen::Index(o), column = Eigen::Index(i);
            largest =
                std::max(largest, 4.0 * sum * std::abs(multiple(row, column) - other(row, column)));
        }
    }
    return largest;
}

// What it is relative to: light scattered once between nodes.
double largest_single_scattering(const Problem& problem) {
    const Eigen::MatrixXd single = problem.mode.at_nodes *
                                   rte::alternating(problem.medium.strengths).asDiagonal() *
                                   problem.mode.at_nodes.transpose();
    return single.cwiseAbs().maxCoeff();
}

rte::Reflector solve_alone(const Problem& problem, double tolerance) {
    return rte::solve_half_space(rte::HalfSpaceMethod::automatic, problem.medium, problem.mode,
                                 problem.grid, problem.requested, tolerance);
}

}  // namespace

TEST_CASE("Fourier orders side by side are what eigenmodes find", "[rte][half_space]") {
    const int nodes = GENERATE(2, 5, 8, 12, 16, 21, 32, 61);
    if (nodes > rte::HalfSpacesSideBySide::most_nodes()) return;
    const double albedo = GENERATE(0.3, 0.99, 1.0);
    const double tolerance = GENERATE(1e-4, 1e-9);
    Problem problem(rte::henyey_greenstein_optics(albedo, 0.6), nodes, 3 * nodes);
    if (!has_registers(problem)) return;
    const int begin = GENERATE(0, 1);
    rte::HalfSpacesSideBySide some;
    int found = 0;
    for (int first = begin; first < problem.moments; first += 4) {
        solve_some(some, problem, first, tolerance);
        for (int m = first; m < std::min(problem.moments, first + 4); ++m) {
            const Eigen::MatrixXd* multiple = some.multiple(m);
            if (albedo == 1.0 && first == 0) {
                CHECK(multiple == nullptr);  // slow eigenmodes
                continue;
            }
            REQUIRE(multiple != nullptr);
            ++found;
            problem.set(m);
            // Eigenmodes, to rounding.
            const rte::Reflector one = solve_alone(problem, 1e-15);
            const double once = largest_single_scattering(problem);
            CAPTURE(m, once);
            // Nodes and rows err by the tolerance each, and a pair is made of two rows.
            CHECK(largest_bounded_difference(problem, *multiple, one.multiple) <=
                  3.0 * tolerance * once + 1e-14);
        }
    }
    CHECK(found >= problem.moments - 4);
}

TEST_CASE("beside order 0 higher orders side by side err by no more than each alone may",
          "[rte][half_space]") {
    const double albedo = GENERATE(0.9, 0.9999);
    const double tolerance = GENERATE(1e-3, 1e-6);
    const int nodes = 12;
    Problem problem(rte::henyey_greenstein_optics(albedo, 0.6), nodes, 4 * nodes);
    if (!has_registers(problem)) return;
    rte::HalfSpacesSideBySide some, alike;
    solve_some(some, problem, 0, tolerance);
    REQUIRE(some.multiple(0) != nullptr);
    const double brightness = some.brightness();
    REQUIRE(brightness > 0.0);
    int spared = 0;
    for (int first = 4; first < problem.moments; first += 4) {
        solve_some(some, problem, first, tolerance, brightness);
        solve_some(alike, problem, first, tolerance);
        for (int m = first; m < first + 4; ++m) {
            REQUIRE(some.multiple(m) != nullptr);
            problem.set(m);
            const rte::Reflector exact = solve_alone(problem, 1e-15);
            const double once = largest_single_scattering(problem);
            // As solve_half_space has it, for one order too.
            const double scale = std::max(once, 0.1 * brightness);
            problem.medium.brightness = brightness;
            const rte::Reflector one = solve_alone(problem, tolerance);
            CAPTURE(m, once, brightness);
            CHECK(largest_bounded_difference(problem, *some.multiple(m), exact.multiple) <=
                  3.0 * tolerance * scale + 1e-14);
            CHECK(largest_bounded_difference(problem, *some.multiple(m), one.multiple) <=
                  6.0 * tolerance * scale + 1e-14);
            if (*some.multiple(m) != *alike.multiple(m)) ++spared;
        }
    }
    CHECK(spared > 0);  // sweeps, by the tolerance of order 0
}

TEST_CASE("the last orders have fewer degrees than there are orders side by side",
          "[rte][half_space]") {
    // Four registers of eight are empty, then three of four.
    const int left = GENERATE(8, 5, 4, 1);
    Problem problem(rte::henyey_greenstein_optics(0.95, 0.8), 16, 40);
    if (!has_registers(problem)) return;
    rte::HalfSpacesSideBySide some;
    solve_some(some, problem, problem.moments - left, 1e-9);
    for (int m = problem.moments - left; m < problem.moments; ++m) {
        if (m >= problem.moments - left + 4 && some.multiple(m) == nullptr)
            continue;  // four at once
        REQUIRE(some.multiple(m) != nullptr);
        problem.set(m);
        CHECK(largest_bounded_difference(problem, *some.multiple(m),
                                         solve_alone(problem, 1e-15).multiple) <=
              3e-9 * largest_single_scattering(problem) + 1e-14);
    }
    CHECK(some.multiple(problem.moments) == nullptr);
}

TEST_CASE("few sweeps and means of matrices agree", "[rte][half_space]") {
    // Orders 6 to 9 take the one or the other by what the tolerance asks for.
    Problem problem(rte::henyey_greenstein_optics(0.9, 0.7), 12, 48);
    if (!has_registers(problem)) return;
    rte::HalfSpacesSideBySide loose, strict;
    solve_some(loose, problem, 6, 1e-3);
    solve_some(strict, problem, 6, 1e-12);
    for (int m = 6; m < 10; ++m) {
        const Eigen::MatrixXd difference = *loose.multiple(m) - *strict.multiple(m);
        CHECK(difference.cwiseAbs().maxCoeff() <= 3e-3 * strict.multiple(m)->cwiseAbs().maxCoeff());
    }
}

TEST_CASE("large problems are left to eigenmodes", "[rte][half_space]") {
    Problem problem(rte::henyey_greenstein_optics(0.5, 0.5),
                    rte::HalfSpacesSideBySide::most_nodes() + 1, 20);
    rte::HalfSpacesSideBySide some;
    solve_some(some, problem, 5, 1e-5);
    CHECK(some.multiple(5) == nullptr);
}

TEST_CASE("equations without a physical solution are left to eigenmodes", "[rte][half_space]") {
    // Far more point values than the nodes integrate: U and V are not positive definite.
    Problem problem(rte::henyey_greenstein_optics(0.999, 0.95), 4, 60);
    problem.grid.panels.clear();
    rte::HalfSpacesSideBySide some;
    solve_some(some, problem, 0, 1e-5);
    problem.set(0);
    const rte::Reflector one =
        rte::solve_half_space(rte::HalfSpaceMethod::automatic, problem.medium, problem.mode,
                              problem.grid, problem.requested, 1e-5);
    REQUIRE_FALSE(one.physical);
    CHECK(some.multiple(0) == nullptr);
}
