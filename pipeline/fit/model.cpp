#include "pipeline/fit/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <miebrdf/error.h>
#include "pipeline/fit/problem.h"
#include "pipeline/fit/spectra.h"
#include "pipeline/fit/varied_spheres.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/size_lattice.h"

namespace miebrdf::fitting {
namespace {

/// A difference goes this share of a number to either side: its own error is the square of that,
/// and what the choice of sphere sizes leaves, a tolerance, is divided by it.
constexpr double kStep = 1e-2;

/// Of the memo of optics: with less, a fresh one is made.
constexpr std::size_t kLeastMemory = std::size_t{32} << 20;

}  // namespace

namespace {

/// A measured value as a sum of solved ones.
struct ReadValue : Job::Reading {
    std::vector<SolvedShare> parts;
    double factor = 1.0;  ///< its scale

    double of(const std::vector<double>& solved) const {
        double sum = 0.0;
        for (const SolvedShare& part : parts) sum += part.weight * solved[part.use];
        return factor * sum;
    }
    double by_shift(const std::vector<double>& solved) const {
        double sum = 0.0;
        for (const SolvedShare& part : parts) sum += part.slope * solved[part.use];
        return factor * sum;
    }
};

std::vector<ReadValue> read(const Job& job, std::span<const double> numbers) {
    std::vector<ReadValue> values;
    values.reserve(job.readings.size());
    for (const Job::Reading& reading : job.readings)
        values.push_back({reading,
                          parts_of(job, reading, reading.shift ? numbers[*reading.shift] : 0.0),
                          reading.scale ? numbers[*reading.scale] : 1.0});
    return values;
}

}  // namespace

/// A job at the numbers, or with one of them moved to either side.
struct Model::Task {
    const Job* job;
    std::vector<double> numbers;  ///< empty: those asked for
    std::size_t slot = 0;
    double moved = 0.0;       ///< the fitted number
    bool has_failed = false;  ///< moved to where no scene can be
    SolvedJob solved = {};
};

Model::Model(const FitProblem& problem, const Control& control)
    : problem_(problem),
      control_(control),
      cache_(control.cache),
      wavelength_nm_(wavelengths_of(problem)),
      slots_(slots_of(problem.unknowns, wavelength_nm_.size())),
      jobs_(jobs_of(problem, slots_)) {
    for (const FitData& data : problem.data) values_ += data.values.size();
    std::set<double> finest;
    for (const Job& job : jobs_) finest.insert(job.finest_nm.begin(), job.finest_nm.end());
    spectrum_nm_.assign(finest.begin(), finest.end());
    control_.cache = {};
    control_.progress = {};
    control_.job_begun = {};
    control_.memo = make_optics_memo();
}

/// What earlier evaluations left is seldom wanted again; names of materials are.
const Control& Model::remembering() {
    if (control_.memo->free_bytes() < kLeastMemory) control_.memo = make_optics_memo();
    control_.memo->names().tells_crowding = false;
    control_.memo->names().spectrum_nm = spectrum_nm_;
    control_.memo->lattice = lattice_is_used_ ? lattice_ : nullptr;
    return control_;
}

std::size_t Model::slot(const Job& job, const std::string& name) const {
    return slot_of(problem_, slots_, name, job.only_wavelength.value_or(0));
}

Request Model::request(const Job& job, std::span<const double> numbers,
                       const std::vector<std::string>& names) const {
    Request request = request_of(problem_, slots_, job, numbers, names);
    if (is_coarse_) request.solver.tolerance = std::max(request.solver.tolerance, kSearchTolerance);
    return request;
}

bool Model::has_closed_forms(const Job& job, std::span<const double> numbers,
                             const std::vector<std::string>& names) {
    Job one = job;  // a wavelength knows
    if (one.is_interpolated()) one.set_wavelengths({job.wavelength_nm.front()});
    Request coarse = request(one, numbers, names);
    coarse.solver.tolerance = std::max(coarse.solver.tolerance, kSearchTolerance);
    const Control& control = remembering();
    control.memo->names().spectrum_nm.clear();  // no spectrum is sampled for one wavelength
    try {
        solve_job(one, coarse, control, names);
        return true;
    } catch (const UsageError&) {
        return false;
    }
}

/// The scene of a job with one number moved towards the farther bound, as far as words allow.
Scene Model::moved_scene(const Job& job, const std::string& name,
                         std::span<const double> numbers) const {
    std::vector<double> moved(numbers.begin(), numbers.end());
    double& number = moved[slot(job, name)];
    const double start = number;
    const Unknown& unknown = problem_.unknowns[slots_[slot(job, name)].unknown];
    const double farther = start < 0.5 * (unknown.low + unknown.high) ? unknown.high : unknown.low;
    for (double share = 0.5;; share *= 0.1) {
        number = start + share * (farther - start);
        try {
            return request(job, moved).scene;
        } catch (const UsageError&) {
            if (share < 1e-3) throw;
        }
    }
}

/// By differences: what has no closed forms, which are asked for once, and what changes spheres
/// other than by a lattice of their sizes. Averages of Mie theory with the sizes of another one
/// take ten times as long as two averages with sizes of their own.
void Model::prepare(std::span<const double> numbers) {
    std::set<std::string> known;
    std::vector<const Job*> different;
    std::vector<mie::SizeDistribution> fixed;
    bool sizes_vary = false, variances_vary = false;
    for (const Job& job : jobs_) {
        const bool is_known = std::any_of(
            different.begin(), different.end(),
            [&](const Job* other) { return other->words == job.words && other->kind == job.kind; });
        if (is_known) continue;
        different.push_back(&job);
        const Scene scene = request(job, numbers).scene;
        VariedSizes sizes;
        sizes.add(scene);
        std::vector<std::string> closed;
        for (const std::string& name : job.names) {
            try {
                const Scene other = moved_scene(job, name, numbers);
                sizes.add(other);
                const SphereChange spheres = sphere_change(scene, other);
                is_analytic_ = is_analytic_ && spheres == SphereChange::none;
                if (job.is_scattered() || spheres == SphereChange::other) {
                    by_differences_.insert(name);
                } else if (spheres == SphereChange::sizes) {
                    sizes_.insert(name);
                } else if (known.insert(name).second) {
                    closed.push_back(name);
                }
            } catch (const UsageError&) {
                by_differences_.insert(name);
                is_analytic_ = false;
            }
        }
        if (!closed.empty() && !has_closed_forms(job, numbers, closed)) {
            for (const std::string& name : closed) {
                if (closed.size() == 1 || !has_closed_forms(job, numbers, {name}))
                    by_differences_.insert(name);
            }
        }
        for (const mie::SizeDistribution& one : sizes.fixed()) fixed.push_back(one);
        sizes_vary = sizes_vary || sizes.vary();
        variances_vary = variances_vary || sizes.variances_vary();
    }
    if (!sizes_vary) return;
    lattice_ = std::make_shared<const SizeLattice>(SizeLattice::kCoarseStep, fixed, variances_vary,
                                                   cache_);
    finer_lattice_ =
        std::make_shared<const SizeLattice>(SizeLattice::kFineStep, fixed, variances_vary, cache_);
    lattice_is_used_ = true;
}

double Model::tolerance() const {
    return std::max(tolerance_of(problem_), is_coarse_ ? kSearchTolerance : 0.0);
}

/// The same fit meets these averages again.
void Model::evaluate_exactly(std::span<const double> numbers, std::span<double> values) {
    const bool is_first = exact_jobs_.empty();
    if (is_first) exact_jobs_ = jobs_;
    const auto exchange = [&, was_coarse = is_coarse_](bool exactly) {
        std::swap(jobs_, exact_jobs_);
        is_coarse_ = was_coarse && !exactly;
        lattice_is_used_ = !exactly;
        control_.cache = exactly ? cache_ : nullptr;
    };
    exchange(true);
    try {
        if (is_first) choose_streams(numbers);
        evaluate(numbers, values, {});
    } catch (...) {
        exchange(false);
        throw;
    }
    exchange(false);
}

void Model::refine_lattice() {
    lattice_is_used_ = finer_lattice_ != nullptr;
    if (lattice_is_used_) lattice_ = std::exchange(finer_lattice_, nullptr);
}

/// Light with polarisation has no lattice.
std::vector<std::string> Model::closed_forms(const Job& job) const {
    const bool has_lattice = lattice_is_used_ && job.takes_intensity_alone;
    std::vector<std::string> names;
    for (const std::string& name : job.names) {
        if (!by_differences_.contains(name) && (has_lattice || !sizes_.contains(name)))
            names.push_back(name);
    }
    return names;
}

/// Nodes of the lattice lie up to two widths beyond the size that is asked for.
template <typename Solve>
void Model::with_lattice_or_without(const Solve& solve) {
    if (!lattice_is_used_) return solve();
    try {
        return solve();
    } catch (const UsageError&) {
        lattice_is_used_ = false;
    }
    try {
        solve();
    } catch (...) {
        lattice_is_used_ = true;
        throw;
    }
    lattice_is_used_ = true;
}

/// With wavelengths of its own choice.
SolvedJob Model::solve_freely(Job& job, std::span<const double> numbers) {
    job.streams = 0;
    job.takes_intensity_alone = false;
    SolvedJob most;
    const auto solve_at = [&](const std::vector<double>& nm) {
        Job some = job;
        if (job.is_interpolated()) some.set_wavelengths(nm);
        // What the first wavelengths do not show those between them do not.
        some.takes_intensity_alone = most.streams > 0 && most.components == 1;
        SolvedJob solved = solve_job(some, request(some, numbers), remembering(), {});
        ++solved_scenes_;
        most.streams = std::max(most.streams, solved.streams);
        most.components = std::max(most.components, solved.components);
        return std::move(solved.values);
    };
    if (job.is_interpolated()) {
        job.set_wavelengths(chosen_wavelengths(job, tolerance(), solve_at));
    } else {
        solve_at({});
    }
    return most;
}

double Model::trace_lost_light(std::span<const double> numbers) {
    double change = 0.0;
    for (Job& job : jobs_)
        change =
            std::max(change, fitting::trace_lost_light(job, request(job, numbers), remembering()));
    return change;
}

bool Model::choose_streams(std::span<const double> numbers) {
    std::vector<SolvedJob> solved;
    std::vector<Job> chosen;
    with_lattice_or_without([&] {
        solved.clear();
        chosen = jobs_;
        for (Job& job : chosen) solved.push_back(solve_freely(job, numbers));
    });
    bool more = false;
    for (std::size_t j = 0; j < jobs_.size(); ++j) {
        Job& job = jobs_[j];
        const int before = job.streams;
        if (chosen[j].wavelength_nm.size() > job.wavelength_nm.size()) {
            more = true;
            job.set_wavelengths(chosen[j].wavelength_nm);
        }
        job.streams = std::max(before, solved[j].streams);
        const bool took_intensity_alone =
            std::exchange(job.takes_intensity_alone, solved[j].components == 1);
        more = more || job.streams > before || (took_intensity_alone && !job.takes_intensity_alone);
    }
    return more;
}

void Model::add_moved(const Job& job, const std::string& name, std::span<const double> numbers,
                      std::vector<Task>& tasks) const {
    const std::size_t s = slot(job, name);
    const Unknown& unknown = problem_.unknowns[slots_[s].unknown];
    const Range range = fitted_range(unknown);
    const double t = fitted_of(unknown, numbers[s]), width = range.high - range.low;
    const double own_size = unknown.scale == Unknown::Scale::linear ? std::abs(t) : 1.0;
    const double step = std::min(kStep * std::max(own_size, 0.1 * width), 0.05 * width);
    for (const double moved : {std::max(t - step, range.low), std::min(t + step, range.high)}) {
        Task task{&job, {numbers.begin(), numbers.end()}, s, moved};
        task.numbers[s] = number_of(unknown, moved);
        tasks.push_back(std::move(task));
    }
}

void Model::evaluate(std::span<const double> numbers, std::span<double> values,
                     std::span<double> derivatives) {
    with_lattice_or_without([&] { evaluate_as_set(numbers, values, derivatives); });
}

void Model::evaluate_as_set(std::span<const double> numbers, std::span<double> values,
                            std::span<double> derivatives) {
    const Control& control = remembering();
    const bool differentiate = !derivatives.empty();
    // The middle before what is moved from it: then most of the lattice is known.
    const auto solve_all = [&](std::vector<Task>& tasks) {
        Control inner = control;
        if (tasks.size() > 1) inner.threads = 1;
        run_parallel("fit", tasks.size(), control, [&](std::size_t i) {
            Task& task = tasks[i];
            const bool is_middle = task.numbers.empty();
            const std::vector<std::string> names =
                differentiate && is_middle ? closed_forms(*task.job) : std::vector<std::string>();
            const std::span<const double> at = is_middle ? numbers : task.numbers;
            try {
                task.solved = solve_job(*task.job, request(*task.job, at, names), inner, names);
            } catch (const UsageError&) {
                if (is_middle) throw;
                task.has_failed = true;
            }
        });
        solved_scenes_ += int(tasks.size());
    };
    std::vector<Task> middles;
    for (const Job& job : jobs_) middles.push_back({&job, {}});
    solve_all(middles);
    std::fill(derivatives.begin(), derivatives.end(), 0.0);
    const std::size_t columns = slots_.size();
    std::vector<Task> moved;
    for (const Task& middle : middles) {
        const Job& job = *middle.job;
        const std::vector<ReadValue> readings = read(job, numbers);
        for (const ReadValue& reading : readings) {
            values[reading.value] = reading.of(middle.solved.values);
            if (!differentiate) continue;
            const auto slopes = derivatives.subspan(reading.value * columns, columns);
            if (reading.scale) slopes[*reading.scale] = values[reading.value];  // in its logarithm
            if (reading.shift) slopes[*reading.shift] = reading.by_shift(middle.solved.values);
        }
        if (!differentiate) continue;
        const std::vector<std::string> names = closed_forms(job);
        for (const std::string& name : job.names) {
            const auto closed = std::find(names.begin(), names.end(), name);
            if (closed == names.end()) {
                add_moved(job, name, numbers, moved);
                continue;
            }
            const std::vector<double>& slopes =
                middle.solved.derivatives[std::size_t(closed - names.begin())];
            // A medium at a corner of its discretisation: hg: with g = 0 has a single moment.
            if (std::all_of(slopes.begin(), slopes.end(), [](double d) { return d == 0.0; })) {
                add_moved(job, name, numbers, moved);
                continue;
            }
            const std::size_t s = slot(job, name);
            const double by_fitted = slope(problem_.unknowns[slots_[s].unknown], numbers[s]);
            for (const ReadValue& reading : readings)
                derivatives[reading.value * columns + s] = reading.of(slopes) * by_fitted;
        }
    }
    solve_all(moved);
    for (std::size_t k = 0; k + 1 < moved.size(); k += 2) {
        Task &below = moved[k], &above = moved[k + 1];
        if (below.has_failed && above.has_failed)
            throw UsageError(fmt::format("{} cannot be computed on either side of {}",
                                         problem_.unknowns[slots_[below.slot].unknown].name,
                                         numbers[below.slot]));
        for (Task* const task : {&below, &above}) {
            if (!task->has_failed) continue;
            const auto middle = std::find_if(middles.begin(), middles.end(),
                                             [&](const Task& one) { return one.job == task->job; });
            task->solved.values = middle->solved.values;
            task->moved =
                fitted_of(problem_.unknowns[slots_[task->slot].unknown], numbers[task->slot]);
        }
        for (const ReadValue& reading : read(*below.job, numbers))
            derivatives[reading.value * columns + below.slot] =
                (reading.of(above.solved.values) - reading.of(below.solved.values)) /
                (above.moved - below.moved);
    }
}

}  // namespace miebrdf::fitting
