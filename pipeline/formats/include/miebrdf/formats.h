// Files that renderers and measurement tools read: written, read back and checked.
//
//     export_brdf(brdf.table(), "rgl", "paint.bsdf");    // writes paint_spec and paint_rgb
//     const auto check = check_file("paint_spec.bsdf");  // reciprocity, albedo, least value
//
// docs/formats has a page for each format.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <miebrdf/brdf_source.h>
#include <miebrdf/control.h>
#include <miebrdf/error.h>
#include <miebrdf/language.h>
#include <miebrdf/solver.h>
#include <miebrdf/surface.h>

#pragma GCC visibility push(default)
namespace miebrdf {

class BrdfFile;
struct ExportJob;
struct ExportOptions;
struct OpenPbrFit;
struct ReflectanceSpectrum;
struct ScatteringTable;

// ---------------------------------------------------------------- What formats there are

enum class FormatContent {
    table,       ///< a BRDF at listed directions, exact there
    sampled,     ///< a BRDF that its readers interpolate; read back and compared after writing
    spectrum,    ///< reflectances without directions
    scattering,  ///< single scattering of a medium
};

/// How fine a format can be; each counts something else.
struct Fineness {
    std::string unit = {};  ///< what is counted
    int standard = 0;       ///< by default
    int lowest = 0;         ///< least that is allowed
    int highest = 0;        ///< as lowest: there is nothing to choose
    int finest = 0;         ///< largest that is worth its bytes
};

/// An option of one format alone: a whole number, or a switch (0 or 1).
struct FormatOption {
    std::string name = {};   ///< key of ExportOptions::extra
    std::string help = {};   ///< one line
    int standard = 0;        ///< by default
    int lowest = 0;          ///< least that is allowed
    int highest = 1;         ///< largest that is allowed
    bool is_switch = false;  ///< 0 or 1
};

/// One of the files that an export writes.
struct FormatFile {
    std::string suffix = {};  ///< after the stem of the name
    bool colours = false;     ///< holds R, G, B instead of the wavelengths
    /// Writes the file; null: others of the format hold everything.
    void (*write)(const ExportJob& job, std::ostream& out) = nullptr;
};

/// How sure a format is that some content is its own.
enum class Recognised { no, by_structure, by_first_bytes };

/// How files of a format are known and read.
struct FormatReader {
    Recognised (*recognise)(std::string_view content) = nullptr;  ///< null: not by itself
    /// @throws InputError  for a damaged, truncated or inconsistent file
    std::unique_ptr<BrdfFile> (*read)(std::string content) = nullptr;
};

/// Kinds of directions, each with a bound of its own.
enum class RegionKind {
    plain,    ///< mu > 0.2, and near the mirror direction there
    peaks,    ///< retro-reflection and zenith, where peaks are narrower than most formats' cells
    grazing,  ///< mu < 0.2
};

/// Largest rms errors, by kind of region.
struct AcceptedErrors {
    double plain = 0.05;   ///< relative rms
    double peaks = 0.5;    ///< relative rms
    double grazing = 2.0;  ///< as if all values were three times too large

    /// That of one kind.
    double of(RegionKind kind) const {
        return kind == RegionKind::plain ? plain : kind == RegionKind::peaks ? peaks : grazing;
    }
    /// These errors with at least `least` everywhere, and exactly that in plain regions.
    AcceptedErrors with_plain(double least) const;
};

/// All that is known of a format: export, check, help and messages read it from here.
struct Format {
    std::string name = {};                         ///< as ExportOptions and --format say it
    std::string readers = {};                      ///< programs that read it
    std::string holds = {};                        ///< in words
    std::vector<std::string> endings = {};         ///< of file names, the usual one first
    FormatContent content = FormatContent::table;  ///< what such files hold

    // The options that it takes of ExportOptions.
    Fineness resolution = {};              ///< of ExportOptions::resolution
    bool takes_directions = false;         ///< ExportOptions::directions
    bool takes_colours = false;            ///< ExportOptions::rgb
    bool whole_matrix = false;             ///< holds Mueller matrices: TableOptions::whole_matrix
    std::vector<FormatOption> extra = {};  ///< ExportOptions::extra
    bool holds_mirror = false;             ///< that of a smooth boundary: Provenance::mirror_index

