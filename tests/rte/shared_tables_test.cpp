#include "rte/stack/stack_solver.h"

#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

rte::RequestedDirections at(std::vector<double> mu) {
    rte::RequestedDirections requested;
    requested.mu = Eigen::Map<Eigen::VectorXd>(mu.data(), Eigen::Index(mu.size()));
    for (int k = 0; k < int(mu.size()); ++k) {
        requested.in.push_back(k);
        requested.out.push_back(k);
    }
    return requested;
}

bool are_equal(const rte::PhaseMode& a, const rte::PhaseMode& b) {
    return a.order == b.order && a.at_nodes == b.at_nodes && a.scaled_nodes == b.scaled_nodes &&
           a.at_requested == b.at_requested && a.at_out == b.at_out && a.at_in == b.at_in;
}

rte::PhaseMode made(int order, int degrees, const rte::ZenithGrid& grid,
                    const rte::RequestedDirections& requested) {
    rte::PhaseMode mode;
    rte::make_phase_mode(order, degrees, grid, requested, mode);
    return mode;
}

}  // namespace

TEST_CASE("a table is that of its order, degrees, grid and directions, kept or not",
          "[rte][shared]") {
    rte::SharedTables tables(GENERATE(std::size_t{0}, std::size_t{20'000}, std::size_t{1} << 20));
    const rte::ZenithGrid foreign = rte::make_gauss_grid(9);
    for (int repeat = 0; repeat < 2; ++repeat) {
        for (const auto& requested : {at({0.3, 1.0}), at({0.3, 0.9}), at({0.2, 0.4, 0.6})}) {
            for (const int order : {0, 3}) {
                for (const int degrees : {8, 16}) {
                    for (const int nodes : {8, 12}) {
                        const auto& grid = tables.grid(rte::GridKind::mapped_gauss, nodes);
                        CHECK(are_equal(tables.mode(order, degrees, grid, requested),
                                        made(order, degrees, grid, requested)));
                    }
                    CHECK(are_equal(tables.mode(order, degrees, foreign, requested),
                                    made(order, degrees, foreign, requested)));
                }
            }
        }
    }
}

TEST_CASE("a table that is kept is the same object when it is asked for again", "[rte][shared]") {
    rte::SharedTables tables;
    const auto requested = at({0.3, 1.0});
    const auto& grid = tables.grid(rte::GridKind::gauss, 12);
    CHECK(&grid == &tables.grid(rte::GridKind::gauss, 12));
    const rte::PhaseMode& first = tables.mode(2, 16, grid, requested);
    tables.mode(3, 16, grid, requested);
    CHECK(&first == &tables.mode(2, 16, grid, requested));
}

TEST_CASE("stacks solved one after the other in the same memory give the same bits",
          "[rte][shared]") {
    rte::StackMemory memory;
    for (int repeat = 0; repeat < 2; ++repeat) {
        for (const double g : {0.0, 0.4, 0.95}) {
            for (const int streams : {0, 9, 16}) {
                const rte::Stack stack{.base = rte::henyey_greenstein_optics(0.97, g),
                                       .coats = {{rte::henyey_greenstein_optics(0.8, 0.3), 0.4}}};
                const rte::Directions directions{{0.2, 1.0}, {0.1, 0.7}, {0.0, 70.0, 180.0}};
                const rte::SolverOptions alone{.tolerance = 1e-4, .streams = streams};
                rte::SolverOptions shared = alone;
                shared.memory = &memory;
                CAPTURE(g, streams);
                CHECK(rte::reflect(stack, directions, shared).reflection ==
                      rte::reflect(stack, directions, alone).reflection);
                CHECK(rte::albedo(stack, {0.3, 0.9}, shared).plane_albedo ==
                      rte::albedo(stack, {0.3, 0.9}, alone).plane_albedo);
            }
        }
    }
}
