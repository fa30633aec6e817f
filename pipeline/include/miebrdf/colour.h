// From spectral reflectance to colour: the CIE's eyes and lamps (1931 2-degree and 1964 10-degree
// standard colorimetric observers; illuminants D65, D50, E and A), XYZ, Lab, LCh, sRGB and the
// differences between colours.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <miebrdf/brdf.h>

#pragma GCC visibility push(default)
namespace miebrdf {

inline constexpr double kObserverShortest_nm = 360.0;
inline constexpr double kObserverLongest_nm = 830.0;

/// Colour-matching functions at one wavelength.
struct ColourMatching {
    double x, y, z;  ///< dimensionless
};

enum class Observer {
    two_degrees,  ///< CIE 1931, fields of 1 to 4 degrees
    ten_degrees,  ///< CIE 1964, larger fields
};

/// The colour-matching functions of a standard observer (ISO/CIE 11664-1).
///
/// Tabulated at 5 nm, cubic between (Lagrange through the four nearest rows, as CIE 15:2004,
/// section 7.2.1, recommends for interpolation of tables). Sums of the 5 nm rows from 380 to 780 nm
/// are the published 21.3715, 21.3713, 21.3715 (2 degrees) and 23.3294, 23.3320, 23.3342
/// (10 degrees). Zero outside 360 to 830 nm.
ColourMatching colour_matching(double wavelength_nm, Observer observer = Observer::two_degrees);

enum class Illuminant {
    d65,  ///< daylight, S0 + M1 S1 + M2 S2 (CIE 15:2004, tables T.2; linear between 10 nm rows)
    e,    ///< equal energy
    a,    ///< tungsten, Planck at 2848 K with c2 = 1.435e-2 m K (ISO 11664-2, eq. 1)
    d50,  ///< daylight at sunrise and of the printing trade, likewise
};

/// Relative spectral power, 100 at 560 nm.
/// @throws UsageError  outside 360 to 830 nm
double relative_power(Illuminant illuminant, double wavelength_nm);

/// Under which light and by which eye a colour is seen.
struct Viewing {
    Illuminant illuminant = Illuminant::d65;    ///< light
    Observer observer = Observer::two_degrees;  ///< eye

