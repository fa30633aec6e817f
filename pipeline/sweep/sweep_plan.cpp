#include "pipeline/sweep/sweep_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>
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

    SceneLookUp look_up(std::size_t scene) {
        return sweep::look_up(sweep_, scene, &control_.memo->names());
    }

    /// @throws Error  for a scene that cannot be computed
    void add(const SceneLookUp& found) {
        const Brdf brdf = solve(found.request.scene, wavelengths_at(sweep_, found.wavelengths),
                                found.request.solver, control_);
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

/// Calls `look` for scenes until the time is over, at least for one: those that were looked at are
/// spread evenly, however many they are.
void look_while(double budget_s, std::size_t scenes, const std::function<void(std::size_t)>& look) {
    constexpr double golden = 0.6180339887498949;
    auto step = std::max<std::size_t>(1, std::size_t(golden * double(scenes)));
    while (std::gcd(step, scenes) != 1) ++step;
    const double end = processor_s() + budget_s;
    std::size_t scene = 0;
    for (std::size_t i = 0; i < scenes && (i == 0 || processor_s() < end); ++i) {
        look(scene);
        scene = (scene + step) % scenes;
    }
}

void look_at_scenes(const Sweep& sweep, double budget_s, const Control& control, SweepPlan& plan) {
    ScenePlans plans(sweep, control);
    std::map<std::size_t, std::string> refusals;  // of scenes, in their order
    const auto require_time = [&] {
        if (control.is_cancelled && control.is_cancelled()) throw Cancelled();
    };
    look_while(0.5 * budget_s, plan.scenes, [&](std::size_t scene) {
        require_time();
        ++plan.looked_at;
        const SceneLookUp found = plans.look_up(scene);
        if (found.refusals.empty()) return;
        ++(found.wavelengths.empty() ? plan.refused : plan.incomplete);
        std::vector<std::size_t> places;
        for (const Refusal& refusal : found.refusals)
            places.insert(places.end(), refusal.wavelengths.begin(), refusal.wavelengths.end());
        std::sort(places.begin(), places.end());
        refusals[scene] = fmt::format(
            "{}{}: {}", name_of(sweep, scene),
            found.wavelengths.empty() ? "" : " at " + describe_wavelengths(sweep, places),
            found.refusals.front().reason);
        if (refusals.size() > kNamed) refusals.erase(std::prev(refusals.end()));
    });
    for (const auto& [scene, text] : refusals) plan.refusals.push_back(text);

    std::set<std::size_t> groups;
    std::size_t costed = 0;
    look_while(0.5 * budget_s, plan.scenes, [&](std::size_t scene) {
        require_time();
        ++costed;
        groups.insert(scene / sweep.scenes_per_group());
        const SceneLookUp found = plans.look_up(scene);
        if (!found.wavelengths.empty()) plans.add(found);
    });
    plan.processor_seconds = plans.shared_s() * double(plan.groups) / double(groups.size()) +
                             plans.own_s() * double(plan.scenes) / double(costed);
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
