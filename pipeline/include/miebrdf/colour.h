// From spectral reflectance to colour: the CIE's eye and lamps (1931 2-degree standard colorimetric
// observer; illuminants D65, E and A), XYZ, Lab and sRGB.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf {

inline constexpr double kObserverShortest_nm = 360.0;
inline constexpr double kObserverLongest_nm = 830.0;

struct ColourMatching {
    double x, y, z;
};

/// The colour-matching functions of the CIE 1931 2-degree observer (ISO/CIE 11664-1).
///
/// Tabulated at 5 nm, cubic between (Lagrange through the four nearest rows, as CIE 15:2004,
/// section 7.2.1, recommends for interpolation of tables). Sums of the 5 nm rows from 380 to 780 nm
/// are the published 21.3715, 21.3713, 21.3715. Zero outside 360 to 830 nm.
ColourMatching colour_matching(double wavelength_nm);

enum class Illuminant {
    d65,  ///< daylight, S0 + M1 S1 + M2 S2 (CIE 15:2004, tables T.2; linear between 10 nm rows)
    e,    ///< equal energy
    a,    ///< tungsten, Planck at 2848 K with c2 = 1.435e-2 m K (ISO 11664-2, eq. 1)
};

/// Relative spectral power, 100 at 560 nm.
/// @throws std::invalid_argument  outside 360 to 830 nm
double relative_power(Illuminant illuminant, double wavelength_nm);

/// Tristimulus values; a reflectance of 1 everywhere has y = 1.
struct Xyz {
    double x = 0.0, y = 0.0, z = 0.0;
};

/// CIE 1976 L*a*b* (ISO/CIE 11664-4): white is (100, 0, 0).
struct Lab {
    double l = 0.0, a = 0.0, b = 0.0;
};

/// Linear light in the primaries of sRGB (IEC 61966-2-1). Colours outside its gamut have
/// components below 0 or above 1; nothing is clipped here.
struct LinearSrgb {
    double red = 0.0, green = 0.0, blue = 0.0;
};

/// Whether a colour can be told from these wavelengths: eight or more, in ascending order, from
/// 430 nm or less to 650 nm or more.
bool covers_the_visible(const std::vector<double>& wavelength_nm);

/// What a value at each wavelength contributes to X, Y and Z.
struct ObserverWeights {
    std::vector<double> x, y, z;
};

/// Weights for a reflectance known at these wavelengths: linear between them and constant beyond
/// the first and last, integrated at 1 nm from 360 to 830 nm. Each of x, y, z sums to the white of
/// the illuminant, so one wavelength alone stands for a grey.
/// @param wavelength_nm  ascending, at least one
/// @throws std::invalid_argument  for an empty list or one that does not ascend
ObserverWeights observer_weights(const std::vector<double>& wavelength_nm,
                                 Illuminant illuminant = Illuminant::d65);

/// @param reflectance  one value for each weight, e.g. pi times a BRDF, or an albedo
/// @throws std::invalid_argument  when the lengths differ
Xyz to_xyz(const ObserverWeights& weights, const std::vector<double>& reflectance);

/// Of a reflectance of 1: the chromaticity of the illuminant.
Xyz white_point(Illuminant illuminant);

/// Relative to the white of the illuminant, without adaptation.
Lab to_lab(const Xyz& xyz, Illuminant illuminant = Illuminant::d65);

/// Seen by an eye adapted to the illuminant (Bradford, to the white of sRGB): a reflectance of 1 is
/// (1, 1, 1) under each of them.
LinearSrgb to_linear_srgb(const Xyz& xyz, Illuminant illuminant = Illuminant::d65);

/// The transfer function of IEC 61966-2-1, [0, 1] to [0, 1]; odd beyond 0, continued above 1.
double encode_srgb(double linear);

/// Encoded, clipped to [0, 1], rounded to 0 ... 255.
std::array<std::uint8_t, 3> to_srgb8(const LinearSrgb& colour);

}  // namespace miebrdf
#pragma GCC visibility pop
