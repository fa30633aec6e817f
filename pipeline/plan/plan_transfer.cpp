#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>

#include "pipeline/plan/cost_model.h"
#include "pipeline/plan/planner.h"
#include "pipeline/solve/polarisation.h"
#include "pipeline/solve/rules.h"
#include "rte/math/tolerance_budget.h"

namespace miebrdf {
int Planner::all_orders() const {
    const int known = most_fourier_orders(scene_);
    return known > 0 ? known : size_.orders;
}

int Planner::orders() const {
    if (is_albedo() || only_zenith(request_.directions)) return 1;
    return only_across(request_.directions) ? (all_orders() + 1) / 2 : all_orders();
}

double Planner::transfer_cost(int orders, std::size_t layers) const {
    const double values =
        is_albedo() ? 0.0 : static_cast<double>(distinct_.computed()) * value_seconds(orders);
    return orders * order_seconds(size_, layers, cosines()) + values;
}

void Planner::radiative_transfer() {
    if (!needs_layers_ || jobs_.empty()) return;
    plan_.steps.push_back(
        {"radiative transfer",
         fmt::format("{}{} of {}{}, {}{} streams, {}",
                     orders() == 1 || most_fourier_orders(scene_) > 0 ? "" : "about ",
                     counted(static_cast<std::size_t>(orders()), "order"),
                     shows_substrate() ? "" : "a half-space and ",
                     counted(coats(), shows_substrate() ? "layer" : "coat"),
                     solver_.streams > 0 ? "" : "about ", size_.streams,
                     counted(cosines(), "cosine")),
         jobs_.size(), jobs() * transfer_cost(orders(), layers())});
    if (!is_albedo()) {
        plan_.steps.push_back({"energy check",
                               "plane albedo at every mu_in, from order 0 of the same solution",
                               jobs_.size(), 0.0});
    }
    leave_out_orders();
    if (!is_albedo() && only_across(request_.directions)) {
        leave_out(
            "across", "every azimuth is 90 or 270 degrees: odd orders vanish",
            jobs() * (transfer_cost(all_orders(), layers()) - transfer_cost(orders(), layers())));
    }
    if (distinct_.computed() < distinct_.requested() && !is_albedo()) {
        leave_out("same direction",
                  fmt::format("{} of {} combinations repeat another or its mirror image",
                              distinct_.requested() - distinct_.computed(), distinct_.requested()),
                  jobs() * static_cast<double>(distinct_.requested() - distinct_.computed()) *
                      value_seconds(orders()));
    }
    leave_out_solutions();
}

void Planner::polarisation() {
    // The ratio of solutions with three components over one, measured at 16 and 32 nodes; the sum
    // over orders is of one component more.
    constexpr double times_the_work = 10.0;
    if (!needs_layers_ || jobs_.empty()) return;
    const double solution_s = orders() * order_seconds(size_, layers(), cosines());
    const double more =
        (times_the_work - 1.0) * solution_s + (transfer_cost(orders(), layers()) - solution_s);
    std::map<std::string, std::size_t> scalar, polarised;
    std::size_t unknown = 0;
    for (const LayerJob& job : jobs_) {
        const LightChoice light = choose_light(request_, job.wavelength);
        if (!light.needs_comparison) {
            ++(light.components > 1 ? polarised : scalar)[light.reason];
        } else if (light.components > 1) {
            ++unknown;
        } else {
            ++scalar["scattering matrices of few sizes mostly tell that it does not show"];
        }
    }
    for (const auto& [reason, count] : polarised) {
        plan_.steps.push_back({"polarisation", "light of several components: " + reason, count,
                               static_cast<double>(count) * more});
    }
    if (unknown > 0) {
        plan_.steps.push_back({"polarisation",
                               "scattering matrices tell whether 3 components are needed, which "
                               "takes 10 times as long "
                               "as 1 and is counted here: small spheres mostly need them",
                               unknown, static_cast<double>(unknown) * more});
    }
    for (const auto& [reason, count] : scalar)
        leave_out("polarisation", reason, static_cast<double>(count) * more);
}

void Planner::leave_out_orders() {
    const double saved =
        jobs() * (transfer_cost(all_orders(), layers()) - transfer_cost(orders(), layers()));
    if (is_albedo()) {
        leave_out("albedo", "only order 0 carries flux: no other orders, no phase function", saved);
    } else if (only_zenith(request_.directions)) {
        leave_out("zenith", "all mu_in or all mu_out are 1: order 0 alone", saved);
    } else if (most_fourier_orders(scene_) > 0) {
        leave_out(
            "few orders",
            fmt::format("the moments of these media end: {} at most",
                        counted(static_cast<std::size_t>(most_fourier_orders(scene_)), "order")),
            jobs() * std::max(0.0, transfer_cost(2 * size_.streams, layers()) -
                                       transfer_cost(orders(), layers())));
    } else {
        leave_out("listed directions",
                  fmt::format("orders end where they no longer show at {}, within {} of the "
                              "tolerance",
                              counted(distinct_.computed(), "direction"), kFourierTailShare),
                  jobs() * std::max(0, 2 * size_.streams - orders()) *
                      order_seconds(size_, layers(), cosines()));
    }
}

void Planner::leave_out_solutions() {
    if (scene_.substrate) return;
    if (coats() > 1) {
        leave_out("one half-space",
                  fmt::format("{} coats on one base: its half-space is solved once", coats()),
                  jobs() * orders() * static_cast<double>(coats() - 1) *
                      order_seconds(size_, 1, cosines()));
    }
    if (scatters_nothing(scene_.media.front())) {
        leave_out("nothing scatters",
                  fmt::format("{} scatters nothing: a black ground",
                              describe(scene_.media.front().medium)),
                  jobs() * orders() * order_seconds(size_, 1, cosines()));
    }
}

void Planner::boundary() {
    if (!scene_.boundary || jobs_.empty()) return;
    // One Cholesky decomposition and some products for each order: measured with 24 nodes.
    constexpr double share = 0.2;
    const double cost = share * jobs() * transfer_cost(orders(), layers());
    if (scene_.top_index(0) - 1.0 < rte::kLeastIndexStep) {
        leave_out("no boundary", "the host of the top layer has the index of air", cost);
    } else {
        plan_.steps.push_back(
            {"boundary",
             fmt::format("{} boundary to an index of {:.4g}",
                         scene_.boundary->is_rough() ? "rough" : "smooth", scene_.top_index(0)),
             jobs_.size(), cost});
    }
}

void Planner::surface() {
    const double wavelengths = static_cast<double>(scene_.wavelength_nm.size());
    const double values = static_cast<double>(distinct_.computed()) * wavelengths * lobe_seconds();
    const bool whole = is_albedo() || parts_.total;
    // Albedos want rho for the mean over incidences too, and at the nodes of both solutions.
    constexpr double mean_nodes = 32.0;
    const double more =
        is_albedo() ? wavelengths * mean_nodes + jobs() * size_.streams * 5.0 / 3.0 : 0.0;
    const Directions& directions = request_.directions;
    const std::size_t both = scene_.coupling == rte::SurfaceCoupling::reciprocal ? cosines() : 0;
    const auto cosines_with_rho = static_cast<double>(std::max(directions.mu_in.size(), both));
    const double rho = whole ? (cosines_with_rho * wavelengths + more) * rho_seconds() : 0.0;
    const bool lobe = is_albedo() ? scene_.surface.has_value() : wants_lobe(scene_, parts_);
    if (!lobe) {
        leave_out("no surface", "no lobe in what was asked for: neither it nor its rho",
                  values + rho);
    } else if (is_symmetric(request_.directions) && !is_albedo()) {
        leave_out("reciprocity", "mu_in and mu_out are the same list: half of the lobe's table",
                  values / 2);
    }
    if (lobe) {
        const char* what = is_albedo() ? "rho at every cosine, at the nodes and for its mean"
                           : whole     ? "lobe at every direction, and rho"
                                       : "lobe at every direction";
        plan_.steps.push_back({"surface", what, scene_.wavelength_nm.size(), values + rho});
    }
    if (!is_albedo()) leave_out("no colour", "a table of a BRDF has no XYZ, Lab or RGB", 0.0);
}

}  // namespace miebrdf
