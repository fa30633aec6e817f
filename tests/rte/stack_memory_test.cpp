#include <cmath>

#include "rte/boundary/rough_boundaries.h"
#include "rte/stack/kept_layers.h"
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

TEST_CASE("layers kept from other stacks give the same bits below another topmost one",
          "[rte][memory]") {
    // Thick layers hide others in some orders; the topmost one changes, then one below it.
    const auto kept = std::make_shared<rte::KeptLayers>();
    auto memory = rte::memory_with(std::make_shared<rte::RoughBoundaries>(), kept);
    const rte::Directions directions{{0.2, 1.0}, {0.1, 0.7}, {0.0, 70.0, 180.0}};
    const rte::SolverOptions options{.tolerance = 1e-3, .streams = 12};
    for (const auto kind : {rte::BaseKind::half_space, rte::BaseKind::lambertian}) {
        for (const bool has_boundary : {false, true}) {
            int before = kept->found();
            for (const double g : {0.6, 0.5}) {
                for (const double depth : {0.1, 0.1, 1.0, 5.0, 30.0}) {
                    rte::Stack stack{
                        .base = rte::henyey_greenstein_optics(0.97, g),
                        .coats = {{rte::rayleigh_optics(0.5 + 0.5 * g), 2.0, 1.5},
                                  {rte::henyey_greenstein_optics(0.7, 0.3), depth, 1.3}},
                        .base_kind = kind,
                        .ground_albedo = g,
                        .base_index = 1.5};
                    if (has_boundary) stack.boundary = rte::Boundary{};
                    CAPTURE(int(kind), has_boundary, g, depth);
                    CHECK(rte::reflect(stack, directions, options, &memory).reflection ==
                          rte::reflect(stack, directions, options).reflection);
                    CHECK(rte::albedo(stack, {0.3, 0.9}, options, {}, &memory).plane_albedo ==
                          rte::albedo(stack, {0.3, 0.9}, options).plane_albedo);
                    const rte::SolvedLight light{3, true};
                    CHECK(rte::reflect_polarised(stack, directions, light, options, &memory)
                              .reflection ==
                          rte::reflect_polarised(stack, directions, light, options).reflection);
                    if (depth == 1.0) CHECK(kept->found() > before);
                    before = kept->found();
                }
            }
        }
    }
}

TEST_CASE("different stacks in the same memory are what they are in fresh memories",
          "[rte][memory]") {
    const auto base = rte::henyey_greenstein_optics(0.97, 0.6);
    const std::vector<rte::Coat> coat = {{rte::henyey_greenstein_optics(0.8, 0.3), 0.4, 1.5}};
    const std::vector<rte::Coat> coats = {{rte::henyey_greenstein_optics(0.9, -0.2), 2.0, 1.5},
                                          {rte::isotropic_optics(0.5), 0.1, 1.3}};
    const std::vector<rte::Stack> stacks = {
        {.base = base},
        {.base = base, .coats = {{rte::henyey_greenstein_optics(0.8, 0.3), 0.4}}},
        {.base = base, .base_index = 1.5, .boundary = rte::Boundary{}},
        {.base = base, .coats = coat, .base_index = 1.5, .boundary = rte::Boundary{}},
        {.base = base, .coats = coats, .base_index = 1.5, .boundary = rte::Boundary{}},
        {.base = base, .base_index = 1.5, .boundary = rte::Boundary{.roughness = 0.3}},
        {.base = base,
         .coats = coat,
         .base_index = 1.5,
         .boundary = rte::Boundary{.roughness = 0.3}},
        {.coats = coat,
         .base_kind = rte::BaseKind::lambertian,
         .ground_albedo = 0.4,
         .base_index = 1.5,
         .boundary = rte::Boundary{}},
    };
    const rte::Directions directions{{0.2, 1.0}, {0.1, 0.7}, {0.0, 70.0, 180.0}};
    const rte::SolverOptions options{.tolerance = 1e-3, .streams = 12};
    rte::SolutionMemory memory;
    std::size_t at = 0;
    for (int k = 0; k < 24; ++k) {
        // Each after several others.
        at = (at + 3 + std::size_t(k / 8)) % stacks.size();
        const rte::Stack& stack = stacks[at];
        CAPTURE(k, at);
        const auto compare = [&](const std::vector<double>& kept,
                                 const std::vector<double>& fresh) {
            if (!stack.boundary || !stack.boundary->is_rough()) {
                CHECK(kept == fresh);
                return;
            }
            // Rough boundaries with more orders than are wanted differ by rounding.
            REQUIRE(kept.size() == fresh.size());
            for (std::size_t v = 0; v < kept.size(); ++v)
                CHECK(std::abs(kept[v] - fresh[v]) <= 1e-14 * fresh[v]);
        };
        compare(rte::reflect(stack, directions, options, &memory).reflection,
                rte::reflect(stack, directions, options).reflection);
        compare(rte::albedo(stack, {0.3, 0.9}, options, {}, &memory).plane_albedo,
                rte::albedo(stack, {0.3, 0.9}, options).plane_albedo);
    }
}
