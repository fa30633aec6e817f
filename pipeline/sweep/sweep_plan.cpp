#include "pipeline/sweep/sweep_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <set>
#include <thread>

#include <miebrdf/error.h>
#include <miebrdf/plan.h>
#include "pipeline/solve/optics_memo.h"
#include "pipeline/sweep/layout.h"
#include "pipeline/sweep/run.h"

namespace miebrdf::sweep {
namespace {

/// A number of a CSV file with its comma, as measured on tables of albedos.
constexpr double kBytesPerField = 15.0;
/// Scenes that cannot be computed are counted; so many are named.
constexpr std::size_t kNamed = 5;

double processor_s() { return double(std::clock()) / CLOCKS_PER_SEC; }

/// "scene 3 (radius_um = 50, soot = 1e-7)", scenes counted from 0 as in tables.
std::string name_of(const Sweep& sweep, std::size_t scene) {
    const std::vector<std::size_t> place = place_of(sweep, scene);
    std::string values;
    for (std::size_t d = 0; d < place.size(); ++d) {
        for (const Axis& axis : sweep.dimensions[d].axes)
            values += fmt::format("{}{} = {}", values.empty() ? "" : ", ", axis.name,
                                  axis.words[place[d]]);
    }
    return fmt::format("scene {}{}", scene, values.empty() ? "" : " (" + values + ")");
}

class ScenePlans {
  public:
    ScenePlans(const Sweep& sweep, const Control& control) : sweep_(sweep) {
        control_.threads = 1;
        control_.is_cancelled = control.is_cancelled;
        control_.memo = make_optics_memo(kSharedBytes);  // of names
    }

    /// @throws Error  for a scene that cannot be computed
    void add(std::size_t scene) {
        const Request request = request_of(sweep_, scene);
        const Brdf brdf = solve(request.scene, sweep_.wavelength.numbers, request.solver, control_);
        require_transmittance(sweep_, request);
        const Directions directions = sweep_.directions();
        Plan plan;
        if (sweep_.wants_matrices_or_brdf()) {
            plan = plan_evaluate(brdf, directions,
                                 {.subsurface = false, .surface = false, .total = true}, &earlier_);
        }
        if (sweep_.wants_albedos()) {
            const Plan albedo = plan_albedo(brdf, directions.mu_in, &earlier_);
            plan.steps.insert(plan.steps.end(), albedo.steps.begin(), albedo.steps.end());
        }
        for (const PlannedStep& step : plan.steps)
            (step.stage == "single scattering" ? shared_s_ : own_s_) += step.seconds;
    }

    double shared_s() const { return shared_s_; }  ///< of Mie theory
    double own_s() const { return own_s_; }        ///< of everything else

  private:
    const Sweep& sweep_;
    Control control_;
    EarlierWork earlier_;
    double shared_s_ = 0.0, own_s_ = 0.0;
};

void look_at_scenes(const Sweep& sweep, double budget_s, const Control& control, SweepPlan& plan) {
    ScenePlans plans(sweep, control);
    std::set<std::size_t> groups;
    const double start = processor_s();
    const auto look_at = [&](std::size_t scene) {
        if (control.is_cancelled && control.is_cancelled()) throw Cancelled();
        ++plan.looked_at;
        groups.insert(scene / sweep.scenes_per_group());
        try {
            plans.add(scene);
        } catch (const Cancelled&) {
            throw;
        } catch (const Error& error) {
            if (++plan.refused <= kNamed)
                plan.refusals.push_back(fmt::format("{}: {}", name_of(sweep, scene), error.what()));
        }
    };
    // The first tells how many there is time for; the rest are spread over all of them.
    look_at(0);
    const double each_s = std::max(processor_s() - start, 1e-6);
    const double most = std::max(1.0, budget_s / each_s);
    const auto step = std::size_t(std::max(1.0, std::ceil(double(plan.scenes - 1) / most)));
    for (std::size_t scene = step; scene < plan.scenes; scene += step) look_at(scene);

    plan.processor_seconds = plans.shared_s() * double(plan.groups) / double(groups.size()) +
                             plans.own_s() * double(plan.scenes) / double(plan.looked_at);
}

}  // namespace

SweepPlan plan_sweep(const Sweep& sweep, const Layout& layout, double budget_s,
                     const Control& control) {
    SweepPlan plan;
    plan.scenes = sweep.scenes();
    plan.groups = plan.scenes / sweep.scenes_per_group();
    const Chunks chunks(sweep, layout);
    plan.chunks = chunks.size();
    plan.values = double(plan.scenes) * double(layout.record);
    constexpr double kPerScene = sizeof(double) + 1;  // error_estimate and converged
    plan.netcdf_bytes = plan.values * sizeof(double) + double(plan.scenes) * kPerScene;
    double rows = double(plan.scenes), columns = 2.0 + double(layout.variables.size());
    for (const Axis* axis : asked_axes(sweep)) rows *= double(axis->size());
    columns += double(asked_axes(sweep).size() + sweep.dimensions.size());
    plan.csv_bytes = rows * columns * kBytesPerField;
    plan.memory_bytes = double(kSharedBytes) +
                        2.0 * double(chunks[0].count) * double(layout.record) * sizeof(double);
    plan.processors = std::max(1u, std::thread::hardware_concurrency());
    if (control.threads > 0)
        plan.processors = std::min(plan.processors, std::size_t(control.threads));
    look_at_scenes(sweep, budget_s, control, plan);
    return plan;
}

}  // namespace miebrdf::sweep
