// Layers under a refracting boundary: the solver beside the classics that people use instead.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "rte/stack/layered_reflection.h"
#include "tools/bench/approximations.h"
#include "tools/bench/photon_tracer.h"
#include "tools/bench/suites.h"
#include "tools/bench/truth.h"

namespace miebrdf::bench {
namespace {

const std::vector<double> kCosines = {1.0, 0.5};
// Small enough that the number of nodes is what limits the error.
constexpr double kNoOrderMissing = 1e-10;

/// A Henyey-Greenstein film on a Lambertian ground, or a half-space.
struct BinderScene {
    double index;
    SimpleLayer medium;            ///< optical depth infinite: a half-space
    std::optional<double> ground;  ///< of a film

    rte::Stack for_solver(bool with_boundary) const {
        const auto optics =
            rte::henyey_greenstein_optics(medium.single_scattering_albedo, medium.asymmetry);
        rte::Stack stack;
        if (with_boundary) {
            stack.boundary = rte::Boundary{};
            stack.base_index = index;
        }
        if (!ground) {
            stack.base = optics;
            return stack;
        }
        stack.base_kind = rte::BaseKind::lambertian;
        stack.ground_albedo = *ground;
        stack.coats = {{optics, medium.optical_depth, stack.base_index}};
        return stack;
    }

    TracedStack for_photons() const {
        const TracedLayer layer{medium.single_scattering_albedo,
                                ScatteringLaw::henyey_greenstein(medium.asymmetry),
                                medium.optical_depth};
        TracedStack stack;
        stack.base = layer;
        stack.boundary.index = index;
        if (ground) stack.coats = {layer};
        stack.ground_albedo = ground;
        return stack;
    }
};

double internal_reflectance(double index) {
    const ReferenceData table("interface/diffuse_fresnel.csv");
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.number(row, "n") == index) return table.number(row, "r_int");
    }
    throw std::logic_error("reference table lacks an index");
}

/// A total for each incident cosine from what a classic says of diffuse light inside.
template <typename Total>
std::vector<double> at_cosines(double index, const Total& total) {
    std::vector<double> values;
    for (const double mu : kCosines) values.push_back(total(fresnel(index, mu).reflectance));
    return values;
}

std::vector<Contender> classics(const BinderScene& scene) {
    const double inside = internal_reflectance(scene.index);
    const SimpleStack simple{scene.medium, {}};
    const auto kubelka_munk = scene.ground ? kubelka_munk_film(scene.medium, *scene.ground)
                                           : kubelka_munk_reflectance(simple);
    const auto corrected = [=](double body) {
        return at_cosines(scene.index, [&](double r) { return saunderson(body, r, inside); });
    };
    std::vector<Contender> all;
    all.push_back({"no boundary", "-",
                   [=] { return rte::albedo(scene.for_solver(false), kCosines).plane_albedo; }});
    if (kubelka_munk) {
        all.push_back({"Kubelka-Munk, Saunderson", "-", [=] {
                           return corrected(scene.ground
                                                ? *kubelka_munk_film(scene.medium, *scene.ground)
                                                : *kubelka_munk_reflectance(simple));
                       }});
    }
    for (const double tolerance : {1e-2, 1e-3}) {
        all.push_back({"exact body, Saunderson", fmt::format("tol={:.0e}", tolerance), [=] {
                           const auto body = rte::albedo(scene.for_solver(false), {1.0},
                                                         {.tolerance = tolerance});
                           return corrected(body.spherical_albedo);
                       }});
    }
    if (!scene.ground) {
        all.push_back({"diffusion, extrapolated boundary", "-", [=] {
                           const double body = *diffusion_reflectance(simple, inside);
                           return at_cosines(scene.index,
                                             [&](double r) { return r + (1 - r) * body; });
                       }});
    }
    return all;
}

std::vector<Contender> contenders(const BinderScene& scene) {
    std::vector<Contender> all;
    const auto add = [&](std::string method, std::string knob, rte::SolverOptions options) {
        all.push_back(
            {std::move(method), std::move(knob),
             [=] { return rte::albedo(scene.for_solver(true), kCosines, options).plane_albedo; }});
    };
    for (const double t : {1e-1, 1e-2, 1e-3, 1e-4, 1e-6}) {
        add("miebrdf", fmt::format("tol={:.0e}", t), {.tolerance = t});
    }
    for (const int n : {4, 8, 12, 16, 24, 32}) {
        add("closed form, refraction grid", fmt::format("n={}", n),
            {.tolerance = kNoOrderMissing, .streams = n});
    }
    for (Contender& classic : classics(scene)) all.push_back(std::move(classic));
    const TracedStack traced = scene.for_photons();
    for (const int photons : {1000, 10000, 100000}) {
        all.push_back({"Monte Carlo", fmt::format("{} photons", photons), [=] {
                           Answer answer;
                           for (const double mu : kCosines) {
                               const Estimate e =
                                   trace_photons(traced, mu, {}, {.photons = photons}).plane_albedo;
                               answer.add(e.value, e.standard_error);
                           }
                           return answer;
                       }});
    }
    return all;
}

/// A row of interface/slabs.csv.
BenchCase in_binder(const std::string& name, double index, double albedo, double g, double depth,
                    std::optional<double> ground) {
    const ReferenceData table("interface/slabs.csv");
    const std::string base = !ground        ? "air"
                             : *ground == 0 ? "black"
                                            : fmt::format("lambert {:.1f}", *ground);
    BenchCase c;
    c.suite = "boundary";
    c.name = name;
    c.quantity = fmt::format(
        "Plane albedo at cosines 1 and .5, mirror reflection included, of Henyey-Greenstein "
        "particles (albedo {}, g {}) in a binder of index {}.",
        albedo, g, index);
    c.truth = "tests/reference/interface/slabs.csv, 8 digits, checked against iad.";
    for (std::size_t row = 0; row < table.size(); ++row) {
        const bool is_it = table.number(row, "n") == index &&
                           table.number(row, "albedo") == albedo && table.number(row, "g") == g &&
                           table.number(row, "tau") == depth && table.text(row, "base") == base;
        if (is_it) c.true_values = {table.number(row, "UR1"), table.number(row, "A_mu_0.5")};
    }
    if (c.true_values.empty()) throw std::logic_error("reference table lacks " + name);
    c.contenders = contenders({index, {albedo, g, depth}, ground});
    return c;
}

}  // namespace

std::vector<BenchCase> boundary_suite() {
    constexpr double kNoEnd = std::numeric_limits<double>::infinity();
    return {in_binder("half-space, n 1.5, albedo 0.9, g 0", 1.5, 0.9, 0, kNoEnd, {}),
            in_binder("half-space, n 1.33, albedo 0.99, g 0.875", 1.33, 0.99, 0.875, kNoEnd, {}),
            in_binder("film of depth 10 on black, n 1.5", 1.5, 0.98, 0.6, 10, 0.0),
            in_binder("film of depth 1 on white, n 1.5", 1.5, 0.98, 0.6, 1, 1.0)};
}

}  // namespace miebrdf::bench
