#include "pipeline/fit/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <tuple>

#include <miebrdf/error.h>
#include "pipeline/fit/problem.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/parallel.h"

namespace miebrdf::fitting {
namespace {

enum class Kind { albedo, brdf, hdrf, lab };

Kind kind_of(const MeasuredValue& value) {
    switch (value.quantity) {
        case MeasuredQuantity::brdf:
            return Kind::brdf;
        case MeasuredQuantity::reflectance_factor:
            return value.geometry == MeasuredGeometry::hdrf ? Kind::hdrf : Kind::brdf;
        case MeasuredQuantity::lab_l:
        case MeasuredQuantity::lab_a:
        case MeasuredQuantity::lab_b:
            return Kind::lab;
        default:
            return Kind::albedo;
    }
}

/// Wavelengths that a colour is told from.
std::vector<double> lab_wavelengths() {
    std::vector<double> nm;
    for (int i = 400; i <= 700; i += 10) nm.push_back(i);
    return nm;
}

/// Scenes look alike on both sides of the plane of incidence.
double azimuth_of(const MeasuredValue& value) {
    return std::isnan(value.azimuth_deg) ? 0.0 : std::abs(std::remainder(value.azimuth_deg, 360.0));
}

/// The medium without its amounts, where spheres are in it.
std::vector<Species> spheres_of(const Medium& medium) {
    std::vector<Species> spheres;
    for (Species species : medium.species) {
        species.amount = {};
        if (needs_mie(species)) spheres.push_back(std::move(species));
    }
    return spheres;
}

/// Whether other spheres, or spheres in another host, are in two scenes of the same words.
bool have_other_spheres(const Scene& a, const Scene& b) {
    const auto differ = [&](const Medium& one, const Medium& other) {
        const auto spheres = spheres_of(one);
        return spheres != spheres_of(other) ||
               (!spheres.empty() && host_of(a, one) != host_of(b, other));
    };
    const auto& sizes = a.particles.sizes;
    const auto& others = b.particles.sizes;
    if (differ(a.base, b.base) || sizes.effective_radius_um != others.effective_radius_um ||
        sizes.effective_variance != others.effective_variance)
        return true;
    for (std::size_t l = 0; l < a.layers.size(); ++l) {
        if (differ(a.layers[l].medium, b.layers[l].medium)) return true;
    }
    return false;
}

/// The place of a value in a list, which gets it if it is not there.
std::size_t place_in(std::vector<double>& list, double value) {
    const auto found = std::find(list.begin(), list.end(), value);
    if (found != list.end()) return std::size_t(found - list.begin());
    list.push_back(value);
    return list.size() - 1;
}

bool uses_per_wavelength(const std::vector<TemplateWord>& words,
                         const std::vector<Unknown>& unknowns) {
    const auto names = names_in(words);
    return std::any_of(unknowns.begin(), unknowns.end(), [&](const Unknown& unknown) {
        return unknown.per_wavelength && names.contains(unknown.name);
    });
}

/// A difference goes this share of a number to either side: its own error is the square of that,
/// and what the choice of sphere sizes leaves, a tolerance, is divided by it.
constexpr double kStep = 1e-2;

/// Of the memo of optics: with less, a fresh one is made.
constexpr std::size_t kLeastMemory = std::size_t{32} << 20;

/// A colour is differentiated along the spectrum's own derivative by a step of this share: half
/// the digits of a smooth formula.
constexpr double kColourStep = 1e-5;

std::vector<double> spectrum_at(const AlbedoValues& values, std::size_t in) {
    std::vector<double> spectrum;
    for (const std::vector<double>& at : values.plane_albedo) spectrum.push_back(at[in]);
    return spectrum;
}

double of_lab(MeasuredQuantity quantity, const Lab& lab) {
    if (quantity == MeasuredQuantity::lab_l) return lab.l;
    return quantity == MeasuredQuantity::lab_a ? lab.a : lab.b;
}

}  // namespace

/// A scene to be solved once for all values that it gives.
struct Model::Job {
    struct Use {
        std::size_t value = 0;  ///< index over all data
        MeasuredQuantity quantity = MeasuredQuantity::reflectance;
        MeasuredGeometry geometry = MeasuredGeometry::directional;
        std::size_t wavelength = 0, in = 0, out = 0,
                    azimuth = 0;           ///< indices of this job
        std::optional<std::size_t> scale;  ///< slot
    };
    std::vector<TemplateWord> words;
    std::set<std::string> names;  ///< of unknowns in them
    Kind kind = Kind::albedo;
    double diffuse_fraction = 0.0;
    Viewing viewing = {};
    std::optional<std::size_t> only_wavelength;  ///< index in the model's: unknowns differ there
    std::vector<double> wavelength_nm;
    Directions directions = {};
    std::vector<Use> uses;
    int streams = 0;  ///< 0: chosen by the solver
};

Model::~Model() = default;
Model::Model(Model&&) noexcept = default;

std::vector<TemplateWord> words_of(const FitProblem& problem, const FitData& data) {
    std::vector<SceneText> texts = problem.scene;
    for (const SceneText& own : data.scene) {
        std::erase_if(texts, [&](const SceneText& t) { return t.word == own.word; });
        if (!own.values.empty()) texts.push_back(own);
    }
    std::vector<TemplateWord> words;
    for (const SceneText& text : texts) {
        if (text.values.empty()) continue;
        TemplateWord word{text.word, {}, ""};
        for (const std::string& value : text.values) {
            if (find_scene_word(text.word)->kind == WordKind::flag) {
                if (value == "true") word.values.emplace_back(true);
            } else {
                word.values.emplace_back(value);
            }
        }
        if (!word.values.empty()) words.push_back(std::move(word));
    }
    return words;
}

std::vector<double> wavelengths_of(const FitProblem& problem) {
    std::set<double> all;
    for (const FitData& data : problem.data) {
        for (const MeasuredValue& value : data.values) {
            if (kind_of(value) != Kind::lab) all.insert(value.wavelength_nm);
        }
    }
    return {all.begin(), all.end()};
}

Model::Model(const FitProblem& problem, const Control& control)
    : problem_(problem),
      control_(control),
      wavelength_nm_(wavelengths_of(problem)),
      slots_(slots_of(problem.unknowns, wavelength_nm_.size())) {
    control_.cache = {};
    control_.progress = {};
    control_.job_begun = {};
    control_.memo = make_optics_memo();
    for (const FitData& data : problem.data) {
        const std::vector<TemplateWord> words = words_of(problem, data);
        const bool apart = uses_per_wavelength(words, problem.unknowns);
        std::optional<std::size_t> scale;
        for (std::size_t s = 0; s < slots_.size(); ++s) {
            if (data.free_scale && problem.unknowns[slots_[s].unknown].name == name_of_scale(data))
                scale = s;
        }
        for (const MeasuredValue& value : data.values) {
            const Kind kind = kind_of(value);
            const auto at = std::lower_bound(wavelength_nm_.begin(), wavelength_nm_.end(),
                                             value.wavelength_nm) -
                            wavelength_nm_.begin();
            const auto only =
                apart ? std::optional<std::size_t>(std::size_t(at)) : std::optional<std::size_t>();
            auto job = std::find_if(jobs_.begin(), jobs_.end(), [&](const Job& j) {
                return j.kind == kind && j.only_wavelength == only && j.words == words &&
                       j.diffuse_fraction == data.diffuse_fraction && j.viewing == data.viewing;
            });
            if (job == jobs_.end()) {
                jobs_.push_back({words,
                                 names_in(words),
                                 kind,
                                 data.diffuse_fraction,
                                 data.viewing,
                                 only,
                                 kind == Kind::lab ? lab_wavelengths() : std::vector<double>{},
                                 {},
                                 {},
                                 0});
                job = jobs_.end() - 1;
            }
            Job::Use use{.value = values_++,
                         .quantity = value.quantity,
                         .geometry = value.geometry,
                         .scale = scale};
            if (kind != Kind::lab)
                use.wavelength = place_in(job->wavelength_nm, value.wavelength_nm);
            if (!is_of_all_sides(value)) use.in = place_in(job->directions.mu_in, value.mu_in);
            if (kind == Kind::brdf || kind == Kind::hdrf) {
                use.out = place_in(job->directions.mu_out, value.mu_out);
                use.azimuth = place_in(job->directions.azimuth_deg, azimuth_of(value));
            }
            job->uses.push_back(use);
        }
    }
    for (Job& job : jobs_) {
        if (job.directions.mu_in.empty()) job.directions.mu_in = {1.0};  // albedos want one
    }
}

/// Values in the order of a job's uses, and derivatives by each of its names in turn.
struct Model::Solved {
    std::vector<double> values;
    std::vector<std::vector<double>> derivatives;  ///< [name][use]
};

namespace {

double albedo_value(const AlbedoValues& values, MeasuredQuantity quantity,
                    MeasuredGeometry geometry, std::size_t w, std::size_t in) {
    const bool from_all_sides = geometry == MeasuredGeometry::hemispherical;
    if (quantity == MeasuredQuantity::transmittance) {
        if (values.plane_transmittance.empty())
            throw UsageError("a transmittance needs layers on a substrate: none, black, lambert:A");
        return from_all_sides ? values.spherical_transmittance[w]
                              : values.plane_transmittance[w][in];
    }
    if (from_all_sides) return values.spherical_albedo[w];
    const double albedo = values.plane_albedo[w][in];
    const bool has_mirror = !values.mirror_reflectance.empty();
    return geometry == MeasuredGeometry::d8_sce && has_mirror
               ? albedo - values.mirror_reflectance[w][in]
               : albedo;
}

}  // namespace

/// The scene at these numbers. @param names  of numbers that the scene is to know by their names
Request Model::request_of(const Job& job, std::span<const double> numbers,
                          const std::vector<std::string>& names) const {
    const auto text_of = [&](const std::string& name) {
        const double number = numbers[slot_of(name, job.only_wavelength.value_or(0))];
        const bool is_named = std::find(names.begin(), names.end(), name) != names.end();
        return is_named ? fmt::format("{{{}={}}}", name, number) : fmt::format("{}", number);
    };
    Request request;
    request.solver.tolerance = tolerance_of(problem_);
    for (const TemplateWord& word : job.words) apply(word, text_of, request);
    if (request.solver.streams == 0) request.solver.streams = job.streams;
    return request;
}

Model::Solved Model::solve_job(const Job& job, std::span<const double> numbers,
                               const Control& control, const std::vector<std::string>& names,
                               int* streams) const {
    const Request request = request_of(job, numbers, names);
    const Brdf brdf = solve(request.scene, job.wavelength_nm, request.solver, control);
    Solved solved;
    // Of the values and of each derivative alike.
    const auto column = [&](const auto& value_of) {
        std::vector<double> all;
        for (const Job::Use& use : job.uses) all.push_back(value_of(use));
        return all;
    };
    const auto fill = [&](const auto& with, const auto& value_in) {
        solved.values = column([&](const Job::Use& use) { return value_in(with.values, use); });
        for (const auto& derivative : with.derivatives)
            solved.derivatives.push_back(
                column([&](const Job::Use& use) { return value_in(derivative, use); }));
        if (streams == nullptr) return;
        for (const WavelengthReport& at : with.values.wavelengths)
            *streams = std::max(*streams, at.solver.streams);
    };
    const BrdfParts whole{.subsurface = false, .surface = false, .total = true};
    const auto brdf_of = [&] {
        return names.empty()
                   ? WithDerivatives<BrdfValues>{brdf.evaluate(job.directions, whole), {}, {}}
                   : brdf.derivatives(names).evaluate(job.directions, whole);
    };
    const auto albedo_of = [&](const std::vector<double>& mu_in) {
        return names.empty() ? WithDerivatives<AlbedoValues>{brdf.albedo(mu_in), {}, {}}
                             : brdf.derivatives(names).albedo(mu_in);
    };
    if (job.kind == Kind::brdf || job.kind == Kind::hdrf) {
        const double share = job.kind == Kind::hdrf ? job.diffuse_fraction : 0.0;
        // Sun and sky apart (Brdf::hdrf).
        std::optional<WithDerivatives<AlbedoValues>> sky;
        if (share > 0.0) {
            if (request.scene.surface) brdf.hdrf({{1.0}, {1.0}, {0.0}}, share);  // may refuse it
            sky = albedo_of(job.directions.mu_out);
        }
        const auto sun = brdf_of();
        fill(sun, [&](const BrdfValues& values, const Job::Use& use) {
            const double f = values.at(use.wavelength, use.in, use.out, use.azimuth);
            if (use.quantity == MeasuredQuantity::brdf) return f;
            const double factor = std::numbers::pi * f;
            if (!sky) return factor;
            const AlbedoValues& of_sky =
                &values == &sun.values
                    ? sky->values
                    : sky->derivatives[std::size_t(&values - sun.derivatives.data())];
            return (1.0 - share) * factor + share * of_sky.plane_albedo[use.wavelength][use.out];
        });
        return solved;
    }
    const auto albedo = albedo_of(job.directions.mu_in);
    if (job.kind == Kind::albedo) {
        fill(albedo, [&](const AlbedoValues& values, const Job::Use& use) {
            return albedo_value(values, use.quantity, use.geometry, use.wavelength, use.in);
        });
        return solved;
    }
    const Colorimeter colorimeter(job.wavelength_nm, job.viewing);
    fill(albedo, [&](const AlbedoValues& values, const Job::Use& use) {
        std::vector<double> spectrum = spectrum_at(albedo.values, use.in);
        if (&values == &albedo.values) return of_lab(use.quantity, colorimeter(spectrum).lab);
        const std::vector<double> slope = spectrum_at(values, use.in);
        const auto moved = [&](double step) {
            std::vector<double> at = spectrum;
            for (std::size_t w = 0; w < at.size(); ++w) at[w] += step * slope[w];
            return of_lab(use.quantity, colorimeter(at).lab);
        };
        double largest = 0.0;
        for (const double each : slope) largest = std::max(largest, std::abs(each));
        if (largest == 0.0) return 0.0;
        const double step = kColourStep / largest;
        return (moved(step) - moved(-step)) / (2.0 * step);
    });
    return solved;
}

/// Which unknowns are differentiated by differences: those without closed forms, which are asked
/// for once, and those that change spheres. Averages of Mie theory with the sizes of another one
/// take ten times as long as two averages with sizes of their own.
void Model::find_closed_forms(std::span<const double> numbers) {
    by_differences_.emplace();
    std::set<std::string> known;
    for (const Job& job : jobs_) {
        const Scene scene = request_of(job, numbers, {}).scene;
        for (const std::string& name : job.names) {
            if (!known.insert(name).second) continue;
            std::vector<double> moved(numbers.begin(), numbers.end());
            const std::size_t slot = slot_of(name, job.only_wavelength.value_or(0));
            const Unknown& unknown = problem_.unknowns[slots_[slot].unknown];
            moved[slot] = 0.5 * (moved[slot] + (moved[slot] < 0.5 * (unknown.low + unknown.high)
                                                    ? unknown.high
                                                    : unknown.low));
            try {
                if (have_other_spheres(scene, request_of(job, moved, {}).scene)) {
                    by_differences_->insert(name);
                } else {
                    solve_job(job, numbers, control_, {name}, nullptr);
                }
            } catch (const UsageError&) {
                by_differences_->insert(name);
            }
        }
    }
}

std::vector<std::string> Model::closed_forms(const Job& job) const {
    std::vector<std::string> names;
    for (const std::string& name : job.names) {
        if (!by_differences_->contains(name)) names.push_back(name);
    }
    return names;
}

bool Model::choose_streams(std::span<const double> numbers) {
    bool more = false;
    for (Job& job : jobs_) {
        const int before = job.streams;
        int streams = 0;
        job.streams = 0;
        solve_job(job, numbers, control_, {}, &streams);
        job.streams = std::max(before, streams);
        more = more || job.streams > before;
    }
    if (!by_differences_) find_closed_forms(numbers);
    return more;
}

void Model::evaluate(std::span<const double> numbers, std::span<double> values,
                     std::span<double> derivatives) {
    // What earlier evaluations left is seldom wanted again; names of materials are.
    if (control_.memo->free_bytes() < kLeastMemory) control_.memo = make_optics_memo();
    const bool differentiate = !derivatives.empty();
    if (!by_differences_ && differentiate) find_closed_forms(numbers);
    /// A job at the numbers, or with one of them moved to either side.
    struct Task {
        const Job* job;
        std::vector<double> numbers;
        std::size_t slot = 0;
        double moved = 0.0;  ///< the fitted number
        Solved solved = {};
    };
    std::vector<Task> tasks;
    for (const Job& job : jobs_) tasks.push_back({&job, {numbers.begin(), numbers.end()}});
    for (const Job& job : jobs_) {
        if (!differentiate) break;
        for (const std::string& name : job.names) {
            if (!by_differences_->contains(name)) continue;
            const std::size_t slot = slot_of(name, job.only_wavelength.value_or(0));
            const Unknown& unknown = problem_.unknowns[slots_[slot].unknown];
            const Range range = fitted_range(unknown);
            const double t = fitted_of(unknown, numbers[slot]);
            const double own_size = unknown.scale == Unknown::Scale::linear ? std::abs(t) : 1.0;
            const double step = std::min(kStep * std::max(own_size, 0.1 * (range.high - range.low)),
                                         0.05 * (range.high - range.low));
            for (const double moved :
                 {std::max(t - step, range.low), std::min(t + step, range.high)}) {
                Task task{&job, {numbers.begin(), numbers.end()}, slot, moved};
                task.numbers[slot] = number_of(unknown, moved);
                tasks.push_back(std::move(task));
            }
        }
    }
    Control inner = control_;
    if (tasks.size() > 1) inner.threads = 1;
    run_parallel("fit", tasks.size(), control_, [&](std::size_t i) {
        Task& task = tasks[i];
        const bool is_middle = i < jobs_.size();
        task.solved = solve_job(
            *task.job, task.numbers, inner,
            differentiate && is_middle ? closed_forms(*task.job) : std::vector<std::string>(),
            nullptr);
    });
    solved_scenes_ += int(tasks.size());
    const std::size_t columns = slots_.size();
    std::fill(derivatives.begin(), derivatives.end(), 0.0);
    for (std::size_t j = 0; j < jobs_.size(); ++j) {
        const Job& job = jobs_[j];
        const Solved& solved = tasks[j].solved;
        const std::vector<std::string> names =
            differentiate ? closed_forms(job) : std::vector<std::string>();
        for (std::size_t i = 0; i < job.uses.size(); ++i) {
            const Job::Use& use = job.uses[i];
            const double scale = use.scale ? numbers[*use.scale] : 1.0;
            values[use.value] = scale * solved.values[i];
            if (!differentiate) continue;
            double* const row = derivatives.data() + use.value * columns;
            if (use.scale) row[*use.scale] = values[use.value];  // fitted in its logarithm
            for (std::size_t n = 0; n < names.size(); ++n) {
                const std::size_t slot = slot_of(names[n], job.only_wavelength.value_or(0));
                row[slot] = scale * solved.derivatives[n][i] *
                            slope(problem_.unknowns[slots_[slot].unknown], numbers[slot]);
            }
        }
    }
    for (std::size_t k = jobs_.size(); k + 1 < tasks.size(); k += 2) {
        const Task &below = tasks[k], &above = tasks[k + 1];
        for (std::size_t i = 0; i < below.job->uses.size(); ++i) {
            const Job::Use& use = below.job->uses[i];
            const double scale = use.scale ? numbers[*use.scale] : 1.0;
            derivatives[use.value * columns + below.slot] =
                scale * (above.solved.values[i] - below.solved.values[i]) /
                (above.moved - below.moved);
        }
    }
}

std::size_t Model::slot_of(const std::string& name, std::size_t wavelength) const {
    for (std::size_t s = 0; s < slots_.size(); ++s) {
        const Unknown& unknown = problem_.unknowns[slots_[s].unknown];
        if (unknown.name == name) return unknown.per_wavelength ? s + wavelength : s;
    }
    throw UsageError(fmt::format("there is no unknown '{0}' for {{{0}}}", name));
}

}  // namespace miebrdf::fitting
