// A source whose values are numbers: what is not would go on into files without a word.
#pragma once

#include <miebrdf/brdf_source.h>

namespace miebrdf {

/// @throws InputError  with the first direction whose value is not finite
/// @param each  values of a direction
void require_finite(std::span<const Direction> directions, std::span<const double> values,
                    std::size_t each);

/// Another source, whose values are looked at. It must outlive this.
class FiniteSource : public BrdfSource {
  public:
    explicit FiniteSource(const BrdfSource& source) : source_(source) {}

    const std::vector<std::string>& channels() const override { return source_.channels(); }
    const std::vector<double>& wavelength_nm() const override { return source_.wavelength_nm(); }
    const Provenance& provenance() const override { return source_.provenance(); }
    int components() const override { return source_.components(); }
    void evaluate(std::span<const Direction> directions, std::span<double> values) const override;
    void evaluate_mueller(std::span<const Direction> directions,
                          std::span<double> values) const override;
    std::unique_ptr<ChannelMix> mix(const ColourWeights& weights) const override {
        return source_.mix(weights);
    }

  private:
    const BrdfSource& source_;
};

}  // namespace miebrdf
