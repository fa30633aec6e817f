// Refracting boundaries: indices from 1.0001 to 3, grazing light, depths from 1e-12 to 1e6, layers
// without absorption, mirrors; and photons as the check from outside.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/stress/battery.h"

namespace miebrdf::stress {
namespace {

using bench::scatterers;
using rte::BaseKind;

const std::vector<double> kCosines = {1e-3, 0.05, 0.3, 1.0};
constexpr std::complex<double> kAluminium{0.96, 6.69};
const rte::SolverOptions kSolver{.tolerance = 1e-13, .streams = 32};

rte::Stack half_space(const rte::Optics& medium, double index, double roughness = 0) {
    return {.base = medium, .base_index = index, .boundary = rte::Boundary{.roughness = roughness}};
}

rte::Stack film(const rte::Optics& medium, double depth, double index, BaseKind kind,
                double ground = 0) {
    return {.coats = {{medium, depth, index}},
            .base_kind = kind,
            .ground_albedo = ground,
            .mirror_index = kAluminium,
            .base_index = index,
            .boundary = rte::Boundary{}};
}

rte::Stack free_film(const rte::Optics& medium, double depth, double index) {
    rte::Stack stack = film(medium, depth, index, BaseKind::none);
    stack.mirror_index = 1.0;
    return stack;
}

/// 32 nodes reach this: the reflectance has a root next to grazing as the index tends to 1.
double rounding(double index) { return index >= 1.1 ? 1e-12 : index >= 1.01 ? 1e-10 : 1e-6; }

void check_sum(Log& log, const std::string& name, const rte::Stack& stack, double bound) {
    log.run(name, [&](const Case& is) {
        const auto a = rte::albedo(stack, kCosines, kSolver);
        std::vector<double> sums = a.plane_albedo;
        for (std::size_t i = 0; i < sums.size() && !a.transmittance.empty(); ++i)
            sums[i] += a.transmittance[i];
        is.at_most("reflected + passed - 1",
                   worst(sums, [](double sum) { return std::abs(sum - 1); }), bound,
                   "energy; 32 nodes at this index (docs/maths-boundary.md)");
    });
}

void check_energy(Log& log) {
    for (const double index : {1.0001, 1.001, 1.01, 1.1, 1.33, 1.5, 2.0, 3.0}) {
        const auto check = [&](const std::string& name, const rte::Stack& stack) {
            check_sum(log, name, stack, rounding(index));
        };
        for (const double g : {0.0, 0.8}) {
            check(fmt::format("white half-space, n {}, g {}", index, g),
                  half_space(scatterers(1, g), index));
            for (const double depth : {1e-6, 1e-2, 1.0, 1e3, 1e6})
                check(fmt::format("free film, n {}, g {}, depth {:.0e}", index, g, depth),
                      free_film(scatterers(1, g), depth, index));
        }
        for (const double depth : {1e-6, 1.0, 1e6}) {
            check(fmt::format("film on aluminium, n {}, depth {:.0e}", index, depth),
                  film(scatterers(1, 0.5), depth, index, BaseKind::mirror));
            check(fmt::format("film on white, n {}, depth {:.0e}", index, depth),
                  film(scatterers(1, 0.5), depth, index, BaseKind::lambertian, 1));
        }
    }
    for (const double below : {1.33, 1.5, 1.6}) {
        auto two_hosts = half_space(scatterers(1, 0.5), below);
        two_hosts.coats = {{scatterers(1, 0.8), 0.5, 1.45}};
        check_sum(log, fmt::format("white layers, n 1.45 on {}", below), two_hosts,
                  1e-8);  // three panels share the nodes
    }
    for (const double index : {1.05, 1.33, 1.5, 3.0}) {
        for (const double alpha : {0.02, 0.1, 0.5, 1.0}) {
            for (const bool is_ggx : {true, false}) {
                auto stack = half_space(scatterers(1, 0.5), index, alpha);
                stack.boundary->distribution = is_ggx ? rte::MicrofacetDistribution::ggx
                                                      : rte::MicrofacetDistribution::beckmann;
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
    auto two_hosts = half_space(scatterers(0.95, 0.6), 1.4);
    two_hosts.coats = {{scatterers(0.8, 0.3), 0.3, index}};
    return {{"half-space", half_space(scatterers(0.95, 0.6), index)},
            {"free film", free_film(scatterers(0.9, 0.6), 1, index)},
            {"film on aluminium", film(scatterers(0.9, 0.6), 0.5, index, BaseKind::mirror)},
            {"two hosts", two_hosts},
            {"rough", half_space(scatterers(0.95, 0.6), std::max(index, 1.05), 0.3)}};
}

void check_reciprocity(Log& log) {
    for (const double index : {1.001, 1.05, 1.5, 3.0}) {
        for (const auto& [kind, stack] : kinds_of_scenes(index)) {
            log.run(fmt::format("{}, n {}", kind, index), [&, &of = stack](const Case& is) {
                double worst = 0, least = INFINITY;
                see_reciprocal(reflection(of), kCosines.size(), 3, [&](double r, double back) {
                    const double d = relative_difference(r, back);
                    if (!(d <= worst)) worst = d;
                    least = std::min(least, r);
                });
                is.at_most("R(in, out) / R(out, in) - 1", worst, 1e-10,
                           "Helmholtz reciprocity; rounding of small values at grazing");
                is.at_most("-R", -least, 0, "light is not negative");
            });
        }
    }
}

void check_continuity(Log& log) {
    for (const double index : {1.0011, 1.0499, 1.05, 1.1, 1.4, 1.5, 2.999}) {
        const auto before = kinds_of_scenes(index), after = kinds_of_scenes(index * (1 + 1e-9));
        for (std::size_t k = 0; k + 1 < before.size(); ++k) {  // but for the rough one
            log.run(fmt::format("{}, step of 1e-9 at n {}", before[k].first, index),
                    [&](const Case& is) {
                        // At 1.05 the nodes change (refraction_grid.cpp).
                        is.at_most("R, relative change",
                                   largest_difference(reflection(before[k].second),
                                                      reflection(after[k].second)),
                                   index == 1.05 ? 1e-4 : 2e-5,
                                   "at mu 1e-3 R follows r, which goes as mu / (n - 1)^(1/2); "
                                   "rounding");
                    });
        }
    }
}

/// Of diffuse light from inside, by Duntley 1942 from the definition: (1 - r_int) n^2 = 1 - r_ext.
double internal_reflectance(double index) {
    double outside = 0;
    constexpr int kSteps = 200000;
    for (int i = 0; i < kSteps; ++i) {
        const double mu = (i + 0.5) / kSteps;
        outside += 2 * mu * bench::fresnel(index, mu).reflectance / kSteps;
    }
    return 1 - (1 - outside) / (index * index);
}

void check_limits(Log& log, double index) {
    log.run(fmt::format("film of depth 1e6, n {}", index), [&](const Case& is) {
        const auto medium = scatterers(0.95, 0.6);
        is.at_most("R against the half-space, relative",
                   largest_difference(reflection(film(medium, 1e6, index, BaseKind::lambertian)),
                                      reflection(half_space(medium, index))),
                   1e-10, "nothing comes back from below; rounding");
    });
    for (const double ground : {0.2, 0.9}) {
        log.run(
            fmt::format("varnish of depth 1e-12, n {}, on {}", index, ground), [&](const Case& is) {
                const auto varnish =
                    film(scatterers(0.5, 0), 1e-12, index, BaseKind::lambertian, ground);
                const double truth = bench::saunderson(ground, bench::fresnel(index, 1).reflectance,
                                                       internal_reflectance(index));
                is.at_most("plane albedo off Saunderson's",
                           std::abs(rte::albedo(varnish, {1.0}, kSolver).plane_albedo[0] - truth),
                           1e-8, "closed form; midpoint rule of 2e5 steps");
            });
    }
}

void check_photons(Log& log, int photons) {
    const auto compare = [&](const char* kind, const rte::Stack& smooth, double index, double alpha,
                             double mu_in) {
        rte::Stack stack = smooth;
        stack.boundary->roughness = alpha;
        log.run(fmt::format("photons: n {}, {}{}, mu_in {}", index, kind,
                            alpha > 0 ? fmt::format(", rough {}", alpha) : "", mu_in),
                [&](const Case& is) {
                    compare_with_photons(is, stack, {{mu_in}, {0.1, 0.5, 0.95}, {0, 120, 180}},
                                         alpha > 0 ? 4 * photons : photons);
                });
    };
    const auto compare_both = [&](double index, double other, double alpha, double mu_in) {
        compare("albedo 0.9, g 0.5, half-space", half_space(scatterers(0.9, 0.5), index), index,
                alpha, mu_in);
        compare("albedo 0.8, g 0.7, depth 1.5 on 0.6",
                film(scatterers(0.8, 0.7), 1.5, other, BaseKind::lambertian, 0.6), other, alpha,
                mu_in);
    };
    for (const double mu_in : {0.2, 0.8}) {
        for (const double index : {1.05, 1.33, 1.5, 2.0}) compare_both(index, index, 0, mu_in);
        for (const double alpha : {0.05, 0.2, 0.5, 1.0}) compare_both(1.5, 1.33, alpha, mu_in);
    }
}

}  // namespace

void boundaries(Log& log, bool fast) {
    check_energy(log);
    check_reciprocity(log);
    check_continuity(log);
    for (const double index : {1.1, 1.5, 3.0}) check_limits(log, index);
    check_photons(log, fast ? 2000 : 40000);
}

}  // namespace miebrdf::stress
