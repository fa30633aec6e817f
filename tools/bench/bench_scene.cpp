#include "tools/bench/bench_scene.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace miebrdf::bench {
namespace {

// Small enough that the number of azimuthal orders is not what limits the error.
constexpr double kTightTolerance = 1e-10;

double henyey_greenstein(double g, double x) {
    const double base = (1 - g) * (1 - g) + 2 * g * (1 - x);
    return (1 - g * g) / (base * std::sqrt(base));
}

MomentLayer with_moments(const SimpleLayer& layer, double optical_depth) {
    MomentLayer m;
    m.single_scattering_albedo = layer.single_scattering_albedo;
    const double g = layer.asymmetry;
    double chi = 1;
    for (int l = 0; l == 0 || std::abs(chi) > 1e-20; ++l, chi *= g) m.chi.push_back(chi);
    m.phase = [g](double x) { return henyey_greenstein(g, x); };
    m.optical_depth = optical_depth;
    return m;
}

TracedLayer with_law(const SimpleLayer& layer) {
    return {layer.single_scattering_albedo, ScatteringLaw::henyey_greenstein(layer.asymmetry),
            layer.optical_depth};
}

std::size_t count(const Wanted& w) {
    return w.is_albedo() ? w.mu_in.size() : w.mu_in.size() * w.mu_out.size() * w.azimuth_deg.size();
}

std::vector<double> same_everywhere(const std::optional<double>& value, const Wanted& w) {
    if (!value) return {};
    return std::vector<double>(count(w), *value);
}

std::vector<double> single_scattering(const SimpleStack& s, const Wanted& w) {
    std::vector<double> values;
    for (const double i : w.mu_in) {
        for (const double o : w.mu_out) {
            for (const double azimuth : w.azimuth_deg) {
                const double x =
                    -i * o + std::sqrt((1 - i * i) * (1 - o * o)) * std::cos(azimuth * M_PI / 180);
                const double coat = s.coat ? henyey_greenstein(s.coat->asymmetry, x) : 0;
                values.push_back(single_scattering_reflection(
                    s, i, o, coat, henyey_greenstein(s.base.asymmetry, x)));
            }
        }
    }
    return values;
}

std::vector<double> two_stream(const SimpleStack& s, const Wanted& w) {
    std::vector<double> values;
    for (const double mu : w.mu_in) {
        const double albedo = two_stream_plane_albedo(s, mu);
        values.insert(values.end(), w.is_albedo() ? 1 : w.mu_out.size() * w.azimuth_deg.size(),
                      albedo);
    }
    return values;
}

Answer photons(const TracedStack& stack, const Wanted& w, int number) {
    std::vector<Detector> detectors;
    for (const double mu : w.mu_out) {
        for (const double azimuth : w.azimuth_deg) detectors.push_back({mu, azimuth});
    }
    Answer answer;
    for (const double mu : w.mu_in) {
        const auto traced = trace_photons(stack, mu, detectors, {.photons = number});
        if (w.is_albedo())
            answer.add(traced.plane_albedo.value, traced.plane_albedo.standard_error);
        for (const Estimate& e : traced.reflection) answer.add(e.value, e.standard_error);
    }
    return answer;
}

std::vector<double> textbook(const MomentStack& stack, const Wanted& w, int n,
                             const OrderSolver& solver) {
    return w.is_albedo() ? plane_albedo(stack, n, w.mu_in, solver)
                         : sum_orders(stack, n, w.mu_in, w.mu_out, w.azimuth_deg, solver);
}

}  // namespace

rte::Stack BenchScene::for_solver() const {
    const auto optics = [](const SimpleLayer& layer) {
        return layer.asymmetry == 0
                   ? rte::isotropic_optics(layer.single_scattering_albedo)
                   : rte::henyey_greenstein_optics(layer.single_scattering_albedo, layer.asymmetry);
    };
    rte::Stack stack;
    stack.base = optics(base);
    if (coat) stack.coats.push_back({optics(*coat), coat->optical_depth});
    return stack;
}

MomentStack BenchScene::for_textbooks() const {
    MomentStack stack;
    if (coat) stack.push_back(with_moments(*coat, coat->optical_depth));
    stack.push_back(with_moments(base, std::numeric_limits<double>::infinity()));
    return stack;
}

TracedStack BenchScene::for_photons() const {
    TracedStack stack{with_law(base), {}};
    if (coat) stack.coats.push_back(with_law(*coat));
    return stack;
}

std::vector<double> run_solver(const BenchScene& scene, const Wanted& w,
                               const rte::SolverOptions& options) {
    if (w.is_albedo()) return rte::albedo(scene.for_solver(), w.mu_in, options).plane_albedo;
    return rte::reflect(scene.for_solver(), {w.mu_in, w.mu_out, w.azimuth_deg}, options).reflection;
}

