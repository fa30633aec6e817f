// Measurements as instruments write them, as one list of values.
//
//     const auto measured = read_measured("paint.cxf");
//     for (const auto& m : measured.values) use(m.wavelength_nm, m.value);
//
// docs/measured.md has the formats, and what each says of its quantity and geometry.
#pragma once

#include <miebrdf/brdf_source.h>
#include <miebrdf/error.h>
#include <miebrdf/language.h>

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf {

enum class MeasuredQuantity {
    reflectance,         ///< share of the incident light that comes back
    transmittance,       ///< share of the incident light that passes
    brdf,                ///< 1/sr, without the cosine
    reflectance_factor,  ///< relative to a white Lambertian surface: pi times the BRDF
    lab_l,               ///< CIE L*, a*, b*
    lab_a,
    lab_b,
};

enum class MeasuredGeometry {
    unknown,
    directional,    ///< light from mu_in, all that comes back or passes, the mirror part included
    d8_sci,         ///< the same at 8 degrees, as a sphere with specular included sees it
    d8_sce,         ///< at 8 degrees without the mirror part: specular excluded
    d45_0,          ///< light from 45 degrees, seen from above
    hemispherical,  ///< light from all sides alike
    unscattered,    ///< of a transmittance: light from mu_in, what passes straight on
    hdrf,           ///< under sun and sky, seen from mu_out
    directions,     ///< mu_in, mu_out, azimuth
};

/// The quantity that was measured, and how.
struct MeasuredKind {
    MeasuredQuantity quantity = MeasuredQuantity::reflectance;
    MeasuredGeometry geometry = MeasuredGeometry::unknown;

    bool operator==(const MeasuredKind&) const = default;
};

/// The kind that a word names: plane_albedo, spherical_albedo, hemispherical, plane_transmittance,
/// spherical_transmittance,
/// unscattered_transmittance, brdf, reflection, reflectance_factor, hdrf, d8-sci, d8-sce, 45-0, lab
/// (its L*), reflectance, transmittance.
/// @throws UsageError  naming them
MeasuredKind measured_kind(std::string_view word);
/// "reflectance", "lab_l"; "d8-sci", and an empty text for an unknown geometry.
std::string word_of(MeasuredQuantity quantity);
std::string word_of(MeasuredGeometry geometry);
/// Quantities that are shares of the incident light, or relative to white.
bool is_share(MeasuredQuantity quantity);

/// One value. Numbers that it has none of are not a number (NaN).
struct MeasuredValue {
    static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

    MeasuredQuantity quantity = MeasuredQuantity::reflectance;
    MeasuredGeometry geometry = MeasuredGeometry::unknown;
    double wavelength_nm = kNone;
    double mu_in = kNone, mu_out = kNone;  ///< known where the geometry fixes them
    double azimuth_deg = kNone;            ///< in [0, 360); 0 = mirror side
    double value = kNone;                  ///< in the unit of its quantity
    double sigma = kNone;                  ///< standard error, in the unit of the value
    std::size_t sample = 0;                ///< index in Measurements::samples
    int line = 0;                          ///< of the file; 0: it has none
};

/// An integrating sphere: diameters in mm of it and its ports, diffuse reflectances in [0, 1].
struct IntegratingSphere {
    double diameter_mm = 0.0, sample_port_mm = 0.0, detector_port_mm = 0.0;  ///< in mm, above 0
    double third_port_mm = 0.0;  ///< where light enters, or leaves straight; 0: there is wall
    double wall = 0.0, detector = 0.0;  ///< in [0, 1)
    double standard = 1.0;  ///< in (0, 1], in place of the sample; of a transmittance at the third
                            ///< port
    bool baffle = true;     ///< between sample and detector
};

/// Shares of the light that a sample returns (r) and passes (t): of a beam, the unscattered part
/// included; that part; of diffuse light.
struct SlabLight {
    double r_direct = 0.0, t_direct = 0.0, r_unscattered = 0.0, t_unscattered = 0.0;  ///< [0, 1]
    double r_diffuse = 0.0, t_diffuse = 0.0;                                          ///< [0, 1]
};

/// Numbers of the spheres that differ from wavelength to wavelength.
struct SphereRow {
    double wavelength_nm = 0.0;
    /// Reflectances, in [0, 1].
    double wall_above = 0.0, wall_below = 0.0, standard_above = 1.0, standard_below = 1.0;
};

/// How spheres measured a sample: by substitution, a standard in its place before or after.
struct SphereMeasurement {
    IntegratingSphere above = {}, below = {};  ///< of reflectances; of transmittances
    int spheres = 1;  ///< 2: both at once; 0: dual beam, the sphere cancels out
    /// Shares of the unscattered light that the sphere gets; below 1 by an open port.
    double unscattered_reflectance = 1.0, unscattered_transmittance = 1.0;
    double hits_wall = 0.0;            ///< share of the beam that misses the sample
    double beam_mm = 0.0;              ///< mm, >= 0: its diameter; 0: a pencil
    bool lost_light = false;           ///< in fits: light that leaves beside the ports is traced
    bool as_iad = false;               ///< normalised as iad 3 and 4 do (docs/fitting.md)
    std::vector<SphereRow> rows = {};  ///< wavelengths ascending, linear between them

    /// The same with the numbers of `rows` at a wavelength.
    SphereMeasurement at(double wavelength_nm) const;
};

/// The reflectance, or transmittance, that is read off. @pre validate(spheres)
double sphere_reading(const SphereMeasurement& spheres, bool transmitted, const SlabLight& light);
/// Sets a number by its word: diameter, sample_port, third_port, detector_port (mm), wall,
/// detector, standard, baffle, dual_beam and lost_light (0 or 1), unscattered_reflectance,
/// unscattered_transmittance, hits_wall, beam (mm).
/// @param other  of the sphere below alone
/// @throws UsageError  for unknown words, and numbers out of range
void set_sphere_word(SphereMeasurement& spheres, const std::string& word, double value,
                     bool other = false);
/// @throws UsageError  for a sphere without a size, a port or a wall
void validate(const SphereMeasurement& spheres);

/// The content of a file.
struct Measurements {
    std::string file, format;
    std::vector<std::string> samples;   ///< names of samples or columns, at least one
    std::vector<MeasuredValue> values;  ///< sample by sample, wavelengths ascending
    /// How the file was understood, by name: "unit" -> "percent", "azimuth" -> "0 = mirror side".
    std::vector<std::pair<std::string, std::string>> facts = {};
    /// Sentences about what may be wrong, with the line and what would help.
    std::vector<std::string> doubts = {};
    std::optional<SphereMeasurement> spheres = {};  ///< that measured, where the file says so
};

/// How a file is read; everything may be left as it is.
struct MeasuredOptions {
    std::string format = {};    ///< name of a format; empty: recognised
    std::string column = {};    ///< one sample or column alone; empty: all
    std::string quantity = {};  ///< a word of measured_kind(), in place of what the file says
    std::optional<bool> percent = {};          ///< nothing: as the file says, else shares of 1
    std::optional<double> wavelength_nm = {};  ///< of values that have none, like the next three
    std::optional<double> mu_in = {}, mu_out = {}, azimuth_deg = {};
    /// Standard errors of values that have none; both: the root of the sum of squares.
    std::optional<double> sigma = {}, relative_sigma = {};
    /// The meaning of azimuth 0 in the file: "mirror" or "back" (towards the source, as in
    /// graphics). Empty: as the file says, or as its values show beyond doubt.
    std::string azimuth_zero = {};
    /// USGS splib: the file of wavelengths; empty: looked for beside the file and in the two
    /// folders above.
    std::filesystem::path wavelengths = {};
};

/// A format that is read.
struct MeasuredFormat {
    const char* name;
    const char* title;
};
std::vector<MeasuredFormat> measured_formats();  ///< in the order in which they are tried

/// Reads a file of any of these formats, recognised by its content.
/// @throws UsageError  for options that are out of range, or that name a column that is not there
/// @throws InputError  with FILE:LINE for a file that cannot be read or is damaged, values in
///         percent where shares are meant, wavelengths that are there twice with two values, and
///         directions whose convention is not known
Measurements read_measured(const std::filesystem::path& file, const MeasuredOptions& options = {});

/// A BRDF made of measured directions, and how well it is known.
struct InterpolatedBrdf {
    std::shared_ptr<const BrdfSource> source;  ///< one channel for each wavelength
    std::size_t values = 0;                    ///< number of measured ones in it
    /// Relative, root mean square: at the measured directions, and where each value is left out in
    /// turn and found from the others.
    double residual_rms = 0.0, leave_one_out_rms = 0.0;
    double worst = 0.0;  ///< largest of the values left out, relative, with its sign
    Direction where;     ///< of it
    double least_mu_in = 1.0, least_mu_out = 1.0;  ///< measured: beyond, values are extrapolated
    double largest_albedo = 0.0;  ///< directional, of all wavelengths, at the measured incidences
    std::vector<std::string> doubts = {};
};

/// Interpolates between the measured directions of a BRDF or reflectance factor so that light may
/// go either way (reciprocity) and either side of the plane of incidence is alike: kriging of the
/// logarithm over invariants of both directions, its lengths and noise chosen by leaving values
/// out. Beyond the measured directions it follows a smooth trend.
/// @param provenance  of the file that it goes into; accuracy and sources are added
/// @throws InputError  for lists without wavelengths or directions, with fewer than 12 directions
///         of a wavelength or more than 6000, several samples, values that are not above 0
InterpolatedBrdf interpolated_brdf(const Measurements& measured, Provenance provenance = {},
                                   const Control& control = {});

}  // namespace miebrdf
#pragma GCC visibility pop
