// Stacks of layers in four or eight Fourier orders side by side.
#include <cmath>
#include <random>

#include "rte/stack/stack_side_by_side.h"
#include "rte/stack/stack_solver.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

/// A stack with what its solvers need.
struct Problem {
    rte::ScaledStack stack;
    rte::StackGrids grids;
    rte::RequestedDirections requested;
    double tolerance;
    rte::FourierModes modes = {};
    rte::KernelsSideBySide kernels = {};
    std::vector<double> brightness = {};

    Problem(const rte::Stack& of, int moments, int nodes, rte::RequestedDirections directions,
            double wanted)
        : stack(rte::scale_stack(of, moments, true)),
          grids(stack, rte::GridKind::mapped_gauss, nodes),
          requested(std::move(directions)),
          tolerance(wanted),
          brightness(stack.media.size(), 0.0) {
        stack.brightness = 1.0;
    }

    Eigen::VectorXd sky() const { return rte::flux_weights(grids.top()); }

    bool find(rte::StackSideBySide& some, int order, rte::Reflector& result, int orders = 1000) {
        const Eigen::VectorXd flux = sky();
        return some.find(order,
                         {.stack = stack,
                          .grid = grids.top(),
                          .requested = requested,
                          .tolerance = tolerance,
                          .orders = std::min(stack.moments - order, orders),
                          .wants_nodes = false,
                          .sky = flux,
                          .brightness = brightness,
                          .modes = modes,
                          .kernels = kernels},
                         result);
    }

    /// By eigenmodes: rows and nodes of an order are never found side by side.
    rte::Reflector solve_alone(int order) const {
        rte::StackMemory memory;
        rte::SolverOptions options;
        options.tolerance = 1e-12;
        rte::StackSolver solver(stack, grids, requested, options, memory);
        return solver.solve(order, rte::ReflectorParts::nodes);
    }

    /// Largest (mu + mu') |R| of the difference.
    double bounded_difference(const Eigen::MatrixXd& one, const Eigen::MatrixXd& other) const {
        double largest = 0.0;
        for (std::size_t i = 0; i < requested.in.size(); ++i) {
            for (std::size_t o = 0; o < requested.out.size(); ++o) {
                const auto row = Eigen::Index(o), column = Eigen::Index(i);
                const double sum = requested.mu[requested.in[i]] + requested.mu[requested.out[o]];
                largest = std::max(largest, sum * std::abs(one(row, column) - other(row, column)));
            }
        }
        return largest;
    }
};

bool has_registers() {
    if (rte::HalfSpacesSideBySide::lanes_of(8) > 0) return true;
    WARN("skipped: not compiled for registers that hold four doubles");
    return false;
}

rte::RequestedDirections some_directions() {
    return rte::collect({0.05, 0.3, 1.0, 0.3}, {0.1, 0.3, 0.5, 0.7, 0.95});
}

rte::Stack coated(rte::BaseKind base, double optical_depth) {
    rte::Stack stack;
    stack.base_kind = base;
    stack.base = rte::henyey_greenstein_optics(0.97, 0.6);
    stack.ground_albedo = 0.7;
    stack.coats = {{rte::henyey_greenstein_optics(0.9, 0.7), optical_depth}};
    return stack;
}

}  // namespace

TEST_CASE("coats in Fourier orders side by side are what eigenmodes find", "[rte][layer]") {
    if (!has_registers()) return;
    const auto base =
        GENERATE(rte::BaseKind::half_space, rte::BaseKind::lambertian, rte::BaseKind::none);
    const double optical_depth = GENERATE(1e-4, 0.1, 3.0, 60.0);
    const double tolerance = GENERATE(1e-5, 1e-10);
    const int nodes = GENERATE(3, 8, 17, 32);
    Problem problem(coated(base, optical_depth), 3 * nodes, nodes, some_directions(), tolerance);
    rte::StackSideBySide some;
    for (const int order : {0, 1, 3, 5}) {
        CAPTURE(optical_depth, nodes, order);
        rte::Reflector found;
        REQUIRE(problem.find(some, order, found));
        const rte::Reflector alone = problem.solve_alone(order);
        REQUIRE(alone.physical);
        // R is up to 1; both ways may err by a little of the tolerance.
        CHECK(problem.bounded_difference(found.multiple, alone.multiple) <= tolerance + 1e-13);
        if (order > 0) continue;
        const Eigen::VectorXd sky = problem.sky();
        CHECK((found.sky_at_requested - alone.rows * sky).cwiseAbs().maxCoeff() <=
              3.0 * tolerance + 1e-13);
        CHECK(std::abs(sky.dot(found.sky_at_nodes - alone.nodes * sky)) <= tolerance + 1e-13);
    }
}

