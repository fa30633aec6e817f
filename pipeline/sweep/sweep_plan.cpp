#include "pipeline/sweep/sweep_plan.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <thread>
#include <vector>

#include "pipeline/sweep/run.h"

namespace miebrdf::sweep {
namespace {

constexpr std::size_t kMostSamples = 8;
/// A number of a CSV file with its comma, as measured on tables of albedos.
constexpr double kBytesPerField = 15.0;

template <typename Work>
double seconds_of(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Middles of equal parts of the groups, in an order that is spread from the first on.
std::vector<std::size_t> sampled_groups(std::size_t groups) {
    const std::size_t count = std::min(groups, kMostSamples);
    std::vector<std::size_t> places;
    for (const std::size_t k : {3u, 6u, 1u, 4u, 0u, 7u, 2u, 5u}) {
        if (k < count) places.push_back((2 * k + 1) * groups / (2 * count));
    }
    return places;
}

/// Seconds of a whole group, from its first scene and as many others as there are threads.
double group_seconds(const Sweep& sweep, const Layout& layout, std::size_t group,
                     const Control& control, std::size_t& sampled) {
    const std::size_t size = sweep.scenes_per_group(), first = group * size;
    const auto threads =
        std::size_t(control.threads > 0 ? unsigned(control.threads)
                                        : std::max(1u, std::thread::hardware_concurrency()));
    std::vector<std::size_t> scenes;
    if (size == 1) {  // as many as run side by side
        for (std::size_t s = first; s < std::min(first + threads, sweep.scenes()); ++s)
            scenes.push_back(s);
        sampled += scenes.size();
        return seconds_of([&] { solve_scenes(sweep, layout, scenes, control.threads, control); }) /
               double(scenes.size());
    }
    const double leader =
        seconds_of([&] { solve_scenes(sweep, layout, {first}, control.threads, control); });
    for (std::size_t s = 1; s < std::min(size, threads + 1); ++s) scenes.push_back(first + s);
    sampled += 1 + scenes.size();
    const double others = seconds_of([&] { solve_scenes(sweep, layout, scenes, 1, control); });
    return leader + double(size - 1) * others / double(scenes.size());
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

    Control quiet = control;
    quiet.cache = nullptr;
    quiet.memo = make_optics_memo(kSharedBytes);
    std::vector<double> times;
    for (const std::size_t group : sampled_groups(plan.groups)) {
        if (!times.empty() && plan.sample_seconds > budget_s) break;
        plan.sample_seconds += seconds_of(
            [&] { times.push_back(group_seconds(sweep, layout, group, quiet, plan.sampled)); });
    }
    plan.sampled_groups = times.size();
    const auto n = double(times.size());
    const double mean = std::accumulate(times.begin(), times.end(), 0.0) / n;
    plan.seconds = mean * double(plan.groups);
    if (times.size() > 1) {
        double sum = 0.0;
        for (const double time : times) sum += (time - mean) * (time - mean);
        plan.seconds_error = std::sqrt(sum / (n - 1.0) / n) * double(plan.groups);
    }
    return plan;
}

}  // namespace miebrdf::sweep
