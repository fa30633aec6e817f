#include "rte/half_space/solved_half_spaces.h"

#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

rte::Stack painted(double coat_asymmetry, double depth) {
    rte::Stack stack;
    stack.base = rte::henyey_greenstein_optics(0.95, 0.7);
    stack.coats = {{rte::henyey_greenstein_optics(0.8, coat_asymmetry), depth}};
    return stack;
}

const rte::Directions kDirections{{0.2, 1.0}, {0.1, 0.6, 0.9}, {0, 50, 180}};

std::vector<double> reflection(const rte::Stack& stack, rte::SolverOptions options) {
    return rte::reflect(stack, kDirections, options).reflection;
}

}  // namespace

TEST_CASE("a half-space found again gives the same bits as one solved again", "[rte][shared]") {
    const auto method = GENERATE(rte::HalfSpaceMethod::automatic, rte::HalfSpaceMethod::fixed_point,
                                 rte::HalfSpaceMethod::doubling);
    const rte::SolverOptions alone{.streams = 16, .half_space_method = method};
    rte::SolvedHalfSpaces known(std::make_shared<rte::MemoryBudget>(std::int64_t{1} << 24));
    rte::SolverOptions shared = alone;
    shared.half_spaces = &known;

    CHECK(reflection(painted(0.3, 0.2), shared) == reflection(painted(0.3, 0.2), alone));
    CHECK(known.found() == 0);
    const std::size_t solved = known.kept();
    CHECK(solved >= 6);  // orders of two numbers of nodes
    CHECK(reflection(painted(0.3, 2.0), shared) == reflection(painted(0.3, 2.0), alone));
    // Another coat, the same base; deeper down fewer of its orders show.
    CHECK(known.found() >= 6);
    CHECK(known.kept() - solved + std::size_t(known.found()) <= solved + 4);
}

TEST_CASE("whatever a half-space depends on makes it another one", "[rte][shared]") {
    rte::SolvedHalfSpaces known(std::make_shared<rte::MemoryBudget>(std::int64_t{1} << 26));
    rte::SolverOptions options{.streams = 12, .half_spaces = &known};
    rte::Stack stack = painted(0.3, 0.2);
    reflection(stack, options);
    SECTION("albedo") { stack.base = rte::henyey_greenstein_optics(0.951, 0.7); }
    SECTION("asymmetry") { stack.base = rte::henyey_greenstein_optics(0.95, 0.701); }
    SECTION("nodes") { options.streams = 32; }
    SECTION("grid") { options.grid = rte::GridKind::gauss; }
    SECTION("method") { options.half_space_method = rte::HalfSpaceMethod::doubling; }
    SECTION("tolerance") { options.tolerance = 1e-5; }
    SECTION("delta-M") {
        options.delta_m = false;
        // Without it the moments stay as they are; only a base with a peak is another one.
        stack.base = rte::henyey_greenstein_optics(0.95, 0.97);
    }
    const int found = known.found();
    rte::SolverOptions alone = options;
    alone.half_spaces = nullptr;
    CHECK(reflection(stack, options) == reflection(stack, alone));
    CHECK(known.found() == found);
}

TEST_CASE("what does not fit is solved again, and the memory comes back", "[rte][shared]") {
    const auto budget = std::make_shared<rte::MemoryBudget>(20'000);
    {
        rte::SolvedHalfSpaces known(budget);
        const rte::SolverOptions alone{.streams = 16};
        rte::SolverOptions shared = alone;
        shared.half_spaces = &known;
        for (int repeat = 0; repeat < 2; ++repeat) {
            CHECK(reflection(painted(0.3, 0.2), shared) == reflection(painted(0.3, 0.2), alone));
        }
        CHECK(known.kept() >= 1);
        CHECK(budget->left() >= 0);
        CHECK(budget->left() < 20'000);
    }
    CHECK(budget->left() == 20'000);
}