    AcceptedErrors accepted = {};              ///< by default
    bool needs_ascending_wavelengths = false;  ///< else any order will do
    bool seeks = false;                        ///< goes back in its file: pipes get it from memory
    std::string not_checked = {};              ///< why check_file does not know it; empty: it does

    /// Bytes of its largest file, about, for options that are complete; null: not known before.
    std::uintmax_t (*expected_bytes)(const ExportOptions& options,
                                     std::size_t wavelengths) = nullptr;

    // The functions of the format, with types of the library's inside: formats are added there.
    std::vector<FormatFile> files = {};                      ///< at least one
    std::string (*sidecar)(const ExportJob& job) = nullptr;  ///< text of FILE.json, if any
    /// For formats of spectra and of scattering alone.
    void (*write_spectrum)(const ReflectanceSpectrum& spectrum, std::ostream& out) = nullptr;
    void (*write_scattering)(const ScatteringTable& table, std::ostream& out) = nullptr;
    FormatReader reader = {};  ///< empty: not read
};

/// In the order in which people are told of them.
std::span<const Format> all_formats();

/// @throws UsageError  for an unknown name, with the known and the nearest ones
const Format& find_format(std::string_view name, std::span<const Format> known = all_formats());

/// The fields of ExportOptions, and names of its `extra`, that a format looks at.
std::vector<std::string> options_of(const Format& format);

/// The mirror reflections that files of a format are without, and how to add them; empty: none. Of
/// Provenance::left_out, whose sentences are separated by "; ", a smooth boundary's is the first.
std::string left_out_of(const Format& format, const Provenance& origin);

// ---------------------------------------------------------------- Writing

/// The medium below the surface, for formats that hold subsurface scattering.
struct SubsurfaceMedium {
    std::vector<double> mean_free_path_um = {};  ///< 1 / extinction, at each wavelength
    double asymmetry = 0.0;                      ///< g in [-1, 1]
};

/// Options that a format does not take are not looked at.
struct ExportOptions {
    /// Format::resolution; 0: its standard, or the first finer one that errs by no more than is
    /// accepted.
    int resolution = 0;
    rte::Directions directions = {};  ///< empty lists: by the resolution
    /// Colours: "cie" (1931 observer, D65), "wavelengths" (the nearest to 620, 535 and 480 nm), or
    /// "auto": cie where the wavelengths cover the visible.
    std::string rgb = "auto";
    /// Largest relative error (rms, at mu > 0.2 and near the mirror direction) of a file that is
    /// read back; 0: that of Format::accepted. Other regions may have theirs, or this if it is
    /// larger.
    double largest_error = 0.0;
    bool accept_error = false;                        ///< write the file whatever was found
    std::map<std::string, int> extra = {};            ///< Format::extra by name
    std::optional<SubsurfaceMedium> subsurface = {};  ///< empty: not known
};

/// How far a file is from the BRDF in one kind of directions.
struct RegionDeviation {
    const char* name = "";                ///< e.g. "mu > 0.2"
    RegionKind kind = RegionKind::plain;  ///< which bound holds
    /// Root mean square of relative errors; about mirror directions, where a lobe ranges over many
    /// decades, that of the errors over that of the values.
    double rms = 0.0;
    /// Relative error with its sign, and the directions, of the value that is worst.
    double worst = 0.0;
    Direction where;  ///< it is
};

/// How far a file, read as its program reads it, is from the BRDF that it was made from: root mean
/// square of relative errors over random directions, by m = min(mu_in, mu_out). Values below a
/// hundredth of the mean (tails of a lobe) are compared with that.
struct Deviation {
    /// m > 0.2, 0.05 < m <= 0.2, m <= 0.05 (down to 0.005: below, 17 arc minutes above the horizon,
    /// relative errors of formats that store BRDF times cosine have no bound).
    std::array<double, 3> rms = {0.0, 0.0, 0.0};
    /// Error of the values near the mirror direction, rms over rms: what a file makes of a surface
    /// lobe that random directions hardly ever meet.
    double lobe = 0.0;
    double largest = 0.0;        ///< of all directions, relative to the BRDF's mean over directions
    std::size_t directions = 0;  ///< compared; those where the file has no value are left out
    std::size_t missing = 0;     ///< directions without a value
    /// The three bands of `rms`; then, with 500 directions each, those about the mirror direction
    /// (`lobe`), about it within mu < 0.2, about retro-reflection, and about the zenith. Of tables
    /// that no program interpolates the bands alone.
    std::vector<RegionDeviation> regions;
};

/// Names of Deviation::rms.
inline constexpr std::array<const char*, 3> kDeviationBands = {"mu > 0.2", "mu 0.05-0.2",
                                                               "mu < 0.05"};

/// The region of a deviation that misses its bound by the largest factor; null when none does.
const RegionDeviation* worst_region(const Deviation& deviation, const AcceptedErrors& accepted);

/// One file that was written.
struct ExportedFile {
    std::filesystem::path path;          ///< of the file
    std::uintmax_t bytes = 0;            ///< 0: a pipe or device
    std::optional<Deviation> deviation;  ///< of what was read back; tables are exact
    int resolution = 0;  ///< 0: that of the options, or the format's standard; else a finer one
};

/// A file would be further from the BRDF than accepted. Nothing was written.
class TooCoarse : public Error {
    using Error::Error;
};

/// Writes every file of a format whole, or none of them.
/// @return  the files that were written, without a FILE.json beside them
/// @throws UsageError  options out of range, or a source without wavelengths
/// @throws InputError  when a file cannot be written
/// @throws TooCoarse   with the error, and a resolution that would do; Cancelled
std::vector<ExportedFile> export_brdf(const BrdfSource& source, const Format& format,
                                      const std::filesystem::path& path,
                                      const ExportOptions& options = {},
                                      const Control& control = {});
std::vector<ExportedFile> export_brdf(const BrdfSource& source, const std::string& format,
                                      const std::filesystem::path& path,
                                      const ExportOptions& options = {},
                                      const Control& control = {});

/// Parameters of an OpenPBR surface (Academy Software Foundation, OpenPBR 1.1), with the names,
/// units and defaults of the specification; colours are linear. What is not here has its default.
struct OpenPbr {
    double base_weight = 1.0;                            ///< [0, 1]
    std::array<double, 3> base_color = {0.8, 0.8, 0.8};  ///< [0, 1]
    double base_diffuse_roughness = 0.0;                 ///< [0, 1]
    double specular_weight = 1.0;                        ///< >= 0; 0: no boundary
    double specular_roughness = 0.3;                     ///< [0, 1]; GGX's alpha = roughness^2
    double specular_ior = 1.5;                           ///< > 0
    double coat_weight = 0.0;                            ///< [0, 1]
    std::array<double, 3> coat_color = {1.0, 1.0, 1.0};  ///< [0, 1]
    double coat_roughness = 0.0;                         ///< [0, 1]
    double coat_ior = 1.6;                               ///< > 0
    double coat_darkening = 1.0;                         ///< [0, 1]
    double subsurface_weight = 0.0;                      ///< [0, 1]
    std::array<double, 3> subsurface_color = {0.8, 0.8, 0.8};          ///< [0, 1]
    double subsurface_radius = 1.0;                                    ///< mm, > 0
    std::array<double, 3> subsurface_radius_scale = {1.0, 0.5, 0.25};  ///< [0, 1]
    double subsurface_scatter_anisotropy = 0.0;                        ///< g in [-1, 1]
};

/// A number of OpenPbr, or a colour, under its name in the specification.
struct OpenPbrParameter {
    const char* name;                                  ///< "base_color"
    double OpenPbr::*number = nullptr;                 ///< null: it is a colour
    std::array<double, 3> OpenPbr::*colour = nullptr;  ///< null: it is a number
};
std::span<const OpenPbrParameter> openpbr_parameters();  ///< in the order of the specification

/// The OpenPBR surface that comes nearest to a BRDF.
struct OpenPbrFit {
    OpenPbr surface;
    std::string colour_space;  ///< of its colours: "lin_rec709" or "acescg"
    std::string colour;        ///< primaries, illuminant and observer of the linear sRGB fitted to
    std::string weights;       ///< of the directions, in words
    Deviation deviation;       ///< of the surface from the BRDF, in linear sRGB, by region
};

/// Fits an OpenPBR surface by least squares of relative errors over five kinds of directions, with
/// the weights that the result states: a diffuse base; with a specular lobe; with a coat, each
/// from several starts. A further lobe is kept if it halves the sum of squares. A
/// smooth boundary is no unknown: its index is Provenance::mirror_index.
/// @param options  rgb; extra: "acescg", "subsurface"; subsurface
/// @throws UsageError  options out of range, or a source without wavelengths; Cancelled
OpenPbrFit fit_openpbr(const BrdfSource& source, const ExportOptions& options = {},
                       const Control& control = {});

/// BRDF of an OpenPBR surface at each direction, 1/sr without the cosine, without mirror
/// reflections (roughness 0): the specification's mixture of lobes. The diffuse lobe (EON) lies
/// below the specular one in the reciprocal form of albedo scaling, the coat takes from what lies
/// below it on the viewer's side; facets shadow by the heights of both rays together (Smith).
/// Albedos of rough boundaries are tabulated once for a call: some milliseconds.
/// @throws UsageError  for parameters and directions out of range
std::vector<std::array<double, 3>> openpbr_brdf(const OpenPbr& surface,
                                                std::span<const Direction> directions);

/// About how large the largest file will be; 0 where the format does not know before.
/// @throws UsageError  options out of range
std::uintmax_t expected_bytes(const Format& format, const ExportOptions& options,
                              std::size_t wavelengths);

/// A reflectance at each wavelength.
struct ReflectanceSpectrum {
    std::vector<double> wavelength_nm;  ///< vacuum
    std::vector<double> value;          ///< reflectance, 1 = all
    std::vector<std::string> comments;  ///< version, command line, sources, what the value is
};

/// Single scattering at each wavelength.
struct ScatteringTable {
    std::vector<double> wavelength_nm;             ///< vacuum
    std::vector<double> single_scattering_albedo;  ///< in [0, 1]
    std::vector<double> asymmetry;                 ///< g in [-1, 1]
    std::vector<double> q_ext;                     ///< not a number for media without particles
    std::vector<std::vector<double>> chi;          ///< chi_0 = 1, ...; lists may differ in length
    std::string metadata;                          ///< JSON
};

/// @throws UsageError  for a format of another content, or wavelengths that do not suit it
/// @throws InputError  when the file cannot be written
void export_spectrum(const ReflectanceSpectrum& spectrum, const std::string& format,
                     const std::filesystem::path& path);
void export_scattering(const ScatteringTable& table, const std::string& format,
                       const std::filesystem::path& path);

// ---------------------------------------------------------------- Reading and checking

/// The directions of a table: it has a value at each combination.
struct ListedDirections {
    std::vector<double> mu_in, mu_out;  ///< ascending
    std::vector<double> azimuth_deg;    ///< ascending, 0 = mirror side
    /// Programs that read the format interpolate: what lies between is as much the file's.
    bool interpolated = false;
};

/// A BRDF file as its program sees it. Readers are written from the layouts alone and share no code
/// with the writers; they evaluate (interpolate, clamp, divide by the cosine) as the real program
/// does.
class BrdfFile {
  public:
    virtual ~BrdfFile() = default;

