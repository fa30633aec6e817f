#include "pipeline/plan/rehearsal.h"

#include <miebrdf/ensemble.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <iterator>
#include <optional>
#include <set>
#include <string>

#include "pipeline/solve/checks.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/phase_errors.h"
#include "pipeline/solve/polarisation.h"
#include "pipeline/solve/scene_optics.h"
#include "rte/grid/discretisation.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/layered_reflection.h"

namespace miebrdf {
namespace {

// What a rehearsal may take. Single scattering that would take longer is done with a larger
// tolerance; if that is still too long there is no rehearsal.
constexpr double kMie_s = 0.02, kMostMie_s = 0.08;
constexpr double kCoarsestMie = 1e-2;
/// Time of a size average is about this power of its tolerance: matrices.
constexpr double kMatrixPower = 0.35;
/// No further wavelength is looked at after this.
constexpr double kEnough_s = 0.02;
/// The next number of nodes is not tried if it will take longer: once errors of a few are known, or
/// after so much time for these.
constexpr double kAttempt_s = 0.04, kMostFirst_s = 0.07;
constexpr std::size_t kFewRungs = 3;
/// Directions of which no more are looked at; what all of them take follows from their number.
constexpr std::size_t kMostCosines = 24, kMostValues = 16'000;
constexpr int kMostGivenStreams = 48;

/// Times of solutions grow as the cube of the number of nodes and this number cubed, with which
/// what is done for every cosine and order takes as long (12 to 96 nodes, with the orders that they
/// take).
constexpr double kOtherNodes = 22.0;
/// Errors of solutions fall as a power of the number of nodes, faster from one to the next; above
/// the slowest they do not fall.
constexpr double kTypicalFall = -2.0, kSlowestFall = -0.4, kFastestFall = -6.0, kFasterFall = 1.0;
constexpr int kNodes[] = {12, 16, 24, 32, 48, 64, 96, 128, 192, 256};

double processor_s() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

double longer(int streams, int next_streams) {
    const auto work = [](double n) { return n * n * n + kOtherNodes * kOtherNodes * kOtherNodes; };
    return work(next_streams) / work(streams);
}

class Watch {
  public:
    double seconds() const { return processor_s() - start_; }

  private:
    double start_ = processor_s();
};

std::vector<double> some_of(const std::vector<double>& list, std::size_t most) {
    if (list.size() <= most) return list;
    std::vector<double> some;
    for (std::size_t i = 0; i < most; ++i)
        some.push_back(list[most == 1 ? 0 : i * (list.size() - 1) / (most - 1)]);
    return some;
}

Directions some_of(const Directions& directions) {
    Directions some;
    some.mu_in = some_of(directions.mu_in, kMostCosines);
    some.mu_out = some_of(directions.mu_out, kMostCosines);
    const std::size_t pairs = std::max<std::size_t>(1, some.mu_in.size() * some.mu_out.size());
    some.azimuth_deg =
        some_of(directions.azimuth_deg, std::max<std::size_t>(2, kMostValues / pairs));
    return some;
}

/// A number of nodes that was tried.
struct Rung {
    int streams = 0, orders = 0;
    double error = 0.0, seconds = 0.0;
};

/// How the errors of the last solutions fall, as a power of the number of nodes.
double fall_of(const std::vector<Rung>& rungs) {
    const Rung& last = rungs.back();
    const Rung& before = rungs[rungs.size() - std::min<std::size_t>(rungs.size(), 3)];
    const double power =
        std::log(last.error / before.error) / std::log(double(last.streams) / before.streams);
    return std::isfinite(power) ? std::clamp(power, kFastestFall, 0.0) : kTypicalFall;
}

/// Adds the numbers of nodes that will be tried after these, as their errors suggest.
void continue_ladder(std::vector<Rung>& rungs, double tolerance) {
    rte::LadderProgress progress;
    bool stalled = false;
    for (const Rung& rung : rungs) stalled = progress.has_stalled_at(rung.error);
    double power = fall_of(rungs);
    for (const int streams : kNodes) {
        if (streams <= rungs.back().streams) continue;
        const Rung last = rungs.back();
        if (last.error <= tolerance) return;
        if (stalled && !rte::is_worth_a_try(streams, last.orders)) return;
        const double finer = double(streams) / last.streams;
        if (power < kSlowestFall) power = std::max(kFastestFall, power - kFasterFall);
        rungs.push_back({streams, int(last.orders * std::sqrt(finer)),
                         last.error * std::pow(finer, power),
                         last.seconds * longer(last.streams, streams)});
        stalled = progress.has_stalled_at(rungs.back().error);
    }
}

/// One wavelength.
struct Sample {
    double mie_s = 0.0, estimated_mie_s = 0.0;
    double matrices_s = 0.0, transfer_s = 0.0, single_angles_s = 0.0;
    int components = 1, streams = 0, orders = 0;
};

class Rehearsing {
  public:
    Rehearsing(const LayerRequest& request, std::size_t lowest)
        : request_(request),
          lowest_(lowest),
          reflects_(request.quantity == LayerQuantity::reflection),
          directions_(some_of(request.directions)),
          demand_(first_demand(request, whole())) {}

