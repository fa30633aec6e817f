#include "pipeline/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "pipeline/cost_model.h"
#include "pipeline/distinct_directions.h"
#include "pipeline/rules.h"
#include "pipeline/tolerance.h"
#include "pipeline/visible_layers.h"

namespace miebrdf {
namespace {

// Orders that listed directions need when nothing is known of the phase function: what 50 um
// spheres and hg:0.9,0.85 take at tolerance 1e-3.
constexpr int kTypicalOrders = 30;

class Planner {
  public:
    Planner(const Request& request, LayerQuantity quantity, ResultCache* cache)
        : request_(request), quantity_(quantity), cache_(cache), media_(request),
          distinct_(request.directions), reduced_(request) {
        reduced_.directions = distinct_.directions();
        reduced_.scene = media_.scene();
        whole_phase_ = demand_of(request, is_albedo() ? PhaseDemand::moments_only
                                                      : PhaseDemand::whole)
                           .whole_phase_function;
        streams_ = expected_streams(reduced_);
        needs_layers_ = is_albedo() || wants_layers(request.parts);
    }

    Plan plan() {
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

  private:
    bool is_albedo() const { return quantity_ != LayerQuantity::reflection; }
    std::size_t cosines() const {
        return reduced_.directions.mu_in.size() + reduced_.directions.mu_out.size();
    }
    double mie_cost(const Medium& medium, double wavelength_nm) const {
        if (!needs_mie(medium)) return 0.0;
        return mie_seconds(request_.scene.particles, wavelength_nm, whole_phase_);
    }
    double mie_cost(const Medium& medium) const {
        double sum = 0.0;
        for (const double wavelength_nm : jobs_nm_) sum += mie_cost(medium, wavelength_nm);
        return sum;
    }
    /// Orders of one solution under the rules, and without them.
    int all_orders() const {
        const int known = most_orders(reduced_.scene);
        return known > 0 ? known : std::min(kTypicalOrders, 2 * streams_);
    }
    int orders() const { return is_albedo() || only_zenith(reduced_.directions) ? 1 : all_orders(); }
    std::size_t layers() const { return 1 + visible_.coats.size(); }
    double transfer_cost(int orders, std::size_t layers) const {
        const double values =
            is_albedo() ? 0.0
                        : static_cast<double>(distinct_.computed()) * value_seconds(orders);
        return orders * order_seconds(streams_, layers, cosines()) + values;
    }

    void leave_out(const std::string& rule, const std::string& reason, double saved_s) {
        plan_.omissions.push_back({rule, reason, saved_s});
    }

    /// Wavelengths that need work, each job once.
    void list_jobs() {
        std::set<std::string> known;
        std::size_t repeated = 0, closed = 0, cached = 0;
        for (const double wavelength_nm : request_.wavelength_nm) {
            if (!needs_layers_) continue;
            const std::string hash = layer_hash(reduced_, media_, quantity_, wavelength_nm);
            if (!known.insert(hash).second) {
                ++repeated;
            } else if (has_closed_form(media_, quantity_, wavelength_nm)) {
                ++closed;
            } else if (cache_ != nullptr && cache_->find(hash)) {
                ++cached;
            } else {
                jobs_nm_.push_back(wavelength_nm);
            }
        }
        visible_ = reduced_.scene;
        const double each = transfer_cost(orders(), layers()) + scene_mie_cost();
        const auto several = [&](const char* rule, const char* reason, std::size_t count) {
            if (count == 0) return;
            leave_out(rule, fmt::format("{} of {} wavelengths: {}", count,
                                        request_.wavelength_nm.size(), reason),
                      static_cast<double>(count) * each);
        };
        several("same wavelength", "same layers as at another wavelength", repeated);
        several("nothing absorbs", "every layer has albedo 1, so the plane albedo is 1", closed);
        several("in the cache", "computed before", cached);
        if (!needs_layers_) {
            leave_out("surface alone", "only the surface lobe was asked for: no layers",
                      static_cast<double>(request_.wavelength_nm.size()) * each);
        }
    }

    /// Mie theory for all the layers at the first wavelength, each different medium once.
    double scene_mie_cost() const {
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

    void leave_out_coat(const CoatMedium& coat) {
        leave_out("no depth",
                  fmt::format("coat {} has optical depth 0: no optics, no modes",
                              describe(coat.medium)),
                  mie_cost(coat.medium) + jobs() * orders() *
                                              order_seconds(streams_, 1, cosines()));
    }

    double jobs() const { return static_cast<double>(jobs_nm_.size()); }

    /// Removes what lies below a coat that hides it, as far as that is known before computing.
    void hide_layers() {
        const double tolerance = request_.solver.tolerance;
        for (std::size_t c = visible_.coats.size(); c-- > 0 && !jobs_nm_.empty();) {
            const CoatMedium coat = visible_.coats[c];
            if (!may_hide(coat.optical_depth, reduced_.directions, tolerance)) continue;
            if (needs_mie(coat.medium) && !std::isinf(coat.optical_depth)) {
                leave_out("hidden layers",
                          fmt::format("perhaps: known when the optics of coat {} are",
                                      describe(coat.medium)),
                          0.0);
                return;
            }
            const auto optics = medium_optics(media_.media()[c + 1], jobs_nm_.front(),
                                              request_.scene.particles, {});
            if (!hides_what_is_below(optics.optics, coat.optical_depth, reduced_.directions,
                                     tolerance)) {
                continue;
            }
            double saved = mie_cost(visible_.base);
            for (std::size_t below = 0; below < c; ++below) {
                saved += mie_cost(visible_.coats[below].medium);
            }
            saved += jobs() * orders() *
                     order_seconds(streams_, c + 1, cosines());
            leave_out("hidden layers",
                      fmt::format("coat {} of optical depth {} shows nothing of the {} layer(s) "
                                  "below within {} of the tolerance",
                                  describe(coat.medium), coat.optical_depth, c + 1,
                                  kToleranceShares.hidden_layers),
                      saved);
            visible_.base = coat.medium;
            visible_.coats.erase(visible_.coats.begin(),
                                 visible_.coats.begin() + static_cast<std::ptrdiff_t>(c) + 1);
            return;
        }
    }

    void single_scattering() {
        if (jobs_nm_.empty()) return;
        std::vector<Medium> layers{visible_.base};
        for (const CoatMedium& coat : visible_.coats) layers.push_back(coat.medium);
        std::map<std::tuple<double, double, double>, std::string> done;
        std::set<std::string> given;
        std::map<std::string, std::size_t> count;
        double repeated_s = 0.0;
        std::size_t repeated = 0;
        const double k_floor = request_.scene.particles.k_floor;
        MediumResolver resolver(request_.database);
        for (const Medium& layer : layers) {
            const ResolvedMedium medium = resolver.resolve(layer);
            if (!needs_mie(layer)) {
                given.insert(describe(layer));
                continue;
            }
            for (const double wavelength_nm : jobs_nm_) {
                const auto index = *medium.index_at(wavelength_nm, k_floor);
                const std::tuple key{index.real(), index.imag(), wavelength_nm};
                if (done.try_emplace(key, describe(layer)).second) {
                    ++count[describe(layer)];
                } else {
                    ++repeated;
                    repeated_s += mie_cost(layer, wavelength_nm);
                }
            }
        }
        for (const auto& [name, jobs] : count) {
            plan_.steps.push_back({"single scattering",
                                   fmt::format("Mie theory for {}, tolerance {:g}{}", name,
                                               demand_tolerance(),
                                               whole_phase_ ? ", every angle" : ", moments only"),
                                   jobs, mie_cost(parse_medium(name))});
        }
        for (const std::string& name : given) {
            leave_out("analytic medium", fmt::format("{} is given: no Mie theory", name),
                      jobs() * mie_seconds(request_.scene.particles, jobs_nm_.front(),
                                           whole_phase_));
        }
        if (repeated > 0) {
            leave_out("same spheres",
                      fmt::format("{} Mie runs have index, wavelength and sizes of others", repeated),
                      repeated_s);
        }
        if (!whole_phase_ && !count.empty()) {
            double full = 0.0;
            for (const double nm : jobs_nm_) {
                full += mie_seconds(request_.scene.particles, nm, true) -
                        mie_seconds(request_.scene.particles, nm, false);
            }
            leave_out("few moments",
                      fmt::format("{} moments serve {} streams; no phase function at every angle",
                                  2 * streams_, streams_),
                      full * static_cast<double>(count.size()));
        }
    }

    double demand_tolerance() const {
        return demand_of(request_, PhaseDemand::moments_only).tolerance;
    }

    void radiative_transfer() {
        if (!needs_layers_ || jobs_nm_.empty()) return;
        plan_.steps.push_back(
            {"radiative transfer",
             fmt::format("{} order(s) of a half-space and {} coat(s), about {} streams, {} cosines",
                         orders(), visible_.coats.size(), streams_, cosines()),
             jobs_nm_.size(), jobs() * transfer_cost(orders(), layers())});
        if (!is_albedo()) {
            plan_.steps.push_back({"energy check",
                                   "plane albedo at every mu_in, from order 0 of the same solution",
                                   jobs_nm_.size(), 0.0});
        }
        const double saved = jobs() * (transfer_cost(all_orders(), layers()) -
                                       transfer_cost(orders(), layers()));
        if (is_albedo()) {
            leave_out("albedo", "only order 0 carries flux: no other orders, no phase function",
                      saved);
        } else if (only_zenith(reduced_.directions)) {
            leave_out("zenith", "all mu_in or all mu_out are 1: order 0 alone", saved);
        } else if (most_orders(visible_) > 0) {
            leave_out("few orders",
                      fmt::format("the moments of these media end: {} order(s) at most",
                                  most_orders(visible_)),
                      jobs() * std::max(0.0, transfer_cost(kTypicalOrders, layers()) -
                                                 transfer_cost(orders(), layers())));
        } else {
            leave_out("listed directions",
                      fmt::format("orders end where they no longer show at these {} directions, "
                                  "within {} of the tolerance",
                                  distinct_.computed(), kToleranceShares.orders),
                      jobs() * std::max(0, 2 * streams_ - orders()) *
                          order_seconds(streams_, layers(), cosines()));
        }
        if (distinct_.computed() < distinct_.requested() && !is_albedo()) {
            leave_out("same direction",
                      fmt::format("{} of {} combinations repeat another or its mirror image",
                                  distinct_.requested() - distinct_.computed(),
                                  distinct_.requested()),
                      jobs() *
                          static_cast<double>(distinct_.requested() - distinct_.computed()) *
                          value_seconds(orders()));
        }
        if (visible_.coats.size() > 1) {
            leave_out("one half-space",
                      fmt::format("{} coats on one base: its half-space is solved once",
                                  visible_.coats.size()),
                      jobs() * orders() * static_cast<double>(visible_.coats.size() - 1) *
                          order_seconds(streams_, 1, cosines()));
        }
        if (scatters_nothing(visible_.base)) {
            leave_out("nothing scatters",
                      fmt::format("{} scatters nothing: a black ground", describe(visible_.base)),
                      jobs() * orders() * order_seconds(streams_, 1, cosines()));
        }
    }

    void surface() {
        const double wavelengths = static_cast<double>(request_.wavelength_nm.size());
        const double values =
            static_cast<double>(distinct_.computed()) * wavelengths * lobe_seconds();
        const double rho = static_cast<double>(cosines()) * wavelengths * rho_seconds();
        const bool lobe = is_albedo() ? request_.scene.surface.has_value()
                                      : wants_lobe(request_.scene, request_.parts);
        if (!lobe) {
            leave_out("no surface", "no lobe in what was asked for: neither it nor its rho",
                      values + rho);
        } else if (is_symmetric(reduced_.directions) && !is_albedo()) {
            leave_out("reciprocity", "mu_in and mu_out are the same list: half of the lobe's table",
                      values / 2);
        }
        if (lobe) {
            plan_.steps.push_back({"surface", is_albedo() ? "rho at every cosine"
                                                          : "lobe at every direction, and rho",
                                   request_.wavelength_nm.size(), values + rho});
        }
        leave_out("no colour", "nothing in this request asks for XYZ or RGB", 0.0);
    }

    const Request& request_;
    LayerQuantity quantity_;
    ResultCache* cache_;
    SceneMedia media_;
    DistinctDirections distinct_;
    Request reduced_;
    bool whole_phase_ = false;
    bool needs_layers_ = true;
    int streams_ = 0;
    Scene visible_;
    std::vector<double> jobs_nm_;
    Plan plan_;
};

}  // namespace

double Plan::seconds() const {
    double sum = 0.0;
    for (const PlannedStep& step : steps) sum += step.seconds;
    return sum;
}

bool Plan::leaves_out(const std::string& rule) const {
    return std::any_of(omissions.begin(), omissions.end(),
                       [&](const Omission& omission) { return omission.rule == rule; });
}

Plan make_plan(const Request& request, LayerQuantity quantity, ResultCache* cache) {
    validate(request);
    return Planner(request, quantity, cache).plan();
}

}  // namespace miebrdf
