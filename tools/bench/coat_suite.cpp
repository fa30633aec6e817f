// A coat on a half-space: the paper's second equation against exact methods.
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "tools/bench/bench_scene.h"
#include "tools/bench/reference_data.h"
#include "tools/bench/suites.h"

namespace miebrdf::bench {
namespace {

BenchCase coated(const char* coat, double tau, const std::vector<double>& cosines,
                 const char* remark) {
    const ReferenceData table("rte/R_coated_halfspace.csv");
    BenchCase c;
    c.suite = "coat";
    const Wanted wanted{cosines, cosines, {0, 90, 180}};
    BenchScene scene{{0.95, 0.7, 0}, SimpleLayer{}};
    for (const double i : wanted.mu_in) {
        for (const double o : wanted.mu_out) {
            for (const double a : wanted.azimuth_deg) {
                for (std::size_t row = 0; row < table.size(); ++row) {
                    if (table.text(row, "coat") != coat || table.number(row, "tau") != tau ||
                        table.number(row, "mu_i") != std::min(i, o) ||
                        table.number(row, "mu_o") != std::max(i, o) ||
                        table.number(row, "phi_deg") != a) {
                        continue;
                    }
                    scene.coat = SimpleLayer{table.number(row, "coat_alpha"),
                                             table.number(row, "coat_g"), tau};
                    c.true_values.push_back(table.number(row, "R"));
                    break;
                }
            }
        }
    }
    const std::size_t wanted_count = cosines.size() * cosines.size() * 3;
    if (c.true_values.size() != wanted_count)
        throw std::logic_error("reference table lacks a direction");
    c.name = fmt::format("coat {}/{}, depth {}{}", scene.coat->single_scattering_albedo,
                         scene.coat->asymmetry, tau, remark);
    c.quantity = fmt::format(
        "R of a coat (albedo {}, g {}) of optical depth {} on a half-space (0.95, 0.7).",
        scene.coat->single_scattering_albedo, scene.coat->asymmetry, tau);
    c.truth =
        "tests/reference/rte/R_coated_halfspace.csv, 10 digits or more, checked against CDISORT.";
    c.contenders = library_methods(scene, wanted);
    for (auto& more : stepwise_coats(scene, wanted)) c.contenders.push_back(std::move(more));
    for (auto& more : outside_methods(scene, wanted)) c.contenders.push_back(std::move(more));
    return c;
}

// Names of the first white and the first dark coat in the table.
std::string name_of(double albedo, double g) {
    const ReferenceData table("rte/R_coated_halfspace.csv");
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.number(row, "coat_alpha") == albedo && table.number(row, "coat_g") == g) {
            return table.text(row, "coat");
        }
    }
    throw std::logic_error("reference table lacks a coat");
}

}  // namespace

std::vector<BenchCase> coat_suite() {
    // The coats of the paper's Table 2, logo 1: green and red.
    const std::string bright = name_of(0.9, 0.46), dark = name_of(0.1, 0.54);
    return {coated(bright.c_str(), 0.1, {0.2, 0.5, 0.9}, ""),
            coated(dark.c_str(), 0.1, {0.2, 0.5, 0.9}, ""),
            coated(bright.c_str(), 1, {0.2, 0.5, 0.9}, ""),
            coated(bright.c_str(), 0.1, {0.05, 0.1}, ", grazing")};
}

}  // namespace miebrdf::bench
