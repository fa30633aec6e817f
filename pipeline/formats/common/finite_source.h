// A source whose values are numbers: what is not would go on into files without a word.
#pragma once

#include <miebrdf/brdf_source.h>

namespace miebrdf {

/// @throws InputError  with the first direction whose value is not finite
/// @param each  values of a direction
void require_finite(std::span<const Direction> directions, std::span<const double> values,
                    std::size_t each);

/// Another source, whose values are looked at. It must outlive this.
/// Values throw InputError with the first direction where one is not finite, or where a BRDF is
/// negative: of spectra alone, since colours out of gamut are, and not of solved tables, which may
/// be by their error.
class FiniteSource : public BrdfSource {
  public:
    explicit FiniteSource(const BrdfSource& source);

    const std::vector<std::string>& channels() const override { return source_.channels(); }
    const std::vector<double>& wavelength_nm() const override { return source_.wavelength_nm(); }
    const Provenance& provenance() const override { return source_.provenance(); }
    int components() const override { return source_.components(); }
    void evaluate(std::span<const Direction> directions, std::span<double> values) const override;
    void evaluate_mueller(std::span<const Direction> directions,
                          std::span<double> values) const override;
    std::unique_ptr<ChannelMix> mix(const ColourWeights& weights) const override;

  private:
    /// @param elements  of the Mueller matrix, for each direction and channel; the first is the
    /// BRDF
    void require(std::span<const Direction> directions, std::span<const double> values,
                 std::size_t elements) const;

    const BrdfSource& source_;
    bool is_solved_, may_be_negative_;
};

}  // namespace miebrdf
