// No jump where Mie theory changes its method: recurrences, series lengths, rules of size nodes,
// precision, panels of the phase function.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>
#include "mie/sphere/radial_functions.h"
#include "mie/sphere/sphere_block.h"
#include "tools/stress/battery.h"

namespace miebrdf::stress {
namespace {

// Both sides of a switch, one by one and in the vectors that averages over sizes use.
void compare_spheres(Log& log, const std::string& what, Index m, const SwitchPoint& at) {
    log.run(fmt::format("{}, m {}, x {:.6g}", what, text_of(m), at.below), [&](const Case& is) {
        const auto a = mie::scatter_by_sphere(m, at.below), b = mie::scatter_by_sphere(m, at.above);
        is.at_most(
            "jump of q_sca, q_ext, g",
            std::max({relative_difference(a.q_sca, b.q_sca), relative_difference(a.q_ext, b.q_ext),
                      std::abs(a.asymmetry - b.asymmetry)}),
            2e-12 + 4e-16 / std::abs(m - 1.0), "1e-12 on each side as documented; digits of m - 1");
        for (const auto& [x, one] : {std::pair(at.below, a), std::pair(at.above, b)}) {
            const double size[] = {x}, weight[] = {1};
            const auto sums = mie::compute_spheres(m, size, weight, nullptr);
            is.at_most("q_sca of the vectors against the single sphere",
                       relative_difference(2 * sums.scattered / (x * x), one.q_sca),
                       1e-11 + 4e-16 / std::abs(m - 1.0),
                       "1e-11 as documented for the vectors; digits of m - 1");
        }
    });
}

// The recurrence that gives the wave inside: damped, upward or downward (logarithmic_derivatives).
long way_inside(Index m, double x) {
    const int terms = mie::number_of_terms(x);
    if (m.imag() == 0) return mie::upward_is_stable(m * x, terms) ? 1 : 0;
    if (mie::damped_logarithmic_derivative(m * x, terms)) return 2;
    return mie::upward_is_stable(m * x, terms) ? 1 : 0;
}

void check_spheres(Log& log) {
    for (const Index m : {Index(1.5, 0), Index(2.6, 1e-3), Index(1.5, 1), Index(0.2, 3.4),
                          Index(0.05, 0), Index(1 + 1e-7, 0)}) {
        compare_spheres(log, "cancellation-free series ends", m, {std::nextafter(0.5, 0), 0.5});
        compare_spheres(log, "vectors begin", m, {std::nextafter(2.0, 0), 2});
        for (const double x : {1e-3, 1.0, 10.0, 100.0, 1e3, 1e4}) {
            const auto terms = [](double size) { return long(mie::number_of_terms(size)); };
            for (const auto& at : find_switches(0.99 * x, 1.05 * x + 0.3, 1, terms)) {
                compare_spheres(log, "one more partial wave", m, at);
            }
        }
    }
    for (const Index m : {Index(10, 10), Index(100, 1), Index(1, 1000)}) {
        const double x = 4 / std::abs(m);
        compare_spheres(log, "cancellation-free series ends at |m| x = 4", m,
                        {x * (1 - 4e-16), x * (1 + 4e-16)});
    }
    for (const Index m :
         {Index(1.46, 0), Index(2.6, 0), Index(1.5, 1e-3), Index(1.5, 0.01), Index(1.5, 0.1),
          Index(2.6, 1e-3), Index(3.3, 0.02), Index(3, 0.3), Index(3, 4), Index(0.2, 3.4)}) {
        const auto way = [m](double x) { return way_inside(m, x); };
        for (const auto& at : find_switches(1, 3e4, 150, way)) {
            compare_spheres(log, "another recurrence inside", m, at);
        }
    }
}

mie::EnsembleRequest request_of(Index m, double radius_um, double tolerance, int moments) {
    mie::EnsembleRequest request;
    request.sizes.effective_radius_um = radius_um;
    request.refractive_index = m;
    request.highest_moment = moments;
    request.tolerance = tolerance;
    return request;
}

void compare_ensembles(Log& log, const std::string& name, const mie::EnsembleRequest& below,
                       const mie::EnsembleRequest& above) {
    log.run(name, [&](const Case& is) {
        const auto a = mie::average_over_sizes(below), b = mie::average_over_sizes(above);
        double jump =
            std::max({relative_difference(a.q_ext, b.q_ext), std::abs(a.asymmetry - b.asymmetry),
                      relative_difference(a.single_scattering_albedo, b.single_scattering_albedo)});
        for (std::size_t l = 0; l < std::min(a.chi.size(), b.chi.size()); ++l) {
            jump = std::max(jump, std::abs(a.chi[l] - b.chi[l]));
        }
        is.at_most("jump of q_ext, albedo and moments", jump,
                   2 * (std::max(below.tolerance, a.error_estimate) +
                        std::max(above.tolerance, b.error_estimate)),
                   "two averages; moments err by up to twice their estimate in 95 % of "
                   "transparent ensembles (mie/ensemble/ensemble_average.cpp)");
    });
}

void check_ensembles(Log& log, bool fast) {
    const double per_um = 2 * std::numbers::pi / 0.55;
    const double radius = fast ? 2 : 10;
    // Size parameters where resonances are damped (k x = 1), and where spheres are small (x = 3).
    const double k = 1 / (per_um * radius);
    const double small = 3 / per_um / mie::radius_range({}).largest_um * 50;
    for (const double tolerance : {1e-3, 1e-5}) {
        compare_ensembles(log, fmt::format("resonances damped, tolerance {:.0e}", tolerance),
                          request_of({1.5, k * (1 - 1e-9)}, radius, tolerance, 64),
                          request_of({1.5, k * (1 + 1e-9)}, radius, tolerance, 64));
        for (const double imaginary : {0.0, 1e-3}) {
            compare_ensembles(
                log, fmt::format("small spheres, k {}, tolerance {:.0e}", imaginary, tolerance),
                request_of({1.5, imaginary}, small * (1 - 1e-9), tolerance, 16),
                request_of({1.5, imaginary}, small * (1 + 1e-9), tolerance, 16));
        }
    }
    for (const Index m : {Index(1.5, 0), Index(3.3, 0.02)}) {
        const std::string medium = fmt::format("m {}", text_of(m));
        compare_ensembles(log, "moments from the phase table beyond 200, " + medium,
                          request_of(m, radius, 1e-3, 200), request_of(m, radius, 1e-3, 201));
        compare_ensembles(log, "moments from the table down to tolerance 1e-5, " + medium,
                          request_of(m, radius, 1e-5, 201),
                          request_of(m, radius, 1e-5 * (1 - 1e-9), 201));
        compare_ensembles(log, "double precision below tolerance 1e-7, " + medium,
                          request_of(m, 0.2 * radius, 1e-7, 32),
                          request_of(m, 0.2 * radius, 1e-7 * (1 - 1e-9), 32));
    }
}

// The largest jump of f inside (a, b): the half that changes more, again and again.
template <typename Function>
double largest_jump(const Function& f, double a, double b) {
    double at_a = f(a), at_b = f(b);
    while (b - a > 1e-13) {
        const double middle = 0.5 * (a + b), here = f(middle);
        const bool left = std::abs(here - at_a) > std::abs(at_b - here);
        (left ? b : a) = middle;
        (left ? at_b : at_a) = here;
    }
    return relative_difference(at_a, at_b);
}

void check_panels(Log& log, bool fast) {
    for (const Index m : {Index(1.5, 0), Index(2.6, 0), Index(3.3, 0.02)}) {
        for (const double radius : {1.0, fast ? 2.0 : 10.0}) {
            log.run(fmt::format("phase function of {} um, m {}", radius, text_of(m)),
                    [&](const Case& is) {
                        auto request = request_of(m, radius, 1e-3, 8);
                        request.with_phase_table = true;
                        const auto table = mie::average_over_sizes(request).phase_table;
                        const auto at = [&](double theta) { return (*table)(std::cos(theta)); };
                        double worst = 0;
                        constexpr int intervals = 1000;
                        const double width = std::numbers::pi / intervals;
                        for (int i = 0; i < intervals; ++i) {
                            const double jump = largest_jump(at, i * width, (i + 1) * width);
                            if (!(jump <= worst)) worst = jump;
                        }
                        is.at_most(
                            "largest jump from panel to panel, relative", worst, 1e-9,
                            "neighbours share the value at their edge: rounding, and the slope "
                            "over 1e-13 rad");
                    });
        }
    }
}

}  // namespace

void sphere_switches(Log& log, bool fast) {
    check_spheres(log);
    check_ensembles(log, fast);
    check_panels(log, fast);
}

}  // namespace miebrdf::stress
