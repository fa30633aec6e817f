// From names of materials to the reflection of the paper's painted sample.
#include <fmt/format.h>

#include <cmath>

#include <miebrdf/brdf.h>
#include "pipeline/solve/single_scattering.h"
#include "tools/bench/scenes.h"
#include "tools/bench/suites.h"
#include "tools/bench/truth.h"

namespace miebrdf::bench {
namespace {

const Directions kWanted{{0.2, 0.5, 0.8}, {0.2, 0.5, 0.8}, {0, 60, 120, 180}};

Scene paper_scene() {
    Scene scene;
    scene.base = medium("TiO2");
    scene.layers = {layer("AlGaAs7@0.1[grey]")};
    return scene;
}

std::vector<double> run(const SolverOptions& options) {
    const Brdf brdf = solve(paper_scene(), {450}, options, {.threads = 1});
    std::vector<double> values = brdf.evaluate(kWanted).slices.at(0).subsurface;
    for (double& v : values) v *= M_PI;
    return values;
}

// The phase function in a table fine enough for the forward peak, which is 0.2 degrees wide.
ScatteringLaw law_of(const rte::Optics& optics) {
    std::vector<double> degrees{0};
    for (int i = 0; i <= 600; ++i) degrees.push_back(1e-3 * std::pow(1e4, i / 600.0));
    for (int i = 1; i < 1700; ++i) degrees.push_back(10 + 0.1 * i);
    std::vector<double> x{-1}, p{optics.phase(-1)};
    for (std::size_t i = degrees.size(); i-- > 0;) {
        x.push_back(std::cos(degrees[i] * M_PI / 180));
        p.push_back(optics.phase(x.back()));
    }
    return ScatteringLaw::tabulated(std::move(x), std::move(p));
}

// From the names on: Mie is part of the run.
Answer by_photons(int photons) {
    OpticsDemand demand;
    demand.whole_phase_function = true;
    demand.tolerance = 1e-3;
    const ResolvedScene scene = resolve(paper_scene(), {450});
    const auto traced = [&](std::size_t medium, double optical_depth) {
        const rte::Optics optics = compute_optics(scene, medium, 0, demand).optics;
        return TracedLayer{optics.single_scattering_albedo, law_of(optics), optical_depth};
    };
    const TracedStack stack{traced(0, 0), {traced(1, 0.1)}};
    Answer answer;
    for (const double mu : kWanted.mu_in) {
        const auto found = trace_photons(stack, mu, detectors(kWanted),
                                         {.photons = photons, .most_collisions = 2000});
        for (const Estimate& e : found.reflection) answer.add(e.value, e.standard_error);
    }
    return answer;
}

BenchCase painted_sample() {
    BenchCase c{"pipeline", "TiO2 + AlGaAs7 at 450 nm",
                "R of TiO2 under AlGaAs7 of depth 0.1 (paper, Fig. 1), 50 um spheres, cosines 0.2, "
                "0.5, 0.8, azimuths 0 to 180; error relative to the largest value at that "
                "incidence.",
                "tests/reference/pipeline/tio2_algaas_reflection_450nm.csv, all 2,900 moments, "
                "1e-3 or better."};
    c.error = [](const std::vector<double>& values, const std::vector<double>& truth) {
        return largest_error_in_blocks(values, truth,
                                       kWanted.mu_out.size() * kWanted.azimuth_deg.size());
    };
    const ReferenceData table("pipeline/tio2_algaas_reflection_450nm.csv");
    for_each_direction(kWanted, [&](double in, double out, double azimuth) {
        c.true_values.push_back(table.number("R", {{"pair", "A"},
                                                   {"coat_tau", 0.1},
                                                   {"mu_in", in},
                                                   {"mu_out", out},
                                                   {"azimuth_deg", azimuth}}));
    });
    c.add_each("miebrdf", "tol={:.0e}", {1e-1, 1e-2, 3e-3, 1e-3},
               [](double t) { return run({.tolerance = t}); });
    c.add_each("paper: eq. 2 and 3 on its grid", "n={}", {16, 32}, [](int n) {
        return run({.grid = rte::GridKind::paper,
                    .streams = n,
                    .half_space_method = rte::HalfSpaceMethod::fixed_point,
                    .coat_method = rte::CoatMethod::first_order_patched,
                    .delta_m = false,
                    .single_scattering_correction = false});
    });
    c.add_each("no single-scattering correction", "n={}", {16, 32},
               [](int n) { return run({.streams = n, .single_scattering_correction = false}); });
    c.add_each("Monte Carlo", "{} photons", {300, 3000, 30000}, by_photons);
    return c;
}

}  // namespace

std::vector<BenchCase> pipeline_suite() { return {painted_sample()}; }

}  // namespace miebrdf::bench
