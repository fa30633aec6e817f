#include "tools/bench/scenes.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "rte/math/legendre.h"

namespace miebrdf::bench {
namespace {

// Small enough that the number of azimuthal orders is not what limits the error.
constexpr double kTightTolerance = 1e-10;

std::function<double(double)> phase_of(const rte::Optics& optics) {
    if (optics.phase) return optics.phase;
    return [chi = optics.chi](double x) { return math::legendre_series(chi, x); };
}

double asymmetry(const rte::Optics& optics) { return optics.chi.size() > 1 ? optics.chi[1] : 0.0; }

SimpleLayer simple_layer(const rte::Optics& optics, double depth) {
    return {optics.single_scattering_albedo, asymmetry(optics), depth};
}

/// A value for each incidence, alike in all outgoing directions.
template <typename Value>
std::vector<double> alike(const rte::Directions& w, const Value& at) {
    std::vector<double> values;
    for (const double mu : w.mu_in)
        values.insert(values.end(),
                      std::max<std::size_t>(1, w.mu_out.size() * w.azimuth_deg.size()), at(mu));
    return values;
}

std::vector<double> single_scattering(const rte::Stack& stack, const rte::Directions& w) {
    const SimpleStack s = simple(stack);
    const auto base = phase_of(stack.base);
    const auto coat = s.coat ? phase_of(stack.coats[0].optics) : base;
    std::vector<double> values;
    for_each_direction(w, [&](double i, double o, double azimuth) {
        const double x = cos_scattering(i, o, azimuth);
        values.push_back(single_scattering_reflection(s, i, o, coat(x), base(x)));
    });
    return values;
}

std::vector<double> textbook(const MomentStack& stack, const rte::Directions& w, int n,
                             const OrderSolver& solver) {
    return w.mu_out.empty() ? plane_albedo(stack, n, w.mu_in, solver)
                            : sum_orders(stack, n, w, solver);
}

}  // namespace

rte::Optics scatterers(double albedo, double g) {
    return g == 0 ? rte::isotropic_optics(albedo) : rte::henyey_greenstein_optics(albedo, g);
}

SimpleStack simple(const rte::Stack& stack) {
    SimpleStack s{simple_layer(stack.base, std::numeric_limits<double>::infinity()), {}};
    if (!stack.coats.empty())
        s.coat = simple_layer(stack.coats[0].optics, stack.coats[0].optical_depth);
    return s;
}

MomentStack moments_of(const rte::Stack& stack) {
    MomentStack layers;
    const auto add = [&](const rte::Optics& o, double depth) {
        layers.push_back({o.single_scattering_albedo, o.chi, phase_of(o), depth});
    };
    for (auto coat = stack.coats.rbegin(); coat != stack.coats.rend(); ++coat)
        add(coat->optics, coat->optical_depth);
    add(stack.base, std::numeric_limits<double>::infinity());
    return layers;
}

TracedStack traced(const rte::Stack& stack) {
    const auto layer = [](const rte::Optics& optics, double depth) {
        return TracedLayer{optics.single_scattering_albedo,
                           ScatteringLaw::henyey_greenstein(asymmetry(optics)), depth};
    };
    TracedStack t{layer(stack.base, 0), {}};
    for (const rte::Coat& coat : stack.coats)
        t.coats.push_back(layer(coat.optics, coat.optical_depth));
    if (stack.boundary) t.boundary = {stack.base_index, stack.boundary->roughness};
    if (stack.base_kind == rte::BaseKind::lambertian) t.ground_albedo = stack.ground_albedo;
    return t;
}

std::vector<Detector> detectors(const rte::Directions& wanted) {
    std::vector<Detector> all;
    for_each_direction({{1}, wanted.mu_out, wanted.azimuth_deg},
                       [&](double, double mu, double azimuth) {
                           all.push_back({mu, azimuth});
                       });
    return all;
}

std::vector<double> solved(const rte::Stack& stack, const rte::Directions& w,
                           const rte::SolverOptions& options) {
    return w.mu_out.empty() ? rte::albedo(stack, w.mu_in, options).plane_albedo
                            : rte::reflect(stack, w, options).reflection;
}

Answer photons(const TracedStack& stack, const rte::Directions& w, int number) {
    Answer answer;
    for (const double mu : w.mu_in) {
        const auto found = trace_photons(stack, mu, detectors(w), {.photons = number});
        if (w.mu_out.empty())
            answer.add(found.plane_albedo.value, found.plane_albedo.standard_error);
        for (const Estimate& e : found.reflection) answer.add(e.value, e.standard_error);
    }
    return answer;
}

void add_library_methods(const rte::Stack& stack, const rte::Directions& wanted, BenchCase& c) {
    const auto run = [=](const rte::SolverOptions& options) {
        return solved(stack, wanted, options);
    };
    c.add_each("miebrdf", "tol={:.0e}", {1e-1, 1e-2, 1e-3, 1e-4, 1e-6},
               [=](double t) { return run({.tolerance = t}); });
    const auto on = [=](rte::GridKind grid, rte::HalfSpaceMethod method = {}) {
        return [=](int n) {
            return run({.tolerance = kTightTolerance,
                        .grid = grid,
                        .streams = n,
                        .half_space_method = method});
        };
    };
    c.add_each("closed form, mapped Gauss", "n={}", {4, 8, 16, 32, 64},
               on(rte::GridKind::mapped_gauss));
    c.add_each("closed form, Gauss", "n={}", {4, 8, 16, 32, 64}, on(rte::GridKind::gauss));
    c.add_each("closed form, paper's grid", "n={}", {4, 8, 16, 32, 64}, on(rte::GridKind::paper));
    c.add_each("structured doubling, Gauss", "n={}", {4, 8, 16, 32},
               on(rte::GridKind::gauss, rte::HalfSpaceMethod::doubling));
    rte::SolverOptions paper{.tolerance = 1e-6,
                             .grid = rte::GridKind::paper,
                             .streams = 32,
                             .half_space_method = rte::HalfSpaceMethod::fixed_point,
                             .delta_m = false,
                             .single_scattering_correction = false};
    const bool is_coated = !stack.coats.empty();
    if (is_coated) paper.coat_method = rte::CoatMethod::first_order_patched;
    const char* name = is_coated ? "paper: eq. 2 and 3 on its grid" : "paper: eq. 3 on its grid";
    c.add_each(name, "n={}", {8, 16, 32}, [=](int n) {
        rte::SolverOptions options = paper;
        options.streams = n;
        return run(options);
    });
    c.add_each(name, "n=32, tol={:.0e}", {1e-2, 1e-4}, [=](double t) {
        rte::SolverOptions options = paper;
        options.tolerance = t;
        return run(options);
    });
}

void add_stepwise_coats(const rte::Stack& stack, const rte::Directions& wanted, BenchCase& c) {
    const std::pair<rte::CoatMethod, const char*> methods[] = {
        {rte::CoatMethod::first_order, "paper: eq. 2"},
        {rte::CoatMethod::first_order_patched, "paper: eq. 2 with its patch"},
        {rte::CoatMethod::exponential, "exponential steps"}};
    for (const auto& [method, name] : methods) {
        for (const int steps : {1, 4, 16, 64}) {
            const rte::SolverOptions options{.tolerance = kTightTolerance,
                                             .streams = 32,
                                             .coat_method = method,
                                             .coat_substeps = steps};
            c.add(name, fmt::format("{} step{}", steps, steps == 1 ? "" : "s"),
                  [=] { return solved(stack, wanted, options); });
        }
    }
}

void add_outside_methods(const rte::Stack& stack, const rte::Directions& wanted, BenchCase& c) {
    const MomentStack moments = moments_of(stack);
    c.add_each("adding-doubling", "n={}", {4, 8, 16}, [=](int n) {
        return textbook(moments, wanted, n, [](const Order& o) { return adding_doubling(o); });
    });
    c.add_each("discrete ordinates per angle", "n={}", {4, 8, 16, 32},
               [=](int n) { return textbook(moments, wanted, n, discrete_ordinates); });
    c.add_each("Monte Carlo", "{} photons", {100, 1000, 10000},
               [=, t = traced(stack)](int number) { return photons(t, wanted, number); });
    const SimpleStack s = simple(stack);
    const auto add_constant = [&](const char* method,
                                  std::optional<double> (*value)(const SimpleStack&)) {
        if (value(s))
            c.add(method, "-", [=] { return alike(wanted, [&](double) { return *value(s); }); });
    };
    add_constant("Kubelka-Munk", kubelka_munk_reflectance);
    add_constant("diffusion", [](const SimpleStack& of) { return diffusion_reflectance(of); });
    c.add("two-stream", "-",
          [=] { return alike(wanted, [&](double mu) { return two_stream_plane_albedo(s, mu); }); });
    if (!wanted.mu_out.empty())
        c.add("single scattering", "-", [=] { return single_scattering(stack, wanted); });
}

}  // namespace miebrdf::bench