    std::optional<Sample> at(std::size_t w) {
        OpticsDemand own = demand_;
        if (!find_tolerance(w, own)) return std::nullopt;
        Sample sample;
        LightChoice light = choose_light(request_, w);
        SceneOptics optics;
        bool has_optics = false;
        if (light.needs_matrices || light.components > 1) {
            const Watch watch;
            OpticsDemand with_matrix = own;
            with_matrix.polarisation = true;
            optics = optics_at(w, with_matrix);
            sample.matrices_s =
                watch.seconds() * std::pow(own.tolerance / demand_.tolerance, kMatrixPower);
            if (light.needs_matrices) light = choose_light(request_, optics.stack);
            has_optics = light.components > 1;
        }
        sample.components = light.components;
        if (!has_optics) {
            const Watch watch;
            optics = optics_at(w, own);
            sample.mie_s = watch.seconds();
        }
        sample.estimated_mie_s =
            mie_seconds(request_, w, lowest_, own.tolerance, own.whole_phase_function);
        if (reflects_) {
            reflect(w, optics, sample);
        } else {
            albedo(w, optics, own, sample);
        }
        return sample;
    }

  private:
    OpticsDemand whole() const {
        return demand_of(request_.solver, request_.scene.particles.tolerance,
                         phase_demand(request_.quantity));
    }

    /// A tolerance with which single scattering is done soon.
    bool find_tolerance(std::size_t w, OpticsDemand& demand) const {
        const auto seconds = [&] {
            return mie_seconds(request_, w, lowest_, demand.tolerance, demand.whole_phase_function);
        };
        while (seconds() > kMie_s && demand.tolerance < kCoarsestMie)
            demand.tolerance = std::min(kCoarsestMie, 2.0 * demand.tolerance);
        return seconds() <= kMostMie_s;
    }

    SceneOptics optics_at(std::size_t w, const OpticsDemand& demand) const {
        const bool transmits =
            request_.scene.substrate && request_.quantity == LayerQuantity::albedo;
        const double hiding = transmits ? 0.0 : request_.solver.tolerance;
        return visible_optics(request_.scene, request_.directions, hiding, {w}, demand, control_)
            .front();
    }

    SolverOptions solver_of(const SceneOptics& optics, double noise) const {
        SolverOptions solver = request_.solver;
        const double mie = std::min(optics.mie_error_estimate, demand_.tolerance);
        solver.tolerance = tolerance_for_transfer(request_.solver.tolerance, mie + noise);
        return solver;
    }

