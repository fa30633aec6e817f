// The source of exports and pictures: a spectral BRDF that can be asked at any directions. A solved
// scene gives one (BrdfTable); a material of one's own is another.
#pragma once

#include <miebrdf/control.h>
#include <miebrdf/language.h>

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf {

/// One pair of directions: cosines in (0, 1] (up to 1 + 1e-6 counts as 1: unit vectors in single
/// precision), azimuth_deg 0 = mirror side, any finite number.
struct Direction {
    double mu_in = 1.0;        ///< of the light
    double mu_out = 1.0;       ///< of the viewer
    double azimuth_deg = 0.0;  ///< degrees
};

/// The origin of the numbers, which every export states.
struct Provenance {
    std::string version = {};         ///< "miebrdf 1.0.0"
    std::string command_line = {};    ///< as typed; may be empty
    std::string title = {};           ///< the scene in one line
    std::string component = "total";  ///< total, subsurface or surface
    std::string accuracy = {};        ///< of the values, in words; may be empty
    std::string polarisation = {};    ///< what was computed or left out; empty: it does not matter
    std::vector<std::string> sources = {};  ///< of the refractive indices, one line for each
    /// The light that is in no value because it goes into one direction alone (mirror reflections,
    /// deltas), and how to add it; empty: there is none.
    std::string left_out = {};
    double mirror_index = 0.0;  ///< of the host below a smooth boundary; 0: there is none
};

/// Three weights of each channel: what a colour is made of.
using ColourWeights = std::vector<std::array<double, 3>>;

/// Weighted sums of the channels of a source, for instance colours.
class ChannelMix {
  public:
    virtual ~ChannelMix() = default;
    /// values[3 * d + c] for direction d.
    /// @throws UsageError  for directions out of range and too few values
    virtual void evaluate(std::span<const Direction> directions,
                          std::span<double> values) const = 0;
};

/// A spectral BRDF, 1/sr without the cosine, isotropic about the normal. Const functions may be
/// called from several threads.
class BrdfSource {
  public:
    virtual ~BrdfSource() = default;

    /// One name for each channel: "550 nm", or "R", "G", "B".
    virtual const std::vector<std::string>& channels() const = 0;
    /// The wavelength of each channel; empty when the channels are colours.
    virtual const std::vector<double>& wavelength_nm() const = 0;
    virtual const Provenance& provenance() const = 0;  ///< for the files made of it

    /// values[d * channels().size() + c] for direction d. Directions in sequence that share
    /// (mu_in, mu_out) may be evaluated faster.
    /// @throws UsageError  for directions out of range and too few values
    virtual void evaluate(std::span<const Direction> directions,
                          std::span<double> values) const = 0;

    /// Components of light that its Mueller matrix is known for: 3 (I, Q, U), 4 (with V); 1: the
    /// BRDF is all that is known.
    virtual int components() const { return 1; }

    /// Mueller matrices, 1/sr without the cosine, with the planes and signs of
    /// docs/polarisation.md: values[((d * channels().size() + c) * components() + row) *
    /// components() + column], row = outgoing, column = incident component; element 11 is the BRDF.
    virtual void evaluate_mueller(std::span<const Direction> directions,
                                  std::span<double> values) const {
        evaluate(directions, values);
    }

    /// Sums over channels: of many channels a source may know them without evaluating each.
    /// The result must not outlive the source.
    /// @throws UsageError  when there is not one weight for each channel
    virtual std::unique_ptr<ChannelMix> mix(const ColourWeights& weights) const;
};

/// How many directions, from the first on, share its cosines; at least one where there is any.
std::size_t count_sharing_cosines(std::span<const Direction> directions);

/// Checks what every source asks of its arguments.
/// @param storage  takes the directions where cosines count as 1
/// @return the directions to evaluate
/// @throws UsageError  naming the first cosine or azimuth that is out of range, or the number of
///         values where there are too few
std::span<const Direction> require_valid(std::span<const Direction> directions, std::size_t values,
                                         std::size_t values_of_direction,
                                         std::vector<Direction>& storage);

/// @throws UsageError  when there is not one for each channel
void require_weights(const BrdfSource& source, const ColourWeights& weights);

/// "550 nm" for each wavelength, in the shortest form that reads back to the same double.
std::vector<std::string> channel_names(const std::vector<double>& wavelength_nm);

/// Evaluates in parallel; the result does not depend on the number of threads.
/// @throws Cancelled
std::vector<double> evaluate_all(const BrdfSource& source, std::span<const Direction> directions,
                                 const std::string& stage, const Control& control);

/// @throws UsageError  when the source has colours instead of wavelengths
void require_wavelengths(const BrdfSource& source, const std::string& format);

}  // namespace miebrdf
#pragma GCC visibility pop
