// BrdfTable: a scene solved at all its wavelengths for many directions.
#include <fmt/format.h>
#include <miebrdf/version.h>

#include <algorithm>

#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/wavelength_table.h"

namespace miebrdf {
namespace {

/// Smooth parts are mixed once; sharp ones whose wavelengths have no weight are left out.
class SolvedMix : public ChannelMix {
  public:
    SolvedMix(const std::vector<WavelengthTable>& tables, const std::vector<SharpPart>& sharp,
              const ColourWeights& weights) {
        for (std::size_t w = 0; w < tables.size(); ++w) {
            for (std::size_t c = 0; c < 3; ++c) {
                if (weights[w][c] != 0.0) smooth_[c].add(tables[w].smooth(), weights[w][c]);
            }
        }
        auto next = weights.begin();
        for (const SharpPart& part : sharp) {
            const auto last = next + static_cast<std::ptrdiff_t>(part.wavelengths());
            const ColourWeights own(next, last);
            next = last;
            const bool counts = std::any_of(own.begin(), own.end(), [](const auto& weight) {
                return weight != std::array{0.0, 0.0, 0.0};
            });
            if (counts) parts_.push_back({&part, own});
        }
    }

    void evaluate(std::span<const Direction> directions, std::span<double> values) const override {
        std::fill(values.begin(), values.end(), 0.0);
        EvaluationScratch scratch;
        std::vector<double>& sharp = scratch.sharp;
        for (std::size_t first = 0, count = 0; first < directions.size(); first += count) {
            const auto rest = directions.subspan(first);
            count = count_sharing_cosines(rest);
            set_cosines(rest.first(count), scratch);
            double* const target = values.data() + 3 * first;
            const SmoothSum smooth(rest.front());
            for (std::size_t c = 0; c < 3; ++c) smooth.add(smooth_[c], target + c, 3, scratch);
            for (const Part& part : parts_) {
                const std::size_t wavelengths = part.weight.size();
                sharp.resize(count * wavelengths);
                part.sharp->evaluate(rest.first(count), sharp, scratch);
                for (std::size_t i = 0; i < sharp.size(); ++i) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        target[i / wavelengths * 3 + c] +=
                            part.weight[i % wavelengths][c] * sharp[i];
                    }
                }
            }
        }
    }

  private:
    struct Part {
        const SharpPart* sharp;
        ColourWeights weight;
    };
    std::vector<Part> parts_;
    std::array<SmoothPart, 3> smooth_;
};

/// Solves every wavelength, in parallel.
std::vector<WavelengthTable> solve_wavelengths(const BrdfTable::State& state,
                                               const Control& control) {
    const ResolvedScene& scene = state.scene;
    const std::size_t count = scene.wavelength_nm.size();
    std::vector<SceneOptics> optics(count);
    std::vector<LightChoice> light(count);
    if (state.part != BrdfPart::surface) {
        const auto demand = demand_of(state.solver, scene.particles.tolerance, PhaseDemand::whole);
        const LayerRequest request{scene, probe_directions(), state.solver};
        const std::vector<std::size_t> all = all_wavelengths(scene);
        const double hiding = state.solver.tolerance;
        light = choose_light(request, all, hiding, demand, control);
        optics = optics_in(light, request, all, hiding, demand, control);
    }
    std::vector<std::optional<WavelengthTable>> solved(count);
    run_parallel("radiative transfer", count, control, [&](std::size_t w) {
        solved[w].emplace(scene, w, optics[w], state.solver, state.part, light[w],
                          state.components > 1);
    });
    std::vector<WavelengthTable> tables;
    tables.reserve(solved.size());
    for (auto& table : solved) tables.push_back(std::move(*table));
    return tables;
}

/// The first order of all wavelengths, some at a time, in parallel.
std::vector<SharpPart> make_sharp_parts(const BrdfTable::State& state, const Control& control) {
    constexpr std::size_t kMost = SharpPart::kMostWavelengths;
    const std::span<const WavelengthTable> tables = state.tables;
    std::vector<std::optional<SharpPart>> made((tables.size() + kMost - 1) / kMost);
    run_parallel("first order", made.size(), control, [&](std::size_t p) {
        const std::size_t first = p * kMost, count = std::min(kMost, tables.size() - first);
        made[p].emplace(tables.subspan(first, count), state.solver);
    });
    std::vector<SharpPart> parts;
    parts.reserve(made.size());
    for (auto& part : made) parts.push_back(std::move(*part));
    return parts;
}

}  // namespace