std::vector<Contender> library_methods(const BenchScene& scene, const Wanted& wanted) {
    std::vector<Contender> all;
    const auto add = [&](std::string method, std::string knob, rte::SolverOptions options) {
        all.push_back({std::move(method), std::move(knob),
                       [=] { return run_solver(scene, wanted, options); }});
    };
    for (const double t : {1e-1, 1e-2, 1e-3, 1e-4, 1e-6}) {
        add("miebrdf", fmt::format("tol={:.0e}", t), {.tolerance = t});
    }
    for (const int n : {4, 8, 16, 32, 64}) {
        const std::string knob = fmt::format("n={}", n);
        rte::SolverOptions options{.tolerance = kTightTolerance, .streams = n};
        options.grid = rte::GridKind::mapped_gauss;
        add("closed form, mapped Gauss", knob, options);
        options.grid = rte::GridKind::gauss;
        add("closed form, Gauss", knob, options);
        options.grid = rte::GridKind::paper;
        add("closed form, paper's grid", knob, options);
        if (n > 32) continue;
        options.grid = rte::GridKind::gauss;
        options.half_space_method = rte::HalfSpaceMethod::doubling;
        add("structured doubling, Gauss", knob, options);
    }
    rte::SolverOptions paper;
    paper.grid = rte::GridKind::paper;
    paper.half_space_method = rte::HalfSpaceMethod::fixed_point;
    paper.delta_m = false;
    paper.single_scattering_correction = false;
    const char* name = "paper: eq. 3 on its grid";
    if (scene.coat) {
        paper.coat_method = rte::CoatMethod::first_order_patched;
        name = "paper: eq. 2 and 3 on its grid";
    }
    for (const int n : {8, 16, 32}) {
        paper.streams = n;
        paper.tolerance = 1e-6;
        add(name, fmt::format("n={}", n), paper);
    }
    for (const double t : {1e-2, 1e-4}) {
        paper.tolerance = t;
        add(name, fmt::format("n=32, tol={:.0e}", t), paper);
    }
    return all;
}

std::vector<Contender> stepwise_coats(const BenchScene& scene, const Wanted& wanted) {
    const std::pair<rte::CoatMethod, const char*> methods[] = {
        {rte::CoatMethod::first_order, "paper: eq. 2"},
        {rte::CoatMethod::first_order_patched, "paper: eq. 2 with its patch"},
        {rte::CoatMethod::exponential, "exponential steps"}};
    std::vector<Contender> all;
    for (const auto& [method, name] : methods) {
        for (const int steps : {1, 4, 16, 64}) {
            rte::SolverOptions options{.tolerance = kTightTolerance, .streams = 32};
            options.coat_method = method;
            options.coat_substeps = steps;
            all.push_back({name, fmt::format("{} step{}", steps, steps == 1 ? "" : "s"),
                           [=] { return run_solver(scene, wanted, options); }});
        }
    }
    return all;
}

std::vector<Contender> outside_methods(const BenchScene& scene, const Wanted& wanted) {
    std::vector<Contender> all;
    const auto stack = scene.for_textbooks();
    for (const int n : {4, 8, 16}) {
        all.push_back({"adding-doubling", fmt::format("n={}", n), [=] {
                           return textbook(stack, wanted, n,
                                           [](const Order& o) { return adding_doubling(o); });
                       }});
    }
    for (const int n : {4, 8, 16, 32}) {
        all.push_back({"discrete ordinates per angle", fmt::format("n={}", n), [=] {
                           return textbook(stack, wanted, n,
                                           [](const Order& o) { return discrete_ordinates(o); });
                       }});
    }
    const auto traced = scene.for_photons();
    for (const int number : {100, 1000, 10000}) {
        all.push_back({"Monte Carlo", fmt::format("{} photons", number),
                       [=] { return photons(traced, wanted, number); }});
    }
    const auto simple = scene.for_approximations();
    if (kubelka_munk_reflectance(simple)) {
        all.push_back({"Kubelka-Munk", "-",
                       [=] { return same_everywhere(kubelka_munk_reflectance(simple), wanted); }});
    }
    if (!simple.coat) {
        all.push_back({"diffusion", "-",
                       [=] { return same_everywhere(diffusion_reflectance(simple), wanted); }});
    }
    all.push_back({"two-stream", "-", [=] { return two_stream(simple, wanted); }});
    if (!wanted.is_albedo()) {
        all.push_back(
            {"single scattering", "-", [=] { return single_scattering(simple, wanted); }});
    }
    return all;
}

std::vector<Contender> all_methods(const BenchScene& scene, const Wanted& wanted) {
    std::vector<Contender> methods = library_methods(scene, wanted);
    for (Contender& other : outside_methods(scene, wanted)) methods.push_back(std::move(other));
    return methods;
}

}  // namespace miebrdf::bench
