#include "rte/stack/layered_reflection.h"
#include "rte/stack/stack_solver.h"
#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("stacks solved one after the other in the same memory give the same bits",
          "[rte][memory]") {
    rte::SolutionMemory memory;
    for (int repeat = 0; repeat < 2; ++repeat) {
        for (const double g : {0.0, 0.4, 0.95}) {
            for (const int streams : {0, 9, 16}) {
                const rte::Stack stack{.base = rte::henyey_greenstein_optics(0.97, g),
                                       .coats = {{rte::henyey_greenstein_optics(0.8, 0.3), 0.4}}};
                const rte::Directions directions{{0.2, 1.0}, {0.1, 0.7}, {0.0, 70.0, 180.0}};
                const rte::SolverOptions options{.tolerance = 1e-4, .streams = streams};
                CAPTURE(g, streams);
                CHECK(rte::reflect(stack, directions, options, &memory).reflection ==
                      rte::reflect(stack, directions, options).reflection);
                CHECK(rte::albedo(stack, {0.3, 0.9}, options, {}, &memory).plane_albedo ==
                      rte::albedo(stack, {0.3, 0.9}, options).plane_albedo);
            }
        }
    }
}
