// A spectral BRDF seen as three colours: each a fixed linear combination of the wavelengths.
#pragma once

#include <miebrdf/brdf_source.h>

namespace miebrdf {

/// rgb[c] = sum_w weight[w][c] f(wavelength w). A conversion from CIE colour matching functions,
/// illuminant and primaries is of this form; so are three single wavelengths.
struct RgbWeights {
    ColourWeights weight;     ///< one for each wavelength of the source
    std::string description;  ///< primaries, illuminant and observer, for the file's metadata
};

/// The three single wavelengths nearest to those of Chen et al. 2013, Table 1 (620, 535, 480 nm,
/// docs/conventions.md): no colorimetry, each channel is the reflectance at its wavelength.
RgbWeights nearest_wavelengths(const std::vector<double>& wavelength_nm);

/// Colours of RGB formats. `cie`: linear sRGB of the CIE 1931 observer under D65.
/// `wavelengths`: nearest_wavelengths. `auto`: cie where they cover the visible, else wavelengths.
/// @throws UsageError  for another word, or cie with wavelengths that do not ascend
RgbWeights rgb_weights(const std::string& mode, const std::vector<double>& wavelength_nm);

class RgbSource : public BrdfSource {
  public:
    /// @param source  must outlive this
    /// @throws UsageError  when the weights do not fit the source's wavelengths
    RgbSource(const BrdfSource& source, RgbWeights weights);

    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return no_wavelengths_; }
    const Provenance& provenance() const override { return source_.provenance(); }
    void evaluate(std::span<const Direction> directions, std::span<double> values) const override;

    const RgbWeights& weights() const { return weights_; }

  private:
    const BrdfSource& source_;
    RgbWeights weights_;
    std::unique_ptr<ChannelMix> mix_;
    std::vector<std::string> channels_ = {"R", "G", "B"};
    std::vector<double> no_wavelengths_;
};

}  // namespace miebrdf
