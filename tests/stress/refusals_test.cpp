// Requests without a meaning: each must be refused, none may be answered.
#include <complex>
#include <exception>
#include <initializer_list>
#include <limits>

#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>
#include <miebrdf/surface.h>
#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

using Index = std::complex<double>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Each of the values must be refused.
/// @param name  of the request, with the place of the value
template <typename Value, typename Request>
void refuse(const char* name, std::initializer_list<Value> values, const Request& request) {
    for (const Value& bad : values) {
        CAPTURE(name, bad);
        CHECK_THROWS_AS(request(bad), std::exception);
    }
}

}  // namespace

TEST_CASE("spheres and ensembles without a meaning are refused", "[stress][errors]") {
    refuse("sphere of size parameter {}", {0.0, -1.0, kNaN, kInfinity}, [](double x) {
        mie::scatter_by_sphere({1.5, 0}, x);
    });
    for (const Index m : {Index(0, 0), Index(-1, 0), Index(1.5, -0.1), Index(kNaN, 0),
                          Index(1.5, kNaN), Index(kInfinity, 0), Index(1000, 1), Index(1, 1e5)})
        refuse("sphere of index {}", {m}, [](Index bad) { mie::scatter_by_sphere(bad, 1); });
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
    refuse("ensemble, radius {}", numbers,
           with([](auto& r, double bad) { r.sizes.effective_radius_um = bad; }));
    refuse("ensemble, variance {}", numbers,
           with([](auto& r, double bad) { r.sizes.effective_variance = bad; }));
    refuse("ensemble, wavelength {}", numbers,
           with([](auto& r, double bad) { r.wavelength_nm = bad; }));
    refuse("ensemble, host index {}", numbers,
           with([](auto& r, double bad) { r.host_index = bad; }));
    refuse("ensemble, angle {}", {-1.0, 181.0, kNaN},
           with([](auto& r, double bad) { r.angles_deg = {bad}; }));
}

TEST_CASE("media, directions and methods without a meaning are refused", "[stress][errors]") {
    const rte::Stack good{rte::isotropic_optics(0.9)};
    const auto with = [=](auto change) {
        return [=](double bad) {
            rte::Stack stack = good;
            change(stack, bad);
            rte::albedo(stack, {0.5});
        };
    };
    refuse("albedo {}", {-1e-9, 1.0000001, kNaN, kInfinity},
           with([](auto& s, double bad) { s.base.single_scattering_albedo = bad; }));
    refuse("asymmetry {}", {-1.0, 1.0, 2.0, kNaN},
           [](double bad) { rte::henyey_greenstein_optics(0.9, bad); });
    const auto cosines = {0.0, -0.5, 1.0000001, kNaN};
    refuse("mu_in {}", cosines, [&](double mu) { rte::reflect(good, {{mu}, {0.5}, {0}}); });
    refuse("mu_out {}", cosines, [&](double mu) { rte::reflect(good, {{0.5}, {mu}, {0}}); });
    refuse("plane albedo at {}", cosines, [&](double mu) { rte::albedo(good, {mu}); });
    refuse("azimuth {}", {kNaN, kInfinity}, [&](double bad) {
        rte::reflect(good, {{0.5}, {0.5}, {bad}});
    });
    refuse("optical depth {}", {-1.0, kNaN}, with([](auto& s, double bad) {
               s.coats.push_back({rte::isotropic_optics(0.5), bad});
           }));
    refuse("{} streams", {-1, 1, 257},
           [&](int bad) { rte::albedo(good, {0.5}, {.streams = bad}); });
    refuse("tolerance {}", {0.0, -1.0, 1.0, kNaN},
           [&](double bad) { rte::albedo(good, {0.5}, {.tolerance = bad}); });
    refuse("chi_0 other than 1", {0.5}, with([](auto& s, double bad) { s.base.chi = {bad}; }));
    refuse("|chi_1| above 1", {1.5}, with([](auto& s, double bad) { s.base.chi = {1, bad}; }));
}

TEST_CASE("rough surfaces without a meaning are refused", "[stress][errors]") {
    refuse("roughness {}", {0.0, 1e-5, 5.0, kNaN}, [](double bad) {
        rte::SurfaceOptions options;
        options.beckmann_alpha = bad;
        rte::directional_reflectance({1.5, 0}, options, 0.5);
    });
    for (const Index m : {Index(0, 0), Index(1.5, -1), Index(kNaN, 0), Index(1.5, kInfinity)})
        refuse("surface of index {}", {m},
               [](Index bad) { rte::directional_reflectance(bad, {}, 0.5); });
    refuse("rho at cosine {}", {0.0, -1.0, 1.1, kNaN}, [](double mu) {
        rte::directional_reflectance({1.5, 0}, {}, mu);
    });
}
