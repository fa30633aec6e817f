// Optical constants n + ik: as their source gives them, and at any wavelength.
#pragma once

#include <complex>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <miebrdf/language.h>

#pragma GCC visibility push(default)
namespace miebrdf::materials {

enum class Unit { nanometre, micrometre, angstrom, electronvolt, per_centimetre, terahertz };

/// "nm", "um", "angstrom", "eV", "cm-1", "THz": how units are stored and printed.
const char* name_of(Unit unit);

/// Vacuum wavelength in nm; the value must be positive.
double to_nm(double value, Unit unit);
double from_nm(double wavelength_nm, Unit unit);

/// n or k as a function of wavelength: a table on its native grid and in its native unit (never
/// resampled), or a dispersion formula.
struct Series {
    int formula = 0;              ///< 0: a table; 1-9: numbering of refractiveindex.info
    Unit unit = Unit::nanometre;  ///< of x; formulas are always in micrometres
    std::vector<double> x;  ///< ascending in wavelength (so descending in eV); empty for formulas
    std::vector<double> y;  ///< table: the values; formula: the coefficients
    double shortest_nm = 0.0;  ///< first valid wavelength
    double longest_nm = 0.0;   ///< last valid wavelength

    bool tabulated() const { return formula == 0; }  ///< not a formula
    std::vector<double> wavelengths_nm() const;      ///< of x, nm in vacuum
    bool operator==(const Series&) const = default;
};

/// A table in the given unit; shortest and longest follow from x.
Series make_table(Unit unit, std::vector<double> x, std::vector<double> y);

/// Where a dataset comes from, and what it is of.
struct DatasetOrigin {
    std::string material;  ///< name of the material it belongs to
    std::string label;     ///< unique within the material: "material/label" names the dataset
    std::string source;    ///< collection, e.g. "SOPRA", "refractiveindex.info"
    std::string key;  ///< its name there, e.g. "GAP", "main/GaP/Bond"; "source:key" finds it too
    std::string reference;                 ///< publication or file
    std::string doi;                       ///< may be empty
    std::string licence;                   ///< of the data, e.g. "CC0 1.0"
    std::string ray;                       ///< "o", "e" or empty
    std::string composition;               ///< as the source says; may be empty
    std::string note;                      ///< may be empty
    std::string format;                    ///< of the file it was read from
    std::string file;                      ///< name of that file
    std::string file_sha256;               ///< of that file's bytes
    std::optional<double> temperature_k;   ///< nothing: not given
    std::optional<double> density_g_cm3;   ///< of the solid or liquid; nothing: not given
    std::string density_source;            ///< where the density is from
    std::vector<std::string> corrections;  ///< what the reader changed, in words
};

/// One table or formula of n and k with all that is known of it.
struct Dataset : DatasetOrigin {
    std::string title;                 ///< e.g. "Titanium dioxide"
    std::string formula;               ///< chemical formula, may be empty
    std::vector<std::string> aliases;  ///< other names
    std::optional<Series> n;           ///< nothing: the source gives k only
    std::optional<Series> k;           ///< nothing: k is unknown, which is not the same as k = 0
};

/// A table of n and k on its own grid, never resampled.
struct IndexTable {
    std::vector<double> wavelength_nm;  ///< vacuum, ascending, > 0
    std::vector<double> n;              ///< > 0
    std::vector<double> k;              ///< >= 0; all 0 when k_known is false
    bool k_known = true;  ///< false: k was not measured, which is not the same as k = 0
};

enum class Interpolation {
    pchip,  ///< monotone cubic in photon energy (Fritsch & Butland 1984): no overshoot, k >= 0
    linear_in_energy,
    linear_in_wavelength,  ///< what most other tools do
};
enum class Extrapolation { refuse, clamp };

/// How n and k are read from a dataset.
struct IndexOptions {
    Interpolation interpolation = Interpolation::pchip;   ///< between rows
    Extrapolation extrapolation = Extrapolation::refuse;  ///< clamp: the value at the nearer end
    /// Where n is known and k is not: true gives k = 0 instead of an error. Has no effect when k is
    /// unknown everywhere: then k is 0 and `k_known()` is false.
    bool missing_k_is_zero = false;
};

/// Where else to look when a wavelength is not covered; only used in the message.
struct Coverage {
    std::string name;          ///< of the other dataset
    double shortest_nm = 0.0;  ///< nm, vacuum
    double longest_nm = 0.0;   ///< nm, vacuum
};

/// n + ik as a function of the wavelength: a model, a formula, an interpolation between datasets.
struct IndexFunction {
    /// Called for wavelengths of the range, from several threads.
    std::function<std::complex<double>(double wavelength_nm)> at = {};
    double shortest_nm = 0.0;          ///< nm, vacuum
    double longest_nm = 0.0;           ///< nm, vacuum
    std::vector<double> grid_nm = {};  ///< where it is tabulated for those who want a table
    bool k_known = true;               ///< false: k is 0 because nobody gave it
    /// Ends the message about a wavelength without a value: "; range=FROM:TO leaves it out".
    std::string advice = {};
};

/// Interpolates n and k separately, each on its own grid, monotonically (PCHIP) in photon energy;
/// dispersion formulas are evaluated exactly. Tables of fewer than 4 rows are interpolated linearly
/// in photon energy (PCHIP needs 4), a table of one row is valid at that wavelength alone.
/// Copies are cheap and share the table; `at` may be called from several threads.
class RefractiveIndex {
  public:
    /// @throws InputError  for a table that is empty, not ascending or not physical
    RefractiveIndex(std::string material, IndexTable table);

    /// @param k  nothing when it is unknown
    /// @throws InputError  for a series that is empty, not ascending or not physical, or
    ///         when n is missing or n and k have no wavelength in common
    RefractiveIndex(std::string material, std::optional<Series> n, std::optional<Series> k,
                    const IndexOptions& options = {}, std::vector<Coverage> alternatives = {});

    /// Evaluated as it is; values that are no refractive index are refused where they occur.
    /// @param options  of these the extrapolation counts
    RefractiveIndex(std::string material, IndexFunction function, const IndexOptions& options = {});

    /// n + ik at a vacuum wavelength.
    /// @throws InputError  outside the data, naming material, asked and valid range (the field is
    ///         wavelength_nm); also where a formula has no real value
    std::complex<double> at(double wavelength_nm) const;

    /// First and last wavelength at which both n and k are given (n alone when k is unknown).
    double shortest_nm() const;
    double longest_nm() const;                ///< nm, vacuum
    bool covers(double wavelength_nm) const;  ///< whether `at` has a value there
    bool k_known() const;                     ///< false: k is 0 because nobody measured it
    /// Whether k is known there, which is not the same as within the range of n.
    bool k_known_at(double wavelength_nm) const;

    /// n and k at every native wavelength of the range; for formulas 201 points even in energy, for
    /// functions those of their grid; without those where a formula or function has no value.
    IndexTable table() const;

  private:
    struct State;
    std::shared_ptr<const State> state_;
};

}  // namespace miebrdf::materials
#pragma GCC visibility pop