    virtual std::string format() const = 0;       ///< Format::name
    virtual std::string description() const = 0;  ///< what is special about this file

    /// "550 nm" or "R", "G", "B" or whatever the file calls them.
    virtual const std::vector<std::string>& channels() const = 0;
    /// The wavelength of each channel; empty when the channels are colours.
    virtual const std::vector<double>& wavelength_nm() const = 0;

    /// BRDF in 1/sr without the cosine, one value for each channel; not a number where the file
    /// holds none.
    /// @throws UsageError  for a direction out of range and too few values
    void evaluate(const Direction& direction, std::span<double> values) const;
    /// Mueller matrices as of BrdfSource, of one direction; 1 component: none.
    virtual int components() const { return 1; }
    /// Fills in components() x components() values for each channel.
    /// @throws UsageError  for a direction out of range and too few values
    void evaluate_mueller(const Direction& direction, std::span<double> values) const;
    /// The lists of directions of a table over such lists.
    virtual std::optional<ListedDirections> listed() const { return {}; }

    /// Which cosine the format's importance sampling starts from; it draws the other one.
    enum class Sampling { none, from_mu_in, from_mu_out };
    virtual Sampling sampling() const { return Sampling::none; }  ///< none: it cannot be sampled
    /// Draws a direction with two uniform numbers in [0, 1), as the real program does. Empty when
    /// it fell below the horizon.
    virtual std::optional<Direction> sample(double mu_fixed, double u, double v) const;
    /// The density of `sample`, per unit of solid angle, at any direction.
    virtual double density(const Direction& direction) const;

