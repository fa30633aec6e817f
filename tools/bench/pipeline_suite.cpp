// From names of materials to the reflection of the paper's painted sample.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "pipeline/solve/brdf.h"
#include "pipeline/solve/scene_optics.h"
#include "tools/bench/photon_tracer.h"
#include "tools/bench/suites.h"
#include "tools/bench/truth.h"

namespace miebrdf::bench {
namespace {

const std::vector<double> kMuIn = {0.2, 0.5, 0.8}, kMuOut = {0.2, 0.5, 0.8},
                          kAzimuth = {0, 60, 120, 180};

Request paper_scene(double tolerance) {
    Request request;
    request.scene.base = parse_medium("TiO2");
    request.scene.coats = {parse_coat("AlGaAs7@0.1")};
    request.wavelength_nm = {450};
    request.directions = {kMuIn, kMuOut, kAzimuth};
    request.solver.tolerance = tolerance;
    return request;
}

std::vector<double> run(const Request& request) {
    std::vector<double> values = compute_brdf(request, {.threads = 1}).slices.at(0).subsurface;
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
    MediumResolver resolver;
    OpticsDemand demand;
    demand.whole_phase_function = true;
    demand.tolerance = 1e-3;
    const auto a = medium_optics(resolver.resolve(parse_medium("TiO2")), 450, {}, demand);
    const auto b = medium_optics(resolver.resolve(parse_medium("AlGaAs7")), 450, {}, demand);
    TracedStack stack;
    stack.base = {a.optics.single_scattering_albedo, law_of(a.optics), 0};
    stack.coats = {{b.optics.single_scattering_albedo, law_of(b.optics), 0.1}};
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
            {"miebrdf", fmt::format("tol={:.0e}", t), [=] { return run(paper_scene(t)); }});
    }
    for (const int n : {16, 32}) {
        c.contenders.push_back({"paper: eq. 2 and 3 on its grid", fmt::format("n={}", n), [=] {
                                    Request request = paper_scene(1e-3);
                                    request.solver.streams = n;
                                    request.solver.grid = rte::GridKind::paper;
                                    request.solver.half_space_method =
                                        rte::HalfSpaceMethod::fixed_point;
                                    request.solver.coat_method =
                                        rte::CoatMethod::first_order_patched;
                                    request.solver.delta_m = false;
                                    request.solver.single_scattering_correction = false;
                                    return run(request);
                                }});
        c.contenders.push_back({"no single-scattering correction", fmt::format("n={}", n), [=] {
                                    Request request = paper_scene(1e-3);
                                    request.solver.streams = n;
                                    request.solver.single_scattering_correction = false;
                                    return run(request);
                                }});
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
