// Random scenes below boundaries: how many values miss the tolerance that was asked for.
// MIEBRDF_BOUNDARY_SCENES=300 runs so many in place of a few, and prints a table; "300,1000" those
// from number 1000 on, "300,1000,rough" below rough boundaries alone.
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>

#include "tests/rte/boundary_scenes.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

/// Two of many nodes, which must agree. Rough boundaries take the square of the nodes for each
/// order: fewer do.
struct TruthOptions {
    rte::SolverOptions more, fewer;
};
TruthOptions truth_options(const support::BoundaryScene& scene) {
    if (scene.stack.boundary->is_rough())
        return {{.tolerance = 1e-5, .streams = 64}, {.tolerance = 1e-5, .streams = 48}};
    return {{.tolerance = 1e-7, .streams = 96}, {.tolerance = 1e-7, .streams = 64}};
}

constexpr int kScenesByDefault = 24;

struct Wanted {
    int count = kScenesByDefault, first = 0;
    bool rough = false;
};
Wanted wanted_scenes() {
    Wanted wanted;
    const char* const text = std::getenv("MIEBRDF_BOUNDARY_SCENES");
    if (text == nullptr) return wanted;
    std::istringstream words(text);
    std::string word;
    if (std::getline(words, word, ',')) wanted.count = std::stoi(word);
    if (std::getline(words, word, ',')) wanted.first = std::stoi(word);
    wanted.rough = std::getline(words, word, ',') && word == "rough";
    return wanted;
}

struct Tally {
    int scenes = 0, beyond = 0, far_beyond = 0, not_converged = 0, unknown = 0;
    double worst = 0.0;
};

/// One scene at one tolerance.
void add(const support::BoundaryScene& scene, const support::SceneSolution& truth, double known_to,
         double tolerance, int number, Tally& tally) {
    if (!(known_to <= 0.3 * tolerance)) {
        ++tally.unknown;
        return;
    }
    ++tally.scenes;
    const auto found = support::solution_of(scene, {.tolerance = tolerance});
    if (!found.converged) {
        ++tally.not_converged;
        return;
    }
    const double error = support::error_of(found, truth) / tolerance;
    tally.beyond += error <= 1.0 ? 0 : 1;
    tally.far_beyond += error <= 3.0 ? 0 : 1;
    if (!(error <= tally.worst)) tally.worst = error;
    if (!(error <= 1.0))
        std::cout << "scene " << number << " at " << tolerance << ": " << error << " tolerances, "
                  << found.estimate / tolerance << " stated, " << found.streams << " nodes\n";
}

}  // namespace

TEST_CASE("random scenes below boundaries are within the tolerance", "[rte][boundary][random]") {
    const auto [count, first, rough] = wanted_scenes();
    const std::vector<double> tolerances{1e-2, 1e-3, 1e-4};
    std::vector<Tally> tallies(tolerances.size());
    for (int k = first; k < first + count; ++k) {
        const support::BoundaryScene scene =
            support::BoundarySceneMaker(std::uint32_t(k), rough).make();
        const TruthOptions options = truth_options(scene);
        const auto truth = support::solution_of(scene, options.more);
        const double known_to =
            support::error_of(support::solution_of(scene, options.fewer), truth);
        for (std::size_t t = 0; t < tolerances.size(); ++t)
            add(scene, truth, known_to, tolerances[t], k, tallies[t]);
    }
    for (std::size_t t = 0; t < tolerances.size(); ++t) {
        const Tally& tally = tallies[t];
        CAPTURE(tolerances[t], tally.scenes, tally.beyond, tally.worst, tally.not_converged,
                tally.unknown);
        if (count > kScenesByDefault) {
            std::cout << tolerances[t] << ": " << tally.scenes << " scenes, " << tally.beyond
                      << " beyond, " << tally.far_beyond << " beyond 3 times, worst " << tally.worst
                      << ", " << tally.not_converged << " said not converged, " << tally.unknown
                      << " without a truth\n";
        }
        // One of a hundred, and one of a few.
        CHECK(tally.beyond <= 1 + count / 100);
        CHECK(tally.far_beyond == 0);
        CHECK(4 * tally.unknown <= count);
    }
}
