#include "pipeline/plan/planner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "pipeline/plan/cost_model.h"
#include "pipeline/plan/rules.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/hidden_layers.h"

namespace miebrdf {

Planner::Planner(const Request& request, LayerQuantity quantity, ResultCache* cache,
                 EarlierWork& earlier)
    : request_(request),
      quantity_(quantity),
      cache_(cache),
      earlier_(earlier),
      media_(request),
      distinct_(request.directions),
      reduced_(request) {
    reduced_.directions = distinct_.directions();
    reduced_.scene = media_.scene();
    whole_phase_ = demand_of(reduced_, phase_demand(quantity)).whole_phase_function;
    streams_ = expected_streams(reduced_);
    needs_layers_ = is_albedo() || wants_layers(request.parts);
}

Plan Planner::plan() {
    list_jobs();
    for (const CoatMedium& coat : request_.scene.coats) {
        if (has_no_depth(coat)) leave_out_coat(coat);
    }
    hide_layers();
    single_scattering();
    radiative_transfer();
    surface();
    return std::move(plan_);
}

std::size_t Planner::cosines() const {
    return reduced_.directions.mu_in.size() + reduced_.directions.mu_out.size();
}

double Planner::mie_cost(const Medium& medium, double wavelength_nm) const {
    if (!needs_mie(medium)) return 0.0;
    return mie_seconds(particles_of(medium, request_.scene.particles), wavelength_nm, whole_phase_);
}

double Planner::mie_cost(const Medium& medium) const {
    double sum = 0.0;
    for (const double wavelength_nm : jobs_nm_) sum += mie_cost(medium, wavelength_nm);
    return sum;
}

double Planner::scene_mie_cost() const {
    std::set<std::string> names;
    double sum = 0.0;
    const auto add = [&](const Medium& medium) {
        if (names.insert(describe(medium)).second) {
            sum += mie_cost(medium, request_.wavelength_nm.front());
        }
    };
    add(visible_.base);
    for (const CoatMedium& coat : visible_.coats) add(coat.medium);
    return sum;
}

void Planner::leave_out(const std::string& rule, const std::string& reason, double saved_s) {
    plan_.omissions.push_back({rule, reason, saved_s});
}

void Planner::list_jobs() {
    const LayerJobs list =
        needs_layers_ ? list_layer_jobs(reduced_, media_, quantity_) : LayerJobs{};
    const std::size_t repeated = list.serving.size() - list.jobs.size();
    std::size_t closed = 0, cached = 0;
    for (const LayerJob& job : list.jobs) {
        if (job.closed_form) {
            ++closed;
        } else if (cache_ != nullptr && cache_->find(job.hash)) {
            ++cached;
        } else {
            jobs_.push_back(job);
            jobs_nm_.push_back(job.wavelength_nm);
        }
    }
    visible_ = reduced_.scene;
    const double each = transfer_cost(orders(), layers()) + scene_mie_cost();
    const auto several = [&](const char* rule, const char* reason, std::size_t count) {
        if (count == 0) return;
        leave_out(rule,
                  fmt::format("{} of {}: {}", count,
                              counted(request_.wavelength_nm.size(), "wavelength"), reason),
                  static_cast<double>(count) * each);
    };
    several("same wavelength", "same layers as at another wavelength", repeated);
    several("nothing absorbs", "every layer has albedo 1, so the plane albedo is 1", closed);
    several("in the cache", "reflection from the cache", cached);
    if (!needs_layers_) {
        leave_out("surface alone", "only the surface lobe was asked for: no layers",
                  static_cast<double>(request_.wavelength_nm.size()) * each);
    }
}

void Planner::leave_out_coat(const CoatMedium& coat) {
    leave_out(
        "no depth",
        fmt::format("coat {} has optical depth 0: no optics, no modes", describe(coat.medium)),
        mie_cost(coat.medium) + jobs() * orders() * order_seconds(streams_, 1, cosines()));
}

void Planner::hide_layers() {
    const double tolerance = request_.solver.tolerance;
    for (std::size_t c = visible_.coats.size(); c-- > 0 && !jobs_nm_.empty();) {
        const CoatMedium coat = visible_.coats[c];
        if (!rte::may_hide(coat.optical_depth, reduced_.directions, tolerance)) continue;
        if (needs_mie(coat.medium) && !rte::is_bottomless(coat.optical_depth)) {
            leave_out(
                "hidden layers",
                fmt::format("perhaps: known when the optics of coat {} are", describe(coat.medium)),
                0.0);
            return;
        }
        const auto optics =
            medium_optics(media_.media()[c + 1], jobs_nm_.front(), request_.scene.particles, {});
        if (!rte::hides_what_is_below(optics.optics, coat.optical_depth, reduced_.directions,
                                      tolerance)) {
            continue;
        }
        double saved = mie_cost(visible_.base);
        for (std::size_t below = 0; below < c; ++below) {
            saved += mie_cost(visible_.coats[below].medium);
        }
        saved += jobs() * orders() * order_seconds(streams_, c + 1, cosines());
        leave_out(
            "hidden layers",
            fmt::format("coat {} of optical depth {} shows nothing of the {} below within {} of "
                        "the tolerance",
                        describe(coat.medium), coat.optical_depth, counted(c + 1, "layer"),
                        kHiddenLayersShare),
            saved);
        visible_.base = coat.medium;
        visible_.coats.erase(visible_.coats.begin(),
                             visible_.coats.begin() + static_cast<std::ptrdiff_t>(c) + 1);
        return;
    }
}

}  // namespace miebrdf