    void reflect(std::size_t w, const SceneOptics& optics, Sample& sample) const {
        const bool noisy = sample.components == 1 && has_noisy_phase(optics.stack);
        const SolverOptions solver =
            solver_of(optics, noisy ? kPhaseShare * request_.solver.tolerance : 0.0);
        std::vector<Rung> rungs;
        double before = 0.0;
        bool is_cut = false;
        const Watch watch;
        const auto look = [&](const rte::SolverReport& report, int next) {
            const double now = watch.seconds();
            rungs.push_back({report.streams, report.fourier_orders, report.error_estimate,
                             rungs.empty() ? 0.5 * now : now - before});
            before = now;
            const bool is_long = rungs.back().seconds * longer(report.streams, next) > kAttempt_s;
            is_cut = is_long && (rungs.size() >= kFewRungs || now > kMostFirst_s);
            return !is_cut;
        };
        rte::SolverReport report;
        std::vector<double> values, transfer_errors;
        if (sample.components > 1) {
            report = rte::reflect_polarised(optics.stack, directions_, {sample.components, true},
                                            solver, nullptr, look)
                         .report;
        } else {
            rte::ReflectionTable table =
                rte::reflect(optics.stack, directions_, solver, nullptr, look);
            report = table.report;
            values = std::move(table.reflection);
            transfer_errors = std::move(table.errors);
        }
        const double known = watch.seconds();
        double more = 0.0;
        sample.streams = report.streams;
        sample.orders = report.fourier_orders;
        if (is_cut) {
            const std::size_t done = rungs.size();
            continue_ladder(rungs, solver.tolerance);
            for (std::size_t i = done; i < rungs.size(); ++i) more += rungs[i].seconds;
            sample.streams = rungs.back().streams;
            sample.orders = rungs.back().orders;
        }
        sample.transfer_s = of_all_directions(known + more, sample);
        if (noisy) {
            if (is_cut) std::fill(transfer_errors.begin(), transfer_errors.end(), solver.tolerance);
            single_angles(w, optics, report.moments, transfer_errors, values, sample);
        }
    }

    /// What some of the directions take, for all of them.
    double of_all_directions(double seconds, const Sample& sample) const {
        const Directions& all = request_.directions;
        const auto values = [](const Directions& d) {
            return double(d.mu_in.size()) * double(d.mu_out.size()) * double(d.azimuth_deg.size());
        };
        const auto nodes = [&](const Directions& d) {
            return double(sample.streams) + double(d.mu_in.size() + d.mu_out.size());
        };
        constexpr double most = 0.7;  // of the time, for values: they are but estimated
        const double each = value_seconds(sample.orders);
        const double of_values = std::min(most * seconds, each * values(directions_));
        return (seconds - of_values) * nodes(all) / nodes(directions_) +
               of_values * values(all) / std::max(1.0, values(directions_));
    }

    void single_angles(std::size_t w, const SceneOptics& optics, int moments,
                       const std::vector<double>& transfer_errors, std::vector<double>& values,
                       Sample& sample) const {
        const Watch watch;
        refine_phase(
            request_.scene, w, demand_,
            {optics.stack, directions_, moments, request_.solver.delta_m, transfer_errors},
            rest_for_phase(request_.solver.tolerance, optics.mie_error_estimate, transfer_errors),
            values, mie::run_in_order);
        sample.single_angles_s = watch.seconds();
    }

    void albedo(std::size_t w, SceneOptics& optics, OpticsDemand own, Sample& sample) const {
        const std::vector<double>& mu_in = directions_.mu_in;
        const Watch watch;
        if (sample.components > 1) {
            const auto table = rte::polarised_albedo(optics.stack, mu_in, solver_of(optics, 0.0));
            sample.streams = table.report.streams;
        } else {
            sample.streams =
                rte::albedo(optics.stack, mu_in, solver_of(optics, 0.0)).report.streams;
        }
        sample.orders = 1;
        sample.transfer_s = watch.seconds();
        const bool wants_more = sample.components == 1 &&
                                sample.streams > first_streams(request_) &&
                                demand_.highest_moment < whole().highest_moment;
        if (!wants_more) return;
        const Watch again;
        own.highest_moment = whole().highest_moment;
        optics = optics_at(w, own);
        sample.mie_s += again.seconds();
        sample.transfer_s *= 2.0;
    }