TEST_CASE("random stacks side by side err by no more than the tolerance", "[rte][layer]") {
    if (!has_registers()) return;
    std::mt19937 generator(20);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const auto next = [&] { return uniform(generator); };
    const auto medium = [&] {
        return rte::henyey_greenstein_optics(1.0 - std::pow(10.0, -4.0 * next()), 0.95 * next());
    };
    for (int scene = 0; scene < 60; ++scene) {
        rte::Stack stack;
        constexpr rte::BaseKind kinds[] = {rte::BaseKind::half_space, rte::BaseKind::lambertian,
                                           rte::BaseKind::none};
        stack.base_kind = kinds[scene % 3];
        stack.base = medium();
        stack.ground_albedo = next();
        for (int coat = 0; coat <= scene % 4; ++coat)
            stack.coats.push_back({medium(), std::pow(10.0, -3.0 + 5.0 * next())});
        const int nodes = 4 + int(20.0 * next());
        std::vector<double> mu_in, mu_out;
        for (int k = 0; k < 4; ++k) {
            mu_in.push_back(0.02 + 0.98 * next());
            mu_out.push_back(0.02 + 0.98 * next());
        }
        const double tolerance = std::pow(10.0, -4.0 - 4.0 * next());
        Problem problem(stack, 2 * nodes + int(next() * nodes), nodes, rte::collect(mu_in, mu_out),
                        tolerance);
        rte::StackSideBySide some;
        for (const int order : {0, 1, 4, 9}) {
            if (order >= problem.stack.moments) continue;
            CAPTURE(scene, nodes, order, tolerance, stack.coats.size());
            rte::Reflector found;
            REQUIRE(problem.find(some, order, found));
            const rte::Reflector alone = problem.solve_alone(order);
            REQUIRE(alone.physical);
            CHECK(problem.bounded_difference(found.multiple, alone.multiple) <= tolerance + 1e-12);
        }
    }
}

TEST_CASE("media below a boundary are found side by side as well", "[rte][layer]") {
    if (!has_registers()) return;
    const auto base =
        GENERATE(rte::BaseKind::half_space, rte::BaseKind::lambertian, rte::BaseKind::none);
    const double roughness = GENERATE(0.0, 0.3);
    rte::Stack stack = coated(base, GENERATE(0.0, 0.5, 80.0));
    stack.boundary = rte::Boundary{.roughness = roughness};
    stack.base_index = 1.5;
    stack.coats.front().index = 1.5;
    const rte::ScaledStack scaled = rte::scale_stack(stack, 30, true);
    const rte::StackGrids grids(scaled, rte::GridKind::automatic, 6);
    const rte::RequestedDirections requested = some_directions();
    const Eigen::VectorXd sky = rte::flux_weights(grids.top());
    rte::SolverOptions loose, strict;
    loose.tolerance = 1e-4;
    strict.tolerance = 1e-12;
    rte::StackMemory memory, other_memory;
    rte::StackSolver side_by_side(scaled, grids, requested, loose, memory);
    rte::StackSolver alone(scaled, grids, requested, strict, other_memory);
    const double allowed = 0.01 * loose.tolerance;  // of the equations (tolerance_budget.h)
    for (const int order : {0, 1, 4}) {
        CAPTURE(roughness, order);
        const auto parts = order == 0 ? rte::ReflectorParts::sky : rte::ReflectorParts::pairs;
        const rte::Reflector& found = side_by_side.solve(order, parts, sky);
        const rte::Reflector& one = alone.solve(order, rte::ReflectorParts::nodes);
        REQUIRE(one.physical);
        REQUIRE(one.multiple.size() > 0);
        CHECK(found.specular == one.specular);
        CHECK((found.multiple - one.multiple).cwiseAbs().maxCoeff() <=
              10.0 * allowed * one.multiple.cwiseAbs().maxCoeff());
        if (order > 0 || roughness > 0.0) continue;  // rough: uniform light from everywhere
        CHECK((found.sky_at_requested - one.rows * sky).cwiseAbs().maxCoeff() <= 3.0 * allowed);
        CHECK(std::abs(sky.dot(found.sky_at_nodes - one.nodes * sky)) <= allowed);
    }
}