    Viewing(Illuminant light = Illuminant::d65, Observer eye = Observer::two_degrees)
        : illuminant(light), observer(eye) {}
    bool operator==(const Viewing&) const = default;
};

/// Reads `d65`, `d50`, `a` or `e`, then perhaps `,2` or `,10`, the observer's degrees (2).
/// @throws UsageError
Viewing viewing(const std::string& text);
/// "D65, CIE 1964 10-degree observer"
std::string describe(const Viewing& viewing);

/// Tristimulus values; a reflectance of 1 everywhere has y = 1.
struct Xyz {
    double x = 0.0, y = 0.0, z = 0.0;  ///< Y = 1: white
};

/// CIE 1976 L*a*b* (ISO/CIE 11664-4): white is (100, 0, 0).
struct Lab {
    double l = 0.0, a = 0.0, b = 0.0;  ///< L* in 0 to 100
};

/// Lab in polar form: chroma and hue angle, in [0, 360) degrees.
struct Lch {
    double l = 0.0, c = 0.0, h_deg = 0.0;  ///< h in [0, 360)
};

/// Linear light in the primaries of sRGB (IEC 61966-2-1). Colours outside its gamut have
/// components below 0 or above 1; nothing is clipped here.
struct LinearSrgb {
    double red = 0.0, green = 0.0, blue = 0.0;  ///< in [0, 1] if displayable
};

/// Whether a colour can be told from these wavelengths: eight or more, in ascending order, from
/// 430 nm or less to 650 nm or more.
bool covers_the_visible(const std::vector<double>& wavelength_nm);

/// The weight of each wavelength's value in X, Y and Z.
struct ObserverWeights {
    std::vector<double> x, y, z;  ///< dimensionless
};

/// The course of a reflectance between its wavelengths.
enum class Between {
    linear,  ///< weights are never negative
    /// Lagrange through the four nearest wavelengths (CIE 15:2004, section 7.2.1); linear where
    /// there are none on one side, or where their distances differ by more than a factor of three.
    cubic,
};

/// Weights for a reflectance known at these wavelengths: interpolated between them and constant
/// beyond the first and last, integrated at 1 nm from 360 to 830 nm. Each of x, y, z sums to the
/// white of the illuminant, so one wavelength alone stands for a grey.
/// @param wavelength_nm  ascending, at least one
/// @throws UsageError  for an empty list or one that does not ascend
ObserverWeights observer_weights(const std::vector<double>& wavelength_nm,
                                 const Viewing& viewing = {}, Between between = Between::linear);

/// @param reflectance  one value for each weight, e.g. pi times a BRDF, or an albedo
/// @throws UsageError  when the lengths differ
Xyz to_xyz(const ObserverWeights& weights, const std::vector<double>& reflectance);

/// The colour of a reflectance of 1: the chromaticity of the illuminant.
Xyz white_point(const Viewing& viewing);

/// Relative to the white of the illuminant, without adaptation.
Lab to_lab(const Xyz& xyz, const Viewing& viewing = {});

Lch to_lch(const Lab& lab);  ///< hue 0 where there is no chroma

/// CIE 1976: the distance in Lab.
double delta_e_76(const Lab& a, const Lab& b);

/// CIEDE2000 with kL = kC = kH = 1 (ISO/CIE 11664-6), as Sharma, Wu & Dalal, Color Res. Appl. 30,
/// 21 (2005), spell it out.
double delta_e_2000(const Lab& a, const Lab& b);
/// Three differences whose root sum of squares it is, smooth where the colours meet: lightness, and
/// chroma and hue with their rotation.
std::array<double, 3> delta_e_2000_parts(const Lab& a, const Lab& b);

/// Seen by an eye adapted to the illuminant (Bradford, to the white of sRGB): a reflectance of 1 is
/// (1, 1, 1) under each of them.
LinearSrgb to_linear_srgb(const Xyz& xyz, const Viewing& viewing = {});
/// Likewise linear red, green, blue of ACEScg (SMPTE ST 2065-1, primaries AP1), for renderers.
std::array<double, 3> to_acescg(const Xyz& xyz, const Viewing& viewing = {});

/// The transfer function of IEC 61966-2-1, [0, 1] to [0, 1]; odd beyond 0, continued above 1.
double encode_srgb(double linear);

/// Encoded, clipped to [0, 1], rounded to 0 ... 255; NaN is 0.
std::array<std::uint8_t, 3> to_srgb8(const LinearSrgb& colour);

/// The colour of a reflectance.
struct Colour {
    Xyz xyz;          ///< Y = 1: white
    Lab lab;          ///< CIE 1976
    Lch lch;          ///< of lab
    LinearSrgb srgb;  ///< linear
    /// delta_e_76 to the colour from every other wavelength. What the wavelengths in between leave
    /// is less, as long as the spectrum has no features narrower than two of their steps.
    double error_estimate = 0.0;
};

/// Colours of many reflectances at the same wavelengths, cubic between them.
class Colorimeter {
  public:
    /// @param wavelength_nm  ascending, at least three
    /// @throws UsageError  for fewer, or for a list that does not ascend
    explicit Colorimeter(const std::vector<double>& wavelength_nm, const Viewing& viewing = {});

    /// @param reflectance  one value for each wavelength
    /// @throws UsageError  when the lengths differ
    Colour operator()(const std::vector<double>& reflectance) const;

    const Viewing& viewing() const { return viewing_; }  ///< light and observer

