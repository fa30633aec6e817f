#include "pipeline/plan/planner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "pipeline/cache/result_cache.h"
#include "pipeline/plan/cost_model.h"
#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/polarisation.h"
#include "pipeline/solve/rules.h"
#include "pipeline/solve/sampled_spectrum.h"
#include "pipeline/solve/scene_optics.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/hidden_layers.h"

namespace miebrdf {

std::string counted(std::size_t count, const std::string& thing) {
    return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

double Plan::seconds() const {
    double sum = 0.0;
    for (const PlannedStep& step : steps) sum += step.seconds;
    return sum;
}

bool Plan::leaves_out(const std::string& rule) const {
    return std::any_of(omissions.begin(), omissions.end(),
                       [&](const Omission& omission) { return omission.rule == rule; });
}

Plan plan_evaluate(const Brdf& brdf, const Directions& directions, const BrdfParts& parts,
                   EarlierWork* earlier) {
    EarlierWork none;
    return Planner(brdf, directions, parts, LayerQuantity::reflection,
                   earlier != nullptr ? *earlier : none)
        .plan();
}

Plan plan_albedo(const Brdf& brdf, const std::vector<double>& mu_in, EarlierWork* earlier) {
    EarlierWork none;
    return Planner(brdf, {mu_in, {}, {}}, {}, albedo_quantity(BrdfState::of(brdf).resolved),
                   earlier != nullptr ? *earlier : none)
        .plan();
}

Planner::Planner(const Brdf& brdf, const Directions& directions, const BrdfParts& parts,
                 LayerQuantity quantity, EarlierWork& earlier)
    : scene_(BrdfState::of(brdf).resolved),
      solver_(BrdfState::of(brdf).solver),
      parts_(parts),
      cache_(BrdfState::of(brdf).control.cache),
      earlier_(earlier),
      distinct_(directions),
      request_{scene_, distinct_.directions(), solver_, quantity},
      demand_(first_demand(request_,
                           demand_of(solver_, scene_.particles.tolerance, phase_demand(quantity)))),
      needs_layers_(is_albedo() || wants_layers(parts)),
      lowest_(scene_.first_medium()),
      size_(expected_size(scene_, lowest_, solver_, distinct_.directions())) {}

Plan Planner::plan() {
    if (needs_layers_) {
        for (std::size_t w = 0; w < scene_.wavelength_nm.size(); ++w)
            require_computable(scene_, solver_, w);
    }
    list_jobs();
    for (const Layer& layer : scene_.empty_layers) leave_out_layer(layer);
    if (scene_.substrate) leave_out("substrate", "a ground in place of a base: no half-space", 0.0);
    hide_layers();
    single_scattering();
    radiative_transfer();
    polarisation();
    boundary();
    surface();
    plan_.memory_bytes = memory_bytes();
    return std::move(plan_);
}

double Planner::memory_bytes() const {
    double bytes = kProgramBytes, working = 0.0;
    if (!is_albedo()) {
        const double wavelengths = static_cast<double>(scene_.wavelength_nm.size());
        bytes += static_cast<double>(distinct_.requested()) *
                 (kValueBytes * wavelengths + kValueSolverBytes);
    }
    for (const LayerJob& job : jobs_) {
        for (std::size_t m = lowest_; m < scene_.media.size(); ++m) {
            for (const ResolvedSpecies& species : scene_.media[m].species) {
                if (!species.needs_mie()) continue;
                const MieWork work = mie_work(species, job.wavelength, solver_.tolerance,
                                              demand_.whole_phase_function);
                bytes += mie_bytes(work);
                working = std::max(working, mie_working_bytes(work));
            }
        }
    }
    return std::max(bytes, kProgramBytes + working);
}

std::size_t Planner::cosines() const {
    return request_.directions.mu_in.size() + request_.directions.mu_out.size();
}

double Planner::mie_cost(std::size_t medium, std::size_t w) const {
    double sum = 0.0;
    for (const ResolvedSpecies& species : scene_.media[medium].species)
        sum += mie_cost(species, w, demand_.whole_phase_function);
    return sum;
}

double Planner::mie_cost(const ResolvedSpecies& species, std::size_t w, bool whole) const {
    if (!species.needs_mie()) return 0.0;
    return mie_seconds(mie_work(species, w, demand_.tolerance, whole));
}

OpticsDemand Planner::demand_at(std::size_t w) const {
    const LightChoice light = choose_light(request_, w);
    OpticsDemand demand = demand_;
    demand.polarisation = light.components > 1;
    return demand;
}

double Planner::typical_mie_cost(std::size_t w) const {
    constexpr std::complex<double> typical_index = {1.5, 1e-3};
    return mie_seconds({scene_.particles.sizes, typical_index, scene_.particles.host.index.real(),
                        scene_.wavelength_nm[w], demand_.tolerance, demand_.whole_phase_function});
}

double Planner::mie_cost(std::size_t medium) const {
    double sum = 0.0;
    for (const LayerJob& job : jobs_) sum += mie_cost(medium, job.wavelength);
    return sum;
}

double Planner::scene_mie_cost() const {
    std::set<std::string> names;
    double sum = 0.0;
    for (std::size_t m = lowest_; m < scene_.media.size(); ++m) {
        if (names.insert(describe(scene_.media[m].medium)).second) sum += mie_cost(m, 0);
    }
    return sum;
}

void Planner::leave_out(const std::string& rule, const std::string& reason, double saved_s) {
    plan_.omissions.push_back({rule, reason, saved_s});
}

void Planner::list_jobs() {
    const LayerJobs list = needs_layers_ ? list_layer_jobs(request_) : LayerJobs{};
    const std::size_t repeated = list.serving.size() - list.jobs.size();
    std::size_t closed = 0, cached = 0;
    for (const LayerJob& job : list.jobs) {
        if (job.closed_form) {
            ++closed;
        } else if (cache_ != nullptr && cache_->find(job.hash)) {
            ++cached;
        } else {
            jobs_.push_back(job);
        }
    }
    const double each = transfer_cost(orders(), layers()) + scene_mie_cost();
    const std::size_t wavelengths = scene_.wavelength_nm.size();
    const auto several = [&](const char* rule, const char* reason, std::size_t count) {
        if (count == 0) return;
        leave_out(rule,
                  fmt::format("{} of {}: {}", count, counted(wavelengths, "wavelength"), reason),
                  static_cast<double>(count) * each);
    };
    several("same wavelength", "same layers as at another wavelength", repeated);
    several("nothing absorbs", "every layer has albedo 1, so the plane albedo is 1", closed);
    several("in the cache", "reflection from the cache", cached);
    if (!needs_layers_) {
        leave_out("surface alone", "only the surface lobe was asked for: no layers",
                  static_cast<double>(wavelengths) * each);
    }
}

void Planner::leave_out_layer(const Layer& layer) {
    double saved = jobs() * orders() * order_seconds(size_, 1, cosines());
    if (needs_mie(layer.medium)) {
        for (const LayerJob& job : jobs_) saved += typical_mie_cost(job.wavelength);
    }
    leave_out("no depth",
              fmt::format("coat {} has optical depth 0: no optics, no Fourier modes{}",
                          describe(layer.medium),
                          scene_.has_optical_steps() ? "; the surfaces of its host stay" : ""),
              saved);
}

void Planner::hide_layers() {
    if (jobs_.empty()) return;
    for (std::size_t m = scene_.media.size(); m-- > 1;) {
        const Medium& medium = scene_.media[m].medium;
        const ResolvedDepth& given = scene_.depths[m - 1];
        const double depth = given.optical_depth;
        const bool follows = !given.is_grey();  // known when the extinction is
        const Directions directions =
            below_boundary(scene_, jobs_.front().wavelength, request_.directions);
        const double tolerance = hiding_tolerance(scene_, solver_.tolerance);
        if (!follows && !rte::may_hide(depth, directions, tolerance)) continue;
        if (scene_.media[m].needs_mie() && !std::isinf(depth)) {
            leave_out(
                "hidden layers",
                fmt::format("perhaps: known when the optics of coat {} are", describe(medium)),
                0.0);
            return;
        }
        const auto optics = compute_optics(scene_, m, jobs_.front().wavelength, {});
        if (!rte::hides_what_is_below(optics.optics, depth, directions, tolerance)) continue;
        double saved = jobs() * orders() * order_seconds(size_, m, cosines());
        for (std::size_t below = 0; below < m; ++below) saved += mie_cost(below);
        leave_out(
            "hidden layers",
            fmt::format("coat {} of optical depth {} shows nothing of the {} below within {} of "
                        "the tolerance",
                        describe(medium), depth, counted(m, "layer"), kHiddenLayersShare),
            saved);
        lowest_ = m;
        return;
    }
}

void Planner::single_scattering() {
    if (jobs_.empty()) return;
    std::set<std::string> given;
    struct Work {
        const ResolvedSpecies* species = nullptr;
        std::size_t jobs = 0;
        double seconds = 0.0, share = 1.0;
    };
    std::map<std::string, Work> work;
    bool mixes = false;
    double repeated_s = 0.0, cached_s = 0.0;
    std::size_t repeated = 0, cached = 0;
    for (std::size_t m = lowest_; m < scene_.media.size(); ++m) {
        const ResolvedMedium& medium = scene_.media[m];
        if (!medium.needs_mie()) {
            given.insert(describe(medium.medium));
            continue;
        }
        mixes = mixes || medium.species.size() > 1;
        for (const ResolvedSpecies& species : medium.species) {
            const double share = demand_.whole_phase_function ? 1.0 : computed_share(species);
            for (const LayerJob& job : jobs_) {
                const OpticsDemand demand = demand_at(job.wavelength);
                const std::string hash = optics_hash(species, job.wavelength, demand);
                // A matrix average has one of efficiencies before it.
                const double cost =
                    demand.polarisation
                        ? matrix_seconds(species, job.wavelength, demand) +
                              mie_cost(species, job.wavelength, false)
                        : share * mie_cost(species, job.wavelength, demand.whole_phase_function);
                if (!earlier_.optics.insert(hash).second) {
                    ++repeated;
                    repeated_s += cost;
                } else if (cache_ != nullptr && cache_->find(hash)) {
                    ++cached;
                    cached_s += cost;
                } else {
                    Work& of = work[describe(species.species)];
                    of.species = &species;
                    of.share = share;
                    ++of.jobs;
                    of.seconds += cost;
                }
            }
        }
    }
    std::vector<const ResolvedSpecies*> computed;
    for (const auto& [name, of] : work) {
        plan_.steps.push_back(
            {"single scattering",
             fmt::format("{} for {}, tolerance {:g}{}{}{}",
                         of.species->species.shape.by_t_matrix ? "T-matrix" : "Mie theory", name,
                         demand_.tolerance,
                         demand_.whole_phase_function ? ", every angle" : ", moments only",
                         of.species->particles.front().coatings.empty()
                             ? ""
                             : "; coated spheres one size after the other, never by rays",
                         of.share < 1.0 ? fmt::format("; at about {:.0f} of the wavelengths, cubic "
                                                      "between them",
                                                      of.share * double(of.jobs))
                                        : ""),
             of.jobs, of.seconds});
        computed.push_back(of.species);
    }
    if (!computed.empty() && !mixes) {
        leave_out("one species", "no layer holds more than one species: no mixing", 0.0);
    }
    for (const std::string& name : given) {
        leave_out("analytic medium", fmt::format("{} is given: no Mie theory", name),
                  jobs() * typical_mie_cost(jobs_.front().wavelength));
    }
    if (repeated > 0) {
        leave_out("same spheres",
                  fmt::format("{} with index, wavelength and sizes of others before",
                              counted(repeated, "Mie run")),
                  repeated_s);
    }
    if (cached > 0) {
        leave_out("in the cache", fmt::format("{} from the cache", counted(cached, "Mie run")),
                  cached_s);
    }
    if (!demand_.whole_phase_function && !computed.empty()) leave_out_phase_functions(computed);
}

void Planner::leave_out_phase_functions(const std::vector<const ResolvedSpecies*>& computed) {
    double saved = 0.0;
    for (const ResolvedSpecies* species : computed) {
        for (const LayerJob& job : jobs_)
            saved += mie_cost(*species, job.wavelength, true) -
                     mie_cost(*species, job.wavelength, false);
    }
    const bool given = solver_.streams > 0;
    const int streams = given ? solver_.streams : streams_of_first_pass(request_);
    const std::string who_uses_them =
        given ? fmt::format("{} streams use", streams)
              : fmt::format("the first {} streams use: more only where those do not suffice",
                            streams);
    leave_out("few moments",
              fmt::format("no phase function at every angle; {} moments, as many as {}",
                          demand_.highest_moment, who_uses_them),
              saved);
}

}  // namespace miebrdf