    const LayerRequest& request_;
    std::size_t lowest_;
    bool reflects_;
    Directions directions_;
    OpticsDemand demand_;
    Control control_ = {.threads = 1};
};

/// The order in which wavelengths are looked at: the middle, the ends, what lies between.
std::vector<std::size_t> places(std::size_t count) {
    std::vector<std::size_t> order;
    for (const std::size_t place :
         {count / 2, count - 1, std::size_t(0), 3 * count / 4, count / 4}) {
        if (std::find(order.begin(), order.end(), place) == order.end()) order.push_back(place);
    }
    return order;
}

bool can_be_rehearsed(const LayerRequest& request) {
    const SolverOptions& solver = request.solver;
    const ResolvedScene& scene = request.scene;
    return solver.streams <= kMostGivenStreams &&
           solver.half_space_method == rte::HalfSpaceMethod::automatic &&
           solver.coat_method == rte::CoatMethod::automatic &&
           !(scene.boundary && scene.boundary->is_rough());
}

}  // namespace

double mie_seconds(const LayerRequest& request, std::size_t wavelength, std::size_t lowest,
                   double tolerance, bool whole_phase) {
    double sum = 0.0;
    std::set<std::string> known;
    for (std::size_t m = lowest; m < request.scene.media.size(); ++m) {
        for (const ResolvedSpecies& species : request.scene.media[m].species) {
            if (!species.needs_mie() || !known.insert(species.key[wavelength]).second) continue;
            const Particles& at = species.particles[wavelength];
            sum += mie_seconds({species.sizes, at.index / at.host_index, at.host_index,
                                at.wavelength_nm, tolerance, whole_phase});
        }
    }
    return sum;
}

Rehearsal rehearse(const LayerRequest& request, const std::vector<std::size_t>& wavelengths,
                   std::size_t lowest) {
    Rehearsal all;
    if (wavelengths.empty() || !can_be_rehearsed(request)) return all;
    // Wavelengths at which matrices decide on the polarisation take another amount of work.
    std::vector<std::size_t> groups[2];
    for (const std::size_t w : wavelengths) {
        const LightChoice light = choose_light(request, w);
        groups[light.needs_matrices || light.components > 1 ? 1 : 0].push_back(w);
    }
    double mie_s = 0.0, estimated_mie_s = 0.0;
    const Watch watch;
    Rehearsing rehearsing(request, lowest);
    try {
        for (const std::vector<std::size_t>& group : groups) {
            if (group.empty()) continue;
            std::vector<Sample> samples;
            for (const std::size_t place : places(group.size())) {
                if (!samples.empty() && watch.seconds() > kEnough_s) break;
                const std::optional<Sample> sample = rehearsing.at(group[place]);
                if (!sample) return {};
                samples.push_back(*sample);
            }
            const double share =
                double(group.size()) / double(wavelengths.size()) / double(samples.size());
            for (const Sample& sample : samples) {
                mie_s += share * sample.mie_s;
                estimated_mie_s += share * sample.estimated_mie_s;
                all.matrices_s += share * sample.matrices_s;
                all.transfer_s += share * sample.transfer_s;
                all.single_angles_s += share * sample.single_angles_s;
                if (sample.components > 1) all.polarised += share;
                if (sample.streams > all.streams) {
                    all.streams = sample.streams;
                    all.orders = sample.orders;
                }
            }
        }
    } catch (const UsageError&) {
        return {};  // the request itself will say it
    }
    all.took_place = true;
    if (estimated_mie_s > 0.0) all.mie_factor = mie_s / estimated_mie_s;
    return all;
}

}  // namespace miebrdf
