// Requests without a meaning: each must be refused, none may be answered.
#include <fmt/format.h>

#include <complex>
#include <limits>

#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>
#include <miebrdf/surface.h>
#include "rte/stack/layered_reflection.h"
#include "tools/stress/battery.h"

namespace miebrdf::stress {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

void refuse_spheres(Log& log) {
    for (const double x : {0.0, -1.0, kNaN, kInfinity}) {
        log.refused(fmt::format("sphere of size parameter {}", x), [=] {
            mie::scatter_by_sphere({1.5, 0}, x);
        });
    }
    for (const std::complex<double> m : {std::complex<double>(0, 0),
                                         {-1, 0},
                                         {1.5, -0.1},
                                         {kNaN, 0},
                                         {1.5, kNaN},
                                         {kInfinity, 0},
                                         {1000, 1},
                                         {1, 1e5}}) {
        log.refused(fmt::format("sphere of index {}+{}i", m.real(), m.imag()),
                    [=] { mie::scatter_by_sphere(m, 1); });
    }
    const auto ensemble = [&log](const std::string& name, auto change) {
        log.refused("ensemble, " + name, [change] {
            mie::EnsembleRequest request;
            request.refractive_index = {1.5, 0};
            request.sizes.effective_radius_um = 0.1;
            change(request);
            mie::average_over_sizes(request);
        });
    };
    for (const double bad : {0.0, -1.0, kNaN, kInfinity}) {
        ensemble(fmt::format("radius {}", bad),
                 [=](auto& r) { r.sizes.effective_radius_um = bad; });
        ensemble(fmt::format("variance {}", bad),
                 [=](auto& r) { r.sizes.effective_variance = bad; });
        ensemble(fmt::format("wavelength {}", bad), [=](auto& r) { r.wavelength_nm = bad; });
        ensemble(fmt::format("host index {}", bad), [=](auto& r) { r.host_index = bad; });
    }
    for (const double bad : {-1.0, 181.0, kNaN}) {
        ensemble(fmt::format("angle {}", bad), [=](auto& r) { r.angles_deg = {bad}; });
    }
}

void refuse_transfer(Log& log) {
    for (const double bad : {-1e-9, 1.0000001, kNaN, kInfinity}) {
        log.refused(fmt::format("albedo {}", bad), [=] {
            rte::Stack stack;
            stack.base.single_scattering_albedo = bad;
            rte::albedo(stack, {0.5});
        });
    }
    for (const double bad : {-1.0, 1.0, 2.0, kNaN}) {
        log.refused(fmt::format("asymmetry {}", bad),
                    [=] { rte::henyey_greenstein_optics(0.9, bad); });
    }
    const rte::Stack good{rte::isotropic_optics(0.9)};
    for (const double bad : {0.0, -0.5, 1.0000001, kNaN}) {
        log.refused(fmt::format("mu_in {}", bad), [=] { rte::reflect(good, {{bad}, {0.5}, {0}}); });
        log.refused(fmt::format("mu_out {}", bad), [=] {
            rte::reflect(good, {{0.5}, {bad}, {0}});
        });
        log.refused(fmt::format("plane albedo at {}", bad), [=] { rte::albedo(good, {bad}); });
    }
    for (const double bad : {kNaN, kInfinity}) {
        log.refused(fmt::format("azimuth {}", bad), [=] {
            rte::reflect(good, {{0.5}, {0.5}, {bad}});
        });
    }
    for (const double bad : {-1.0, kNaN}) {
        log.refused(fmt::format("optical depth {}", bad), [=] {
            rte::Stack stack = good;
            stack.coats.push_back({rte::isotropic_optics(0.5), bad});
            rte::albedo(stack, {0.5});
        });
    }
    for (const int bad : {-1, 1, 257}) {
        log.refused(fmt::format("{} streams", bad),
                    [=] { rte::albedo(good, {0.5}, {.streams = bad}); });
    }
    for (const double bad : {0.0, -1.0, 1.0, kNaN}) {
        log.refused(fmt::format("tolerance {}", bad),
                    [=] { rte::albedo(good, {0.5}, {.tolerance = bad}); });
    }
    log.refused("chi_0 other than 1", [=] {
        rte::Stack stack = good;
        stack.base.chi = {0.5};
        rte::albedo(stack, {0.5});
    });
    log.refused("|chi_1| above 1", [=] {
        rte::Stack stack = good;
        stack.base.chi = {1, 1.5};
        rte::albedo(stack, {0.5});
    });
}

void refuse_surfaces(Log& log) {
    for (const double bad : {0.0, 1e-5, 5.0, kNaN}) {
        log.refused(fmt::format("roughness {}", bad), [=] {
            rte::SurfaceOptions options;
            options.beckmann_alpha = bad;
            rte::directional_reflectance({1.5, 0}, options, 0.5);
        });
    }
    for (const std::complex<double> m :
         {std::complex<double>(0, 0), {1.5, -1}, {kNaN, 0}, {1.5, kInfinity}}) {
        log.refused(fmt::format("surface of index {}+{}i", m.real(), m.imag()),
                    [=] { rte::directional_reflectance(m, {}, 0.5); });
    }
    for (const double bad : {0.0, -1.0, 1.1, kNaN}) {
        log.refused(fmt::format("rho at cosine {}", bad), [=] {
            rte::directional_reflectance({1.5, 0}, {}, bad);
        });
    }
}

}  // namespace

void refusals(const Options&, std::vector<Check>& checks) {
    Log log("refusals", checks);
    refuse_spheres(log);
    refuse_transfer(log);
    refuse_surfaces(log);
}

}  // namespace miebrdf::stress