  protected:
    /// `evaluate`, its arguments checked.
    virtual void look_up(const Direction& direction, std::span<double> values) const = 0;
    /// `evaluate_mueller`, its arguments checked.
    virtual void look_up_mueller(const Direction& direction, std::span<double> values) const {
        look_up(direction, values);
    }
};

/// Reads whatever `content` is, recognised by its first bytes and structure, not by a name. Binary
/// formats are read where they are, others into no more than their text takes; memory stays in
/// proportion to the size of the content, whatever its header claims.
/// @param name  for messages
/// @throws InputError  for an unknown, damaged, truncated or inconsistent file
std::unique_ptr<BrdfFile> read_brdf_file(std::string content, const std::string& name,
                                         std::span<const Format> known = all_formats());
/// Opens a file on disk. @throws InputError
std::unique_ptr<BrdfFile> open_brdf_file(const std::string& path,
                                         std::span<const Format> known = all_formats());

/// Physics of a BRDF file, as the program that reads it will see it.
struct FileCheck {
    /// Root mean square of |f(i, o) - f(o, i)| / mean of both, directions with both cosines > 0.2;
    /// empty when a table lists no pair of directions both ways.
    std::optional<double> reciprocity_rms;
    /// Directional, of all channels and angles of incidence; empty when a table has too few
    /// directions to integrate over.
    std::optional<double> largest_albedo;
    /// Estimate of what integrating over a table's directions may err by, there; the albedo shown
    /// is the one that is largest without it.
    double largest_albedo_error = 0.0;
    double largest_albedo_mu = 0.0;      ///< its incidence, in (0, 1]
    std::string largest_albedo_channel;  ///< its channel
    double least_value = 0.0;            ///< of the BRDF, 1/sr
    std::size_t missing = 0;             ///< directions without a value
    std::size_t directions = 0;          ///< how many were looked at
    /// Largest relative difference of the albedo found by importance sampling from the integrated
    /// one; empty without sampling tables.
    std::optional<double> sampled_albedo_error;
};

/// Looks at `directions` random directions, and integrates at six angles of incidence, mu 0.1 to 1.
/// In tables it looks at the directions that they list: random combinations, and all angles of
/// incidence.
FileCheck check_file(const BrdfFile& file, std::size_t directions = 4000);
/// Checks a file on disk. @throws InputError
FileCheck check_file(const std::string& path);

/// How far a file is from the BRDF that it is said to hold.
struct FileComparison {
    /// At 3000 random directions; of a table that no program interpolates, at those that it lists.
    Deviation deviation;
    bool only_listed = false;  ///< such a table: there is no Deviation::lobe
    /// Largest relative difference of directional albedos, over channels and mu_in = 0.1 ... 1.
    double albedo_error = 0.0;
};

/// @param truth  with the file's wavelengths; of a file of colours, any that colours are made from
/// @param rgb    as ExportOptions::rgb
/// @throws UsageError  when the channels do not fit
FileComparison compare_file(const BrdfFile& file, const BrdfSource& truth,
                            const std::string& rgb = "auto");

/// The ground of one model that comes nearest to a BRDF.
struct GroundFit {
    std::vector<std::string> parameters;  ///< those that were fitted, the first of `grounds`
    std::vector<rte::GroundBrdf>
        grounds;          ///< of each channel; Lambert's as ross_li without kernels
    std::string weights;  ///< of the directions, in words
    Deviation deviation;  ///< by region
};

/// Least squares of relative errors at directions with cosines above 0.2, channel by channel.
/// @param model  "rpv" (rhoc is rho0), "ross-li", "hapke", "lambert"
/// @throws UsageError  for another model; Cancelled
GroundFit fit_ground(const BrdfSource& source, const std::string& model,
                     const Control& control = {});

}  // namespace miebrdf
#pragma GCC visibility pop