TEST_CASE("order 0 side by side loses no light", "[rte][layer]") {
    if (!has_registers()) return;
    // Hardly anything absorbs: a white ground under a layer returns what enters.
    rte::Stack stack = coated(rte::BaseKind::lambertian, GENERATE(0.01, 1.0, 20.0));
    stack.ground_albedo = 1.0;
    constexpr double absorbed = 2e-5;  // a little more than what is left to eigenmodes
    stack.coats.front().optics = rte::henyey_greenstein_optics(1.0 - absorbed, 0.5);
    Problem problem(stack, 20, 10, some_directions(), 1e-3);
    rte::StackSideBySide some;
    rte::Reflector found;
    REQUIRE(problem.find(some, 0, found));
    const double flux = problem.sky().squaredNorm();
    const double albedo = problem.sky().dot(found.sky_at_nodes) / flux;
    CHECK(albedo <= 1.0 + 1e-12);
    // Light that is scattered to and fro is absorbed as often as it is scattered; what a layer of
    // depth tau scatters of it is at most some 2 tau (1 + 3 tau / 4).
    const double depth = stack.coats.front().optical_depth;
    CHECK(albedo >= 1.0 - 4.0 * absorbed * depth * (1.0 + depth));
}

TEST_CASE("a light path has the same reflection both ways side by side", "[rte][layer]") {
    if (!has_registers()) return;
    rte::Stack stack = coated(rte::BaseKind::half_space, 0.4);
    stack.coats.push_back({rte::henyey_greenstein_optics(0.8, 0.3), 1.5});
    const std::vector<double> cosines = {0.1, 0.4, 0.9};
    Problem problem(stack, 24, 12, rte::collect(cosines, cosines), 1e-5);
    rte::StackSideBySide some;
    for (const int order : {0, 2, 7}) {
        rte::Reflector found;
        REQUIRE(problem.find(some, order, found));
        CHECK((found.multiple - found.multiple.transpose()).cwiseAbs().maxCoeff() <=
              1e-12 * found.multiple.cwiseAbs().maxCoeff());
    }
}

TEST_CASE("coats are left to eigenmodes where these take less or keep more digits",
          "[rte][layer]") {
    rte::Stack stack = coated(rte::BaseKind::half_space, 0.4);
    rte::StackSideBySide some;
    rte::Reflector found;
    {
        Problem many_nodes(stack, 80, 33, some_directions(), 1e-5);
        CHECK_FALSE(many_nodes.find(some, 1, found));
    }
    {
        Problem few_orders(stack, 60, 24, some_directions(), 1e-5);
        CHECK_FALSE(few_orders.find(some, 1, found, 3));
    }
    {
        Problem alone({.base = stack.base}, 100, 40, some_directions(), 1e-5);
        CHECK_FALSE(alone.find(some, 1, found, 3));
    }
    {
        Problem zenith(stack, 20, 10, rte::collect({1.0}, {0.3, 0.6}), 1e-5);
        CHECK_FALSE(zenith.find(some, 0, found));
    }
    stack.coats.front().optics = rte::henyey_greenstein_optics(1.0, 0.5);
    Problem white(stack, 20, 10, some_directions(), 1e-5);
    CHECK_FALSE(white.find(some, 0, found));
    if (has_registers()) CHECK(white.find(some, 1, found));
}
