// BrdfTable: a scene solved at all its wavelengths for many directions.
#include <algorithm>

#include "pipeline/solve/solved_table.h"

namespace miebrdf {
namespace {

/// Smooth parts are mixed once; sharp ones whose wavelengths have no weight are left out.
class SolvedMix : public ChannelMix {
  public:
    SolvedMix(const SolvedTable& table, const ColourWeights& weights) : table_(table) {
        if (table.exact) exact_ = table.exact->mix(weights);
        for (std::size_t w = 0; w < table.wavelengths.size(); ++w) {
            for (std::size_t c = 0; c < 3; ++c) {
                if (weights[w][c] != 0.0)
                    smooth_[c].add(table.wavelengths[w].smooth(), weights[w][c]);
            }
        }
        auto next = weights.begin();
        for (const SharpPart& part : table.sharp) {
            const auto last = next + static_cast<std::ptrdiff_t>(part.wavelengths());
            const ColourWeights own(next, last);
            next = last;
            const bool counts = std::any_of(own.begin(), own.end(), [](const auto& weight) {
                return weight != std::array{0.0, 0.0, 0.0};
            });
            if (counts && !part.is_empty()) parts_.push_back({&part, own});
        }
    }

    void evaluate(std::span<const Direction> asked, std::span<double> values) const override {
        std::vector<Direction> storage;
        const auto directions = require_valid(asked, values.size(), 3, storage);
        std::fill(values.begin(), values.end(), 0.0);
        EvaluationScratch scratch;
        std::vector<double>& sharp = scratch.sharp;
        for (std::size_t first = 0, count = 0; first < directions.size(); first += count) {
            const auto rest = directions.subspan(first);
            count = count_sharing_cosines(rest);
            double* const target = values.data() + 3 * first;
            if (table_.instead(rest.front().mu_in) != nullptr) {
                exact_->evaluate(rest.first(count), {target, 3 * count});
                continue;
            }
            set_cosines(rest.first(count), scratch);
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
    const SolvedTable& table_;
    std::unique_ptr<ChannelMix> exact_;
    std::vector<Part> parts_;
    std::array<SmoothPart, 3> smooth_;
};

}  // namespace

const std::vector<std::string>& BrdfTable::channels() const { return solved_->channels; }
const std::vector<double>& BrdfTable::wavelength_nm() const { return solved_->scene.wavelength_nm; }
const Provenance& BrdfTable::provenance() const { return solved_->provenance; }
const ResultReport& BrdfTable::report() const { return solved_->report; }

void BrdfTable::evaluate(std::span<const Direction> asked, std::span<double> values) const {
    const std::size_t stride = solved_->wavelengths.size();
    std::vector<Direction> storage;
    const auto directions = require_valid(asked, values.size(), stride, storage);
    EvaluationScratch scratch;
    std::vector<double>& sharp = scratch.sharp;
    for (std::size_t first = 0, count = 0; first < directions.size(); first += count) {
        const auto rest = directions.subspan(first);
        count = count_sharing_cosines(rest);
        double* target = values.data() + first * stride;
        if (const BrdfTable* exact = solved_->instead(rest.front().mu_in)) {
            exact->evaluate(rest.first(count), {target, stride * count});
            continue;
        }
        set_cosines(rest.first(count), scratch);
        for (const SharpPart& part : solved_->sharp) {
            const std::size_t wavelengths = part.wavelengths();
            sharp.resize(count * wavelengths);
            part.evaluate(rest.first(count), sharp, scratch);
            for (std::size_t i = 0; i < sharp.size(); ++i)
                target[i / wavelengths * stride + i % wavelengths] = sharp[i];
            target += wavelengths;
        }
        const SmoothSum smooth(rest.front());
        for (std::size_t w = 0; w < stride; ++w)
            smooth.add(solved_->wavelengths[w].smooth(), values.data() + first * stride + w, stride,
                       scratch);
    }
}

int BrdfTable::components() const { return solved_->components; }

void BrdfTable::evaluate_mueller(std::span<const Direction> asked, std::span<double> values) const {
    if (solved_->components == 1) {
        evaluate(asked, values);
        return;
    }
    if (solved_->exact) return solved_->exact->evaluate_mueller(asked, values);
    const std::size_t channels = solved_->wavelengths.size();
    const auto elements = static_cast<std::size_t>(solved_->components * solved_->components);
    std::vector<Direction> storage;
    const auto directions = require_valid(asked, values.size(), channels * elements, storage);
    EvaluationScratch scratch;
    std::vector<double> once, of_channel;
    for (std::size_t first = 0, count = 0; first < directions.size(); first += count) {
        count = count_sharing_cosines(directions.subspan(first));
        const auto some = directions.subspan(first, count);
        set_cosines(some, scratch);
        std::size_t channel = 0;
        for (const SharpPart& part : solved_->sharp) {
            const std::size_t wavelengths = part.wavelengths();
            once.resize(count * wavelengths);
            part.evaluate(some, once, scratch);
            for (std::size_t w = 0; w < wavelengths; ++w, ++channel) {
                of_channel.clear();
                for (std::size_t d = 0; d < count; ++d)
                    of_channel.push_back(once[d * wavelengths + w]);
                double* const target = values.data() + (first * channels + channel) * elements;
                const SolvedWavelength& at = solved_->wavelengths[channel];
                if (at.mueller() != nullptr) {
                    at.mueller()->evaluate(part.first_order().at_wavelength(w), some, of_channel,
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
    require_weights(*this, weights);
    return std::make_unique<SolvedMix>(*solved_, weights);
}

}  // namespace miebrdf