std::shared_ptr<const BrdfTable::State> make_table(const ResolvedScene& scene,
                                                   const std::string& title,
                                                   const SolverOptions& solver,
                                                   const TableOptions& options,
                                                   const Control& control) {
    auto state = std::make_shared<BrdfTable::State>();
    state->scene = scene;
    state->solver = solver;
    state->part = options.part;
    state->components = options.part == BrdfPart::surface ? 1 : std::max(1, solver.stokes);
    state->channels = channel_names(scene.wavelength_nm);
    state->tables = solve_wavelengths(*state, control);
    state->report.tolerance = solver.tolerance;
    state->report.sources = scene.sources;
    state->report.notes = scene.notes;
    for (const WavelengthTable& table : state->tables)
        state->report.wavelengths.push_back(table.report());
    state->provenance = {std::string("miebrdf ") + kVersion,
                         options.command_line,
                         title,
                         name_of(options.part),
                         state->report.summary(),
                         fmt::format("{}", fmt::join(state->report.polarisation(), "; ")),
                         scene.sources};
    state->sharp = make_sharp_parts(*state, control);
    return state;
}

const std::vector<std::string>& BrdfTable::channels() const { return state_->channels; }
const std::vector<double>& BrdfTable::wavelength_nm() const { return state_->scene.wavelength_nm; }
const Provenance& BrdfTable::provenance() const { return state_->provenance; }
const ResultReport& BrdfTable::report() const { return state_->report; }

void BrdfTable::evaluate(std::span<const Direction> directions, std::span<double> values) const {
    const std::size_t stride = state_->tables.size();
    EvaluationScratch scratch;
    std::vector<double>& sharp = scratch.sharp;
    for (std::size_t first = 0, count = 0; first < directions.size(); first += count) {
        const auto rest = directions.subspan(first);
        count = count_sharing_cosines(rest);
        set_cosines(rest.first(count), scratch);
        double* target = values.data() + first * stride;
        for (const SharpPart& part : state_->sharp) {
            const std::size_t wavelengths = part.wavelengths();
            sharp.resize(count * wavelengths);
            part.evaluate(rest.first(count), sharp, scratch);
            for (std::size_t i = 0; i < sharp.size(); ++i)
                target[i / wavelengths * stride + i % wavelengths] = sharp[i];
            target += wavelengths;
        }
        const SmoothSum smooth(rest.front());
        for (std::size_t w = 0; w < stride; ++w)
            smooth.add(state_->tables[w].smooth(), values.data() + first * stride + w, stride,
                       scratch);
    }
}

int BrdfTable::components() const { return state_->components; }

void BrdfTable::evaluate_mueller(std::span<const Direction> directions,
                                 std::span<double> values) const {
    if (state_->components == 1) {
        evaluate(directions, values);
        return;
    }
    const std::size_t channels = state_->tables.size();
    const auto elements = static_cast<std::size_t>(state_->components * state_->components);
    EvaluationScratch scratch;
    std::vector<double> once, of_channel;
    for (std::size_t first = 0, count = 0; first < directions.size(); first += count) {
        count = count_sharing_cosines(directions.subspan(first));
        const auto some = directions.subspan(first, count);
        set_cosines(some, scratch);
        std::size_t channel = 0;
        for (const SharpPart& part : state_->sharp) {
            const std::size_t wavelengths = part.wavelengths();
            once.resize(count * wavelengths);
            part.evaluate(some, once, scratch);
            for (std::size_t w = 0; w < wavelengths; ++w, ++channel) {
                of_channel.clear();
                for (std::size_t d = 0; d < count; ++d)
                    of_channel.push_back(once[d * wavelengths + w]);
                double* const target = values.data() + (first * channels + channel) * elements;
                const WavelengthTable& table = state_->tables[channel];
                if (table.mueller() != nullptr) {
                    table.mueller()->evaluate(table.stack(), table.seen_once(), some, of_channel,
                                              target, channels * elements);
                } else {  // black
                    for (std::size_t d = 0; d < count; ++d)
                        std::fill_n(target + d * channels * elements, elements, 0.0);
                }
            }
        }
    }
}

std::unique_ptr<ChannelMix> BrdfTable::mix(const ColourWeights& weights) const {
    return std::make_unique<SolvedMix>(state_->tables, state_->sharp, weights);
}

}  // namespace miebrdf
