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

using Index = std::complex<double>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Each of the values must be refused.
/// @param name  of the case, with the place of the value
template <typename Value, typename Request>
void refuse(Log& log, const char* name, std::initializer_list<Value> values,
            const Request& request) {
    for (const Value& bad : values)
        log.refused(fmt::format(fmt::runtime(name), bad), [&] { request(bad); });
}

void refuse_spheres(Log& log) {
    refuse(log, "sphere of size parameter {}", {0.0, -1.0, kNaN, kInfinity}, [](double x) {
        mie::scatter_by_sphere({1.5, 0}, x);
    });
    for (const Index m : {Index(0, 0), Index(-1, 0), Index(1.5, -0.1), Index(kNaN, 0),
                          Index(1.5, kNaN), Index(kInfinity, 0), Index(1000, 1), Index(1, 1e5)})
        log.refused("sphere of index " + text_of(m), [=] { mie::scatter_by_sphere(m, 1); });
    const auto with = [](auto change) {
        return [change](double bad) {
            mie::EnsembleRequest request;
            request.refractive_index = {1.5, 0};
            request.sizes.effective_radius_um = 0.1;
            change(request, bad);
            mie::average_over_sizes(request);
        };
    };
    const auto numbers = {0.0, -1.0, kNaN, kInfinity};
    refuse(log, "ensemble, radius {}", numbers,
           with([](auto& r, double bad) { r.sizes.effective_radius_um = bad; }));
    refuse(log, "ensemble, variance {}", numbers,
           with([](auto& r, double bad) { r.sizes.effective_variance = bad; }));
    refuse(log, "ensemble, wavelength {}", numbers,
           with([](auto& r, double bad) { r.wavelength_nm = bad; }));
    refuse(log, "ensemble, host index {}", numbers,
           with([](auto& r, double bad) { r.host_index = bad; }));
    refuse(log, "ensemble, angle {}", {-1.0, 181.0, kNaN},
           with([](auto& r, double bad) { r.angles_deg = {bad}; }));
}

void refuse_transfer(Log& log) {
    const rte::Stack good{rte::isotropic_optics(0.9)};
    const auto with = [=](auto change) {
        return [=](double bad) {
            rte::Stack stack = good;
            change(stack, bad);
            rte::albedo(stack, {0.5});
        };
    };
    refuse(log, "albedo {}", {-1e-9, 1.0000001, kNaN, kInfinity},
           with([](auto& s, double bad) { s.base.single_scattering_albedo = bad; }));
    refuse(log, "asymmetry {}", {-1.0, 1.0, 2.0, kNaN},
           [](double bad) { rte::henyey_greenstein_optics(0.9, bad); });
    const auto cosines = {0.0, -0.5, 1.0000001, kNaN};
    refuse(log, "mu_in {}", cosines, [&](double mu) { rte::reflect(good, {{mu}, {0.5}, {0}}); });
    refuse(log, "mu_out {}", cosines, [&](double mu) { rte::reflect(good, {{0.5}, {mu}, {0}}); });
    refuse(log, "plane albedo at {}", cosines, [&](double mu) { rte::albedo(good, {mu}); });
    refuse(log, "azimuth {}", {kNaN, kInfinity}, [&](double bad) {
        rte::reflect(good, {{0.5}, {0.5}, {bad}});
    });
    refuse(log, "optical depth {}", {-1.0, kNaN}, with([](auto& s, double bad) {
               s.coats.push_back({rte::isotropic_optics(0.5), bad});
           }));
    refuse(log, "{} streams", {-1, 1, 257},
           [&](int bad) { rte::albedo(good, {0.5}, {.streams = bad}); });
    refuse(log, "tolerance {}", {0.0, -1.0, 1.0, kNaN},
           [&](double bad) { rte::albedo(good, {0.5}, {.tolerance = bad}); });
    refuse(log, "chi_0 other than 1", {0.5}, with([](auto& s, double bad) { s.base.chi = {bad}; }));
    refuse(log, "|chi_1| above 1", {1.5}, with([](auto& s, double bad) { s.base.chi = {1, bad}; }));
}

void refuse_surfaces(Log& log) {
    refuse(log, "roughness {}", {0.0, 1e-5, 5.0, kNaN}, [](double bad) {
        rte::SurfaceOptions options;
        options.beckmann_alpha = bad;
        rte::directional_reflectance({1.5, 0}, options, 0.5);
    });
    for (const Index m : {Index(0, 0), Index(1.5, -1), Index(kNaN, 0), Index(1.5, kInfinity)})
        log.refused("surface of index " + text_of(m),
                    [=] { rte::directional_reflectance(m, {}, 0.5); });
    refuse(log, "rho at cosine {}", {0.0, -1.0, 1.1, kNaN}, [](double mu) {
        rte::directional_reflectance({1.5, 0}, {}, mu);
    });
}

}  // namespace

void refusals(Log& log, bool) {
    refuse_spheres(log);
    refuse_transfer(log);
    refuse_surfaces(log);
}

}  // namespace miebrdf::stress
