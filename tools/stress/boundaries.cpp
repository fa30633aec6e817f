// Refracting boundaries: indices from 1.0001 to 3, grazing light, depths from 1e-12 to 1e6, layers
// without absorption, mirrors; and photons as the check from outside.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rte/stack/layered_reflection.h"
#include "tools/bench/photon_tracer.h"
#include "tools/stress/battery.h"

namespace miebrdf::stress {
namespace {

const std::vector<double> kCosines = {1e-3, 0.05, 0.3, 1.0};
constexpr std::complex<double> kAluminium{0.96, 6.69};
const rte::SolverOptions kSolver{.tolerance = 1e-13, .streams = 32};

rte::Optics optics(double albedo, double g) {
    return g == 0 ? rte::isotropic_optics(albedo) : rte::henyey_greenstein_optics(albedo, g);
}

rte::Stack half_space(const rte::Optics& medium, double index, double roughness = 0) {
    rte::Stack stack;
    stack.base = medium;
    stack.base_index = index;
    stack.boundary = rte::Boundary{.roughness = roughness};
    return stack;
}

rte::Stack film(const rte::Optics& medium, double depth, double index, rte::BaseKind kind) {
    rte::Stack stack = half_space({}, index);
    stack.base_kind = kind;
    stack.coats = {{medium, depth, index}};
    return stack;
}

/// 32 nodes reach this: the reflectance has a root next to grazing as the index tends to 1.
double rounding(double index) {
    if (index >= 1.1) return 1e-12;
    return index >= 1.01 ? 1e-10 : 1e-6;
}

void check_sum(Log& log, const std::string& name, const rte::Stack& stack, double bound) {
    log.run(name, [&] {
        const auto a = rte::albedo(stack, kCosines, kSolver);
        double worst = 0;
        for (std::size_t i = 0; i < kCosines.size(); ++i) {
            const double passed = a.transmittance.empty() ? 0 : a.transmittance[i];
            const double off = std::abs(a.plane_albedo[i] + passed - 1);
            if (!(off <= worst)) worst = off;
        }
        log.at_most(name, "reflected + passed - 1", worst, bound,
                    "energy; 32 nodes at this index (docs/maths-boundary.md)");
    });
}

void check_energy(Log& log) {
    for (const double index : {1.0001, 1.001, 1.01, 1.1, 1.33, 1.5, 2.0, 3.0}) {
        for (const double g : {0.0, 0.8}) {
            check_sum(log, fmt::format("white half-space, n {}, g {}", index, g),
                      half_space(optics(1, g), index), rounding(index));
            for (const double depth : {1e-6, 1e-2, 1.0, 1e3, 1e6}) {
                check_sum(log, fmt::format("free film, n {}, g {}, depth {:.0e}", index, g, depth),
                          film(optics(1, g), depth, index, rte::BaseKind::none), rounding(index));
            }
        }
        for (const double depth : {1e-6, 1.0, 1e6}) {
            auto on_mirror = film(optics(1, 0.5), depth, index, rte::BaseKind::mirror);
            on_mirror.mirror_index = kAluminium;
            check_sum(log, fmt::format("film on aluminium, n {}, depth {:.0e}", index, depth),
                      on_mirror, rounding(index));
            auto on_white = film(optics(1, 0.5), depth, index, rte::BaseKind::lambertian);
            on_white.ground_albedo = 1;
            check_sum(log, fmt::format("film on white, n {}, depth {:.0e}", index, depth), on_white,
                      rounding(index));
        }
    }
    for (const double below : {1.33, 1.5, 1.6}) {
        auto two_hosts = half_space(optics(1, 0.5), below);
        two_hosts.coats = {{optics(1, 0.8), 0.5, 1.45}};
        check_sum(log, fmt::format("white layers, n 1.45 on {}", below), two_hosts,
                  1e-8);  // three panels share the nodes
    }
}

void check_rough_energy(Log& log) {
    for (const double index : {1.05, 1.33, 1.5, 3.0}) {
        for (const double alpha : {0.02, 0.1, 0.5, 1.0}) {
            for (const auto facets :
                 {rte::MicrofacetDistribution::ggx, rte::MicrofacetDistribution::beckmann}) {
                auto stack = half_space(optics(1, 0.5), index, alpha);
                stack.boundary->distribution = facets;
                const bool is_ggx = facets == rte::MicrofacetDistribution::ggx;
                check_sum(log,
                          fmt::format("rough, white, n {}, alpha {}, {}", index, alpha,
                                      is_ggx ? "GGX" : "Beckmann"),
                          stack, 1e-11);
            }
        }
    }
}

std::vector<double> reflection(const rte::Stack& stack) {
    return rte::reflect(stack, {kCosines, kCosines, {0, 90, 180}}, kSolver).reflection;
}

std::vector<std::pair<std::string, rte::Stack>> kinds_of_scenes(double index) {
    std::vector<std::pair<std::string, rte::Stack>> scenes;
    scenes.emplace_back("half-space", half_space(optics(0.95, 0.6), index));
    scenes.emplace_back("free film", film(optics(0.9, 0.6), 1, index, rte::BaseKind::none));
    auto on_mirror = film(optics(0.9, 0.6), 0.5, index, rte::BaseKind::mirror);
    on_mirror.mirror_index = kAluminium;
    scenes.emplace_back("film on aluminium", on_mirror);
    auto two_hosts = half_space(optics(0.95, 0.6), 1.4);
    two_hosts.coats = {{optics(0.8, 0.3), 0.3, index}};
    scenes.emplace_back("two hosts", two_hosts);
    scenes.emplace_back("rough", half_space(optics(0.95, 0.6), std::max(index, 1.05), 0.3));
    return scenes;
}

void check_reciprocity(Log& log) {
    for (const double index : {1.001, 1.05, 1.5, 3.0}) {
        for (const auto& [kind, stack] : kinds_of_scenes(index)) {
            const std::string name = fmt::format("{}, n {}", kind, index);
            log.run(name, [&, &stack = stack] {
                const auto r = reflection(stack);
                const std::size_t n = kCosines.size();
                double worst = 0, least = INFINITY;
                for (std::size_t i = 0; i < n; ++i) {
                    for (std::size_t o = 0; o < n; ++o) {
                        for (std::size_t a = 0; a < 3; ++a) {
                            const double d =
                                relative_difference(r[(i * n + o) * 3 + a], r[(o * n + i) * 3 + a]);
                            if (!(d <= worst)) worst = d;
                            least = std::min(least, r[(i * n + o) * 3 + a]);
                        }
                    }
                }
                log.at_most(name, "R(in, out) / R(out, in) - 1", worst, 1e-10,
                            "Helmholtz reciprocity; rounding of small values at grazing");
                log.at_most(name, "-R", -least, 0, "light is not negative");
            });
        }
    }
}

void check_continuity(Log& log) {
    for (const double index : {1.0011, 1.0499, 1.05, 1.1, 1.4, 1.5, 2.999}) {
        const auto before = kinds_of_scenes(index), after = kinds_of_scenes(index * (1 + 1e-9));
        for (std::size_t k = 0; k + 1 < before.size(); ++k) {  // but for the rough one
            const std::string name =
                fmt::format("{}, step of 1e-9 at n {}", before[k].first, index);
            log.run(name, [&] {
                // At 1.05 the nodes change (refraction_grid.cpp).
                const bool new_grid = index == 1.05;
                log.at_most(
                    name, "R, relative change",
                    largest_difference(reflection(before[k].second), reflection(after[k].second)),
                    new_grid ? 1e-4 : 2e-5,
                    "at mu 1e-3 R follows r, which goes as mu / (n - 1)^(1/2); rounding");
            });
        }
    }
}

void check_limits(Log& log) {
    for (const double index : {1.1, 1.5, 3.0}) {
        const std::string thick = fmt::format("film of depth 1e6, n {}", index);
        log.run(thick, [&] {
            const auto medium = optics(0.95, 0.6);
            log.at_most(
                thick, "R against the half-space, relative",
                largest_difference(reflection(film(medium, 1e6, index, rte::BaseKind::lambertian)),
                                   reflection(half_space(medium, index))),
                1e-10, "nothing comes back from below; rounding");
        });
        for (const double ground : {0.2, 0.9}) {
            const std::string thin =
                fmt::format("varnish of depth 1e-12, n {}, on {}", index, ground);
            log.run(thin, [&] {
                auto varnish = film(optics(0.5, 0), 1e-12, index, rte::BaseKind::lambertian);
                varnish.ground_albedo = ground;
                const auto a = rte::albedo(varnish, {1.0}, kSolver);
                const double r = std::pow((index - 1) / (index + 1), 2);
                // Duntley 1942 from the definition: (1 - r_int) n^2 = 1 - r_ext.
                double outside_diffuse = 0;
                constexpr int kSteps = 200000;
                for (int i = 0; i < kSteps; ++i) {
                    const double mu = (i + 0.5) / kSteps;
                    outside_diffuse += 2 * mu * bench::fresnel(index, mu).reflectance / kSteps;
                }
                const double inside_diffuse = 1 - (1 - outside_diffuse) / (index * index);
                const double truth =
                    r + (1 - r) * (1 - inside_diffuse) * ground / (1 - inside_diffuse * ground);
                log.at_most(thin, "plane albedo off Saunderson's",
                            std::abs(a.plane_albedo[0] - truth), 1e-8,
                            "closed form; midpoint rule of 2e5 steps");
            });
        }
    }
}

struct PhotonScene {
    double index, albedo, g, depth, ground, roughness;
};

void compare_with_photons(Log& log, const PhotonScene& s, double mu_in, int photons) {
    const bool is_film = s.depth > 0;
    const std::string name = fmt::format(
        "photons: n {}, albedo {}, g {}, {}{}, mu_in {}", s.index, s.albedo, s.g,
        is_film ? fmt::format("depth {} on {}", s.depth, s.ground) : std::string("half-space"),
        s.roughness > 0 ? fmt::format(", rough {}", s.roughness) : "", mu_in);
    log.run(name, [&] {
        const auto law = bench::ScatteringLaw::henyey_greenstein(s.g);
        bench::TracedStack traced;
        traced.base = {s.albedo, law, 0};
        traced.boundary = {s.index, s.roughness};
        rte::Stack stack = half_space(optics(s.albedo, s.g), s.index);
        if (is_film) {
            traced.coats = {{s.albedo, law, s.depth}};
            traced.ground_albedo = s.ground;
            stack = film(optics(s.albedo, s.g), s.depth, s.index, rte::BaseKind::lambertian);
            stack.ground_albedo = s.ground;
        }
        stack.boundary->roughness = s.roughness;
        std::vector<bench::Detector> detectors;
        const rte::Directions directions{{mu_in}, {0.1, 0.5, 0.95}, {0, 120, 180}};
        if (s.roughness == 0) {
            for (const double mu : directions.mu_out) {
                for (const double azimuth : directions.azimuth_deg)
                    detectors.push_back({mu, azimuth});
            }
        }
        const auto estimate = bench::trace_photons(traced, mu_in, detectors, {.photons = photons});
        // 4.5 standard errors: see the suite `photons`.
        const auto off = [](const bench::Estimate& e, double truth, double allowance) {
            const double missing = truth - e.value;
            return (std::max(-missing, missing - e.unfinished) - allowance) / e.standard_error;
        };
        // The rough boundary itself follows the walk to 2e-3 of the light.
        const double allowance = s.roughness > 0 ? 2e-3 : 0;
        const double albedo = rte::albedo(stack, {mu_in}, {.tolerance = 1e-4}).plane_albedo[0];
        log.at_most(name, "plane albedo off the photons', standard errors",
                    off(estimate.plane_albedo, albedo, allowance), 4.5, "noise of the photons");
        if (detectors.empty()) return;
        const auto solved = rte::reflect(stack, directions, {.tolerance = 1e-4}).reflection;
        double worst = 0;
        for (std::size_t d = 0; d < detectors.size(); ++d) {
            const double sigmas = off(estimate.reflection[d], solved[d], 0);
            if (!(sigmas <= worst)) worst = sigmas;
        }
        log.at_most(name, "largest R off the photons', standard errors", worst, 4.5,
                    "noise of the photons");
    });
}

void check_photons(Log& log, int photons) {
    for (const double mu_in : {0.2, 0.8}) {
        for (const double index : {1.05, 1.33, 1.5, 2.0}) {
            compare_with_photons(log, {index, 0.9, 0.5, 0, 0, 0}, mu_in, photons);
            compare_with_photons(log, {index, 0.8, 0.7, 1.5, 0.6, 0}, mu_in, photons);
        }
        for (const double roughness : {0.05, 0.2, 0.5, 1.0}) {
            compare_with_photons(log, {1.5, 0.9, 0.5, 0, 0, roughness}, mu_in, 4 * photons);
            compare_with_photons(log, {1.33, 0.8, 0.7, 1.5, 0.6, roughness}, mu_in, 4 * photons);
        }
    }
}

}  // namespace

void boundaries(const Options& options, std::vector<Check>& checks) {
    Log log("boundaries", checks);
    check_energy(log);
    check_rough_energy(log);
    check_reciprocity(log);
    check_continuity(log);
    check_limits(log);
    check_photons(log, options.fast ? 2000 : 40000);
}

}  // namespace miebrdf::stress
