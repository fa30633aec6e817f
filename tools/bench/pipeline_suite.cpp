// From names of materials to the reflection of the paper's painted sample.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <miebrdf/brdf.h>
#include "pipeline/solve/single_scattering.h"
#include "tools/bench/photon_tracer.h"
#include "tools/bench/suites.h"
#include "tools/bench/truth.h"

namespace miebrdf::bench {
namespace {

const std::vector<double> kMuIn = {0.2, 0.5, 0.8}, kMuOut = {0.2, 0.5, 0.8},
                          kAzimuth = {0, 60, 120, 180};

Scene paper_scene() {
    Scene scene;
    scene.base = medium("TiO2");
    scene.layers = {layer("AlGaAs7@0.1[grey]")};
    return scene;
}

std::vector<double> run(const SolverOptions& options) {
    const Brdf brdf = solve(paper_scene(), {450}, options, {.threads = 1});
    std::vector<double> values = brdf.evaluate({kMuIn, kMuOut, kAzimuth}).slices.at(0).subsurface;
    for (double& v : values) v *= M_PI;
    return values;
}

// Largest error relative to the largest value at the same incidence: what --tolerance promises.
double error_by_incidence(const std::vector<double>& values, const std::vector<double>& truth) {
    const std::size_t block = kMuOut.size() * kAzimuth.size();
    if (values.size() != truth.size()) return std::numeric_limits<double>::quiet_NaN();
    double worst = 0;
    for (std::size_t start = 0; start < truth.size(); start += block) {
        const double scale = *std::max_element(truth.begin() + std::ptrdiff_t(start),
                                               truth.begin() + std::ptrdiff_t(start + block));
        for (std::size_t i = start; i < start + block; ++i) {
            const double error = std::abs(values[i] - truth[i]) / scale;
            if (!(error <= worst)) worst = error;
        }
    }
    return worst;
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
    std::vector<Detector> detectors;
    for (const double mu : kMuOut) {
        for (const double azimuth : kAzimuth) detectors.push_back({mu, azimuth});
    }
    Answer answer;
    for (const double mu : kMuIn) {
        for (const Estimate& e :
             trace_photons(stack, mu, detectors, {.photons = photons, .most_collisions = 2000})
                 .reflection) {
            answer.add(e.value, e.standard_error);
        }
    }
    return answer;
}

BenchCase painted_sample() {
    BenchCase c;
    c.suite = "pipeline";
    c.name = "TiO2 + AlGaAs7 at 450 nm";
    c.quantity =
        "R of TiO2 under AlGaAs7 of depth 0.1 (paper, Fig. 1), 50 um spheres, cosines 0.2, 0.5, "
        "0.8, "
        "azimuths 0 to 180; error relative to the largest value at that incidence.";
    c.truth =
        "tests/reference/pipeline/tio2_algaas_reflection_450nm.csv, all 2,900 moments, 1e-3 or "
        "better.";
    c.error = error_by_incidence;
    const ReferenceData table("pipeline/tio2_algaas_reflection_450nm.csv");
    for (const double i : kMuIn) {
        for (const double o : kMuOut) {
            for (const double a : kAzimuth) {
                for (std::size_t row = 0; row < table.size(); ++row) {
                    if (table.text(row, "pair") == "A" && table.number(row, "coat_tau") == 0.1 &&
                        table.number(row, "mu_in") == i && table.number(row, "mu_out") == o &&
                        table.number(row, "azimuth_deg") == a) {
                        c.true_values.push_back(table.number(row, "R"));
                    }
                }
            }
        }
    }
    if (c.true_values.size() != 36) throw std::logic_error("reference table lacks a direction");
    for (const double t : {1e-1, 1e-2, 3e-3, 1e-3}) {
        c.contenders.push_back(
            {"miebrdf", fmt::format("tol={:.0e}", t), [=] { return run({.tolerance = t}); }});
    }
    for (const int n : {16, 32}) {
        SolverOptions plain{.streams = n};
        plain.single_scattering_correction = false;
        SolverOptions paper = plain;
        paper.grid = rte::GridKind::paper;
        paper.half_space_method = rte::HalfSpaceMethod::fixed_point;
        paper.coat_method = rte::CoatMethod::first_order_patched;
        paper.delta_m = false;
        const std::string knob = fmt::format("n={}", n);
        c.contenders.push_back(
            {"paper: eq. 2 and 3 on its grid", knob, [=] { return run(paper); }});
        c.contenders.push_back(
            {"no single-scattering correction", knob, [=] { return run(plain); }});
    }
    for (const int n : {300, 3000, 30000}) {
        c.contenders.push_back(
            {"Monte Carlo", fmt::format("{} photons", n), [=] { return by_photons(n); }});
    }
    return c;
}

}  // namespace

std::vector<BenchCase> pipeline_suite() { return {painted_sample()}; }

}  // namespace miebrdf::bench
