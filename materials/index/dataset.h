// One set of optical constants as its source gives it, with its provenance.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "materials/index/units.h"

namespace miebrdf::materials {

/// n or k as a function of wavelength: a table on its native grid and in its native unit (never
/// resampled), or a dispersion formula.
struct Series {
    int formula = 0;              ///< 0: a table; 1-9: numbering of refractiveindex.info
    Unit unit = Unit::nanometre;  ///< of x; formulas are always in micrometres
    std::vector<double> x;  ///< ascending in wavelength (so descending in eV); empty for formulas
    std::vector<double> y;  ///< table: the values; formula: the coefficients
    double shortest_nm = 0.0;  ///< first valid wavelength
    double longest_nm = 0.0;   ///< last valid wavelength

    bool tabulated() const { return formula == 0; }
    std::vector<double> wavelengths_nm() const;
    bool operator==(const Series&) const = default;
};

/// A table in the given unit; shortest and longest follow from x.
Series make_table(Unit unit, std::vector<double> x, std::vector<double> y);

/// A series must be finite, ascending in wavelength (and strictly descending in photon energy, in
/// which it will be interpolated), with n > 0 and k >= 0 wherever it is tabulated.
/// @throws std::invalid_argument  naming the row
void check_series(const Series& series, char quantity);

struct Dataset {
    std::string material;  ///< name of the material it belongs to
    std::string title;     ///< e.g. "Titanium dioxide"
    std::string formula;   ///< chemical formula, may be empty
    std::vector<std::string> aliases;

    std::string label;      ///< unique within the material, e.g. "Malitson", "SOPRA"
    std::string source;     ///< collection, e.g. "SOPRA", "refractiveindex.info"
    std::string key;        ///< its name there, e.g. "GAP", "main/GaP/Bond"
    std::string reference;  ///< publication
    std::string doi;
    std::string licence;
    std::string ray;  ///< "o", "e" or empty
    std::string composition;
    std::string note;
    std::string format;       ///< of the file it was read from
    std::string file;         ///< name of that file
    std::string file_sha256;  ///< of that file's bytes
    std::optional<double> temperature_k;

    std::optional<Series> n;  ///< nothing: the source gives k only
    std::optional<Series> k;  ///< nothing: k is unknown, which is not the same as k = 0
    std::vector<std::string> corrections;  ///< what the reader changed, in words
};

/// Checksum of the figures alone: the same table from two files has the same one.
std::string content_sha256(const Dataset& dataset);

/// Little-endian doubles, as they are stored and summed.
std::string to_bytes(const std::vector<double>& values);
std::vector<double> from_bytes(const void* bytes, std::size_t size);

}  // namespace miebrdf::materials
