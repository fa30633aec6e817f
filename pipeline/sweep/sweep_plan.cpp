#include "pipeline/sweep/sweep_plan.h"

#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <thread>
#include <vector>

#include "pipeline/cache/job_key.h"
#include "pipeline/solve/layers.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/sweep/layout.h"
#include "pipeline/sweep/run.h"

namespace miebrdf::sweep {
namespace {

/// More pairs of group and wavelength are not timed, however fast they are.
constexpr std::size_t kMostCells = 512;
/// A number of a CSV file with its comma, as measured on tables of albedos.
constexpr double kBytesPerField = 15.0;

/// Processor time of this process: the plan runs on one thread.
template <typename Work>
double processor_seconds_of(const Work& work) {
    const std::clock_t start = std::clock();
    work();
    return double(std::clock() - start) / CLOCKS_PER_SEC;
}

/// What is timed together: a wavelength of a group, and another scene of the group.
struct TimedCell {
    std::size_t group = 0, wavelength = 0, other = 0;
};

/// Additive recurrence in three dimensions: the powers of 1 / g, g the root of g^4 = g + 1. Any
/// first part of it is spread evenly.
TimedCell cell_at(std::size_t i, std::size_t groups, std::size_t wavelengths,
                  std::size_t scenes_of_group) {
    const auto place = [i](double step, std::size_t size) {
        const double x = 0.5 + double(i) * step;
        return std::min(std::size_t((x - std::floor(x)) * double(size)), size - 1);
    };
    return {place(0.8191725133961645, groups), place(0.6710436067037893, wavelengths),
            scenes_of_group > 1 ? 1 + place(0.5497004779019703, scenes_of_group - 1) : 0};
}

/// The sweep at one wavelength. Colours need many; the albedo that they are made of takes the time.
Sweep at_wavelength(const Sweep& sweep, std::size_t w) {
    Sweep one = sweep;
    one.wavelength.numbers = {sweep.wavelength.numbers[w]};
    one.wavelength.words = {sweep.wavelength.words[w]};
    std::erase(one.outputs, Output::colour);
    if (one.outputs.empty() || (!one.wants_albedos() && sweep.wants(Output::colour)))
        one.outputs.push_back(Output::spherical_albedo);
    std::sort(one.outputs.begin(), one.outputs.end());
    return one;
}

/// Wavelengths that are solved: of those at which nothing differs, one.
std::vector<std::size_t> different_wavelengths(const Sweep& sweep, std::size_t scene) {
    std::vector<std::size_t> different;
    std::set<std::string> seen;
    try {
        const auto resolved = resolve(request_of(sweep, scene).scene, sweep.wavelength.numbers);
        for (std::size_t w = 0; w < resolved.wavelength_nm.size(); ++w) {
            JobKey key("wavelength");
            resolved.add_to(key, w);
            if (seen.insert(key.hash()).second) different.push_back(w);
        }
    } catch (const Error&) {  // it will fail at all
        different = {0};
    }
    return different;
}

/// Averages over sizes that a scene at one wavelength takes, by the hash that they are remembered
/// by.
using MieJobs = std::map<std::string, std::pair<ResolvedSpecies, OpticsDemand>>;

void add_jobs(const ResolvedMedium& medium, const OpticsDemand& demand, MieJobs& jobs) {
    for (const ResolvedSpecies& species : medium.species) {
        if (!species.needs_mie()) continue;
        OpticsDemand of_species = demand;
        of_species.whole_phase_function = demand.whole_phase_function || species.crowded;
        jobs.emplace(optics_hash(species, 0, of_species), std::pair(species, of_species));
    }
}

MieJobs jobs_of(const Sweep& one, std::size_t scene) {
    MieJobs jobs;
    const Request request = request_of(one, scene);
    const ResolvedScene resolved = resolve(request.scene, one.wavelength.numbers);
    const auto add = [&](LayerQuantity quantity) {
        const OpticsDemand demand =
            demand_of(request.solver, resolved.particles.tolerance, phase_demand(quantity));
        OpticsDemand extinction;
        extinction.tolerance = demand.tolerance;
        for (std::size_t m = resolved.first_medium(); m < resolved.media.size(); ++m)
            add_jobs(resolved.media[m], demand, jobs);
        for (std::size_t layer = 0; layer < resolved.layers(); ++layer) {
            const ResolvedDepth& depth = resolved.depths[layer];
            const bool is_there =
                depth.reference && depth.depth.wavelength_nm == resolved.wavelength_nm[0];
            if (depth.is_grey() || is_there) continue;
            add_jobs(resolved.media[layer + 1], extinction, jobs);
            if (depth.reference) add_jobs(*depth.reference, extinction, jobs);
        }
    };
    if (one.wants_matrices_or_brdf()) add(LayerQuantity::reflection);
    if (one.wants_albedos()) add(albedo_quantity(resolved));
    return jobs;
}

/// Of each job, the groups that share it: all along the dimensions whose next value keeps it.
std::map<std::string, double> groups_with(const MieJobs& jobs, const Sweep& one,
                                          std::size_t scene) {
    std::map<std::string, double> groups;
    for (const auto& [hash, job] : jobs) groups[hash] = 1.0;
    std::size_t stride = one.scenes();
    for (std::size_t d = 0; d < one.optical_dimensions; ++d) {
        const std::size_t size = one.dimensions[d].size();
        stride /= size;
        const std::size_t here = scene / stride % size, next = (here + 1) % size;
        if (size == 1) continue;
        try {
            const MieJobs there = jobs_of(one, scene - here * stride + next * stride);
            for (auto& [hash, count] : groups) count *= there.contains(hash) ? double(size) : 1.0;
        } catch (const Error&) {  // not shared with a scene that fails
        }
    }
    return groups;
}

/// What the whole sweep would take if every wavelength of every group were like this one.
double seconds_of_all(const Sweep& sweep, const TimedCell& cell, std::size_t wavelengths,
                      const Control& quiet) {
    Control control = quiet;
    control.memo = make_optics_memo(kSharedBytes);
    const Sweep one = at_wavelength(sweep, cell.wavelength);
    const Layout layout = layout_of(one);
    const std::size_t size = sweep.scenes_per_group(), first = cell.group * size;
    const double scenes = double(sweep.scenes()), groups = scenes / double(size);
    double mie = 0.0;
    try {
        const MieJobs jobs = jobs_of(one, first);
        const auto shared_by = groups_with(jobs, one, first);
        for (const auto& [hash, job] : jobs) {
            // A structured binding is captured as a variable of its own: Clang 14 asks for it.
            mie += processor_seconds_of([&, &of = hash, &asked = job] {
                       remembered_optics(control, of, [&] {
                           return compute_optics(asked.first, 0, asked.second);
                       });
                   }) /
                   shared_by.at(hash);
        }
    } catch (const Error&) {  // fails when it is solved, too
    }
    NamedIndexMemo& names = control.memo->names();
    const auto look_up = [first](const Sweep& at, NamedIndexMemo* remembered) {
        return processor_seconds_of([&] {
            try {
                resolve(request_of(at, first).scene, at.wavelength.numbers, remembered);
            } catch (const Error&) {
            }
        });
    };
    // Scenes find names remembered; they take about as long for one wavelength as for all.
    const auto look_up_again = [&](const Sweep& at) {
        look_up(at, &names);
        return look_up(at, &names);
    };
    const double header = look_up(sweep, nullptr);
    const double look_up_one = look_up_again(one), look_up_all = look_up_again(sweep);
    const auto solve_one = [&](std::size_t scene) {
        const double seconds =
            processor_seconds_of([&] { solve_scene(one, layout, scene, control); });
        return std::max(seconds - look_up_one, 0.0);
    };
    const double leader = solve_one(first);
    const double other = size > 1 ? solve_one(first + cell.other) : 0.0;
    // A part's file has the names of each group's first scene in its header.
    return groups * header + scenes * look_up_all +
           double(wavelengths) * (groups * (mie + leader) + (scenes - groups) * other);
}

void time_sample(const Sweep& sweep, double budget_s, const Control& quiet, SweepPlan& plan) {
    const std::size_t size = sweep.scenes_per_group();
    std::vector<double> times;
    std::set<std::pair<std::size_t, std::size_t>> seen;
    const auto different = different_wavelengths(sweep, plan.groups / 2 * size);
    const std::size_t cells = std::min(plan.groups * different.size(), kMostCells);
    constexpr std::size_t few = 2, repeats = 16;
    for (std::size_t i = 0; i < repeats * cells && times.size() < cells; ++i) {
        if (times.size() >= few && plan.sample_seconds > budget_s) break;
        if (quiet.is_cancelled && quiet.is_cancelled()) throw Cancelled();
        TimedCell cell = cell_at(i, plan.groups, different.size(), size);
        if (!seen.emplace(cell.group, cell.wavelength).second) continue;
        cell.wavelength = different[cell.wavelength];
        plan.sample_seconds += processor_seconds_of(
            [&] { times.push_back(seconds_of_all(sweep, cell, different.size(), quiet)); });
    }
    plan.sampled = times.size();
    const auto n = double(times.size());
    plan.processor_seconds = std::accumulate(times.begin(), times.end(), 0.0) / n;
    double sum = 0.0;
    for (const double time : times) sum += std::pow(time - plan.processor_seconds, 2);
    // Of groups with several scenes, single ones were timed: never all.
    const double left_out = size > 1 ? 1.0 : 1.0 - n / double(plan.groups * different.size());
    plan.processor_seconds_error = n > 1.0 ? std::sqrt(sum / (n - 1.0) / n * left_out)
                                           : std::numeric_limits<double>::quiet_NaN();
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
    Control quiet;
    quiet.is_cancelled = control.is_cancelled;
    quiet.threads = 1;
    time_sample(sweep, budget_s, quiet, plan);
    return plan;
}

}  // namespace miebrdf::sweep
