#include "pipeline/fit/job.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "pipeline/fit/derived.h"
#include "pipeline/fit/problem.h"
#include "pipeline/fit/spectra.h"

namespace miebrdf::fitting {
namespace {

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

/// Combinations of directions are solved exactly and cost little each; with more than so many in
/// all, and so many for each value, a table is solved and asked at the directions alone.
constexpr std::size_t kMostCombinations = 100'000, kMostPerValue = 20;

bool is_same(const Sky& a, const Sky& b) {
    return a.kind == b.kind && a.wavelength_nm == b.wavelength_nm && a.zenith_deg == b.zenith_deg &&
           a.azimuth_deg == b.azimuth_deg && a.values == b.values;
}

void scatter(Job& job) {
    const Directions& d = job.directions;
    const std::size_t combinations = d.mu_in.size() * d.mu_out.size() * d.azimuth_deg.size();
    if (combinations <= std::max(kMostCombinations, kMostPerValue * job.uses.size())) return;
    // Directions that share their cosines follow each other: BrdfTable solves these together.
    std::vector<std::pair<Direction, Job::Use*>> asked;
    for (Job::Use& use : job.uses)
        asked.push_back({{d.mu_in[use.in], d.mu_out[use.out], d.azimuth_deg[use.azimuth]}, &use});
    const auto order = [](const Direction& a, const Direction& b) {
        return std::tie(a.mu_in, a.mu_out, a.azimuth_deg) <
               std::tie(b.mu_in, b.mu_out, b.azimuth_deg);
    };
    std::sort(asked.begin(), asked.end(),
              [&](const auto& a, const auto& b) { return order(a.first, b.first); });
    for (const auto& [direction, use] : asked) {
        if (job.points.empty() || order(job.points.back(), direction))
            job.points.push_back(direction);
        use->point = job.points.size() - 1;
    }
}

}  // namespace

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

void Job::set_wavelengths(std::vector<double> nm) {
    wavelength_nm = std::move(nm);
    uses.clear();
    for (const Use& spectrum : spectra) {
        for (std::size_t w = 0; w < wavelength_nm.size(); ++w) {
            uses.push_back(spectrum);
            uses.back().wavelength = w;
        }
    }
}

std::size_t slot_of(const FitProblem& problem, const std::vector<Slot>& slots,
                    const std::string& name, std::size_t wavelength) {
    for (std::size_t s = 0; s < slots.size(); ++s) {
        const Unknown& unknown = problem.unknowns[slots[s].unknown];
        if (unknown.name == name) return unknown.per_wavelength ? s + wavelength : s;
    }
    throw UsageError(fmt::format("there is no unknown '{0}' for {{{0}}}", name));
}

std::vector<Job> jobs_of(const FitProblem& problem, const std::vector<Slot>& slots) {
    const std::vector<double> wavelength_nm = wavelengths_of(problem);
    std::vector<Job> jobs;
    std::size_t values = 0;
    for (const FitData& data : problem.data) {
        const std::vector<TemplateWord> words = words_of(problem, data);
        const bool apart =
            uses_per_wavelength(words, problem.unknowns) || uses_derived(problem, words);
        Job::Reading reading{.shift_nm = data.wavelength_shift_nm,
                             .band_width_nm = data.band_width_nm};
        if (data.free_scale) reading.scale = slot_of(problem, slots, name_of_scale(data), 0);
        if (data.free_wavelength_shift)
            reading.shift = slot_of(problem, slots, name_of_shift(data), 0);
        for (const MeasuredValue& value : data.values) {
            const Kind kind = kind_of(value);
            const auto at =
                std::lower_bound(wavelength_nm.begin(), wavelength_nm.end(), value.wavelength_nm) -
                wavelength_nm.begin();
            const auto only =
                apart ? std::optional<std::size_t>(std::size_t(at)) : std::optional<std::size_t>();
            auto job = std::find_if(jobs.begin(), jobs.end(), [&](const Job& j) {
                return j.kind == kind && j.only_wavelength == only && j.words == words &&
                       j.diffuse_fraction == data.diffuse_fraction && j.viewing == data.viewing &&
                       is_same(j.sky, data.sky);
            });
            if (job == jobs.end()) {
                jobs.push_back(
                    {.words = words,
                     .names = unknowns_in(problem, words),
                     .kind = kind,
                     .diffuse_fraction = data.diffuse_fraction,
                     .sky = data.sky,
                     .viewing = data.viewing,
                     .only_wavelength = only,
                     .wavelength_nm = kind == Kind::lab ? lab_wavelengths() : std::vector<double>{},
                     .uses = {}});
                job = jobs.end() - 1;
            }
            Job::Use use{.quantity = value.quantity, .geometry = value.geometry};
            if (data.spheres && value.geometry != MeasuredGeometry::unscattered)
                use.of_spheres = &data;
            if (kind != Kind::lab)
                use.wavelength = place_in(job->wavelength_nm, value.wavelength_nm);
            if (!is_of_all_sides(value)) use.in = place_in(job->directions.mu_in, value.mu_in);
            if (kind == Kind::brdf || kind == Kind::hdrf) {
                use.out = place_in(job->directions.mu_out, value.mu_out);
                use.azimuth = place_in(job->directions.azimuth_deg, azimuth_of(value));
            }
            reading.value = values++;
            reading.use = job->uses.size();
            reading.wavelength_nm = value.wavelength_nm;
            job->readings.push_back(reading);
            job->uses.push_back(use);
        }
    }
    for (Job& job : jobs) {
        if (job.directions.mu_in.empty()) job.directions.mu_in = {1.0};  // albedos want one
        const bool has_sky = job.kind == Kind::hdrf && job.sky.kind != Sky::Kind::uniform;
        if (job.kind == Kind::brdf || (job.kind == Kind::hdrf && !has_sky)) scatter(job);
        const bool loses = std::any_of(job.uses.begin(), job.uses.end(), [](const Job::Use& use) {
            return use.of_spheres != nullptr && use.of_spheres->spheres->lost_light;
        });
        if (!loses) interpolate_spectra(job);
    }
    return jobs;
}

}  // namespace miebrdf::fitting