  private:
    Viewing viewing_;
    std::vector<std::size_t> every_other_;  ///< with the first and the last
    ObserverWeights weights_, coarse_weights_;
};

// ---------------------------------------------------------------- Drawdowns
// A film over a dark and a light ground, as paint is judged.

/// The charts of ASTM D2805 have at most .01 on black and at least .78 on white; its calculations
/// take .80.
inline constexpr double kWhiteChartAlbedo = 0.8;

/// The two grounds of a drawdown, and the light.
struct DrawdownOptions {
    Substrate dark = {.kind = Substrate::Kind::black};  ///< below the film
    Substrate light = {.kind = Substrate::Kind::lambertian, .albedo = {kWhiteChartAlbedo}};
    /// That counts as complete hiding (ASTM D2805), in (0, 1); 0: no depth is searched.
    double hiding_contrast_ratio = 0.98;
    Viewing viewing = {};  ///< Y is of this illuminant and observer
};

/// How well the film hides the grounds, in one light.
struct Hiding {
    double y_over_dark = 0.0, y_over_light = 0.0;  ///< CIE Y, 1 of a white
    double contrast_ratio = 0.0;  ///< Y over the dark ground / Y over the light one
    /// Depth of all layers, as a multiple of the scene's, that hides completely; empty: none
    /// between 1e-4 and 1e4.
    std::optional<double> relative_depth;
    /// That depth in um where the scene's layers are thicknesses, and the area that one litre of
    /// dry film covers at it, m2.
    std::optional<double> thickness_um, spreading_rate_m2_per_l;  ///< nothing: it never hides
};

/// A film over two grounds.
struct Drawdown {
    AlbedoValues over_dark, over_light;  ///< albedos, 1 = all
    std::vector<Hiding> hiding;          ///< of light incident at each mu_in, then of uniform light
};

/// Solves a film over both grounds and finds the depth at which it hides them. Single scattering is
/// computed once for all of it; each depth that the search tries costs two albedos of radiative
/// transfer (about ten depths).
///
/// @param scene  its base and substrate do not matter; layers of finite depth
/// @param wavelength_nm  ascending, fit for colours (covers_the_visible)
/// @throws UsageError  as solve() and Brdf::albedo(); for wavelengths that no Y can be told from, a
///         light ground that is not lighter than the dark one, layers that are all of depth 0
Drawdown draw_down(const Scene& scene, const std::vector<double>& wavelength_nm,
                   const std::vector<double>& mu_in, const DrawdownOptions& options = {},
                   const SolverOptions& solver = {}, const Control& control = {});

// -------------------------------------------------------------------- Gloss

/// Specular gloss at one angle.
struct Gloss {
    double angle_deg = 0.0;    ///< of incidence and of the receptor: 20, 60 or 85
    double reflectance = 0.0;  ///< luminous flux in the receptor over that incident, [0, 1]
    double units = 0.0;        ///< 100: polished black glass of index 1.567
};

/// Gloss at the three angles of ISO 2813 and ASTM D523, with what its values say about themselves.
struct GlossValues : public ResultReport {
    std::vector<Gloss> angles;  ///< 20, 60, 85 degrees
};

/// The gloss that a glossmeter reads (ISO 2813:2014, ASTM D523): the flux in a receptor of 1.8 x
/// 3.6, 4.4 x 11.7, 4.0 x 6.0 degrees (in the plane of incidence x across it) at 20, 60, 85
/// degrees, of a source of 0.75 x 2.5 degrees, relative to polished black glass, whose reflectance
/// is Fresnel's (.04908, .10006, .61915). Mirror reflection of a smooth boundary is in it as a
/// whole; what is spread over angles is integrated over both apertures, to 1e-3 for slopes of 5e-3
/// and more. Light that comes out of the layers is counted as an instrument does.
///
/// @param viewing  light and eye that weigh the wavelengths; one wavelength stands for all
/// @throws UsageError  as Brdf::evaluate, and for wavelengths that do not ascend
GlossValues gloss(const Brdf& brdf, const Viewing& viewing = {});

}  // namespace miebrdf
#pragma GCC visibility pop
