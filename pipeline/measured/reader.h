// The type of every reader of measurements, and what they share.
#pragma once

#include <miebrdf/database.h>
#include <miebrdf/measured.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace miebrdf::measured {

inline double cosine_of(double degrees) { return std::cos(degrees * std::numbers::pi / 180.0); }

/// Wavelengths without a unit: lists that end below are micrometres, above nanometres.
constexpr double kLeastNm = 100.0;

struct MeasuredFile {
    std::string path;
    std::string_view content;  ///< text without its byte-order mark
};

/// A format: one file here, and one line in the list of readers.cpp.
struct Reader {
    MeasuredFormat format;
    bool (*looks_like)(const MeasuredFile& file);
    /// Values as they stand in the file, shares of 1 where it says its unit; complete() does the
    /// rest.
    Measurements (*read)(const MeasuredFile& file, const MeasuredOptions& options);
};

/// The kind of a word of measured_kind(); nothing for others.
std::optional<MeasuredKind> find_kind(std::string_view word);

/// In the order in which they are asked: the most particular first, tables last.
std::span<const Reader* const> readers();
/// The measurements of a file by the reader that knows it, complete.
/// @throws ImportError, UsageError  as read_measured()
Measurements read_with(std::span<const Reader* const> readers, const std::filesystem::path& path,
                       const MeasuredOptions& options);

/// @throws ImportError  always; line 0: the whole file
[[noreturn]] inline void refuse(const MeasuredFile& file, int line, const std::string& reason) {
    throw materials::ImportError(file.path, line, reason);
}

/// A number of a binary file, whose place the caller has checked.
template <typename Number>
Number number_in(std::string_view bytes, std::size_t place) {
    Number number;
    std::memcpy(&number, bytes.data() + place, sizeof number);
    return number;
}

/// Whether a field says that there is no value: empty, "nan", "?", "#N/A", -9999, -1.23e34.
bool says_missing(std::string_view field);
/// Numbers that stand for no value: -999, -9999.0, -1.23e34, and what is not finite.
bool is_fill(double number);
/// A finite number with a decimal point or comma; NaN where the field says that there is none;
/// nothing for other texts. complete() leaves values out that are NaN, and says how many.
std::optional<double> measured_number(std::string_view field);

/// The factor of the values, and the fact about it. Percent may be said by the file or asked for.
double share_factor(Measurements& list, const MeasuredOptions& options, bool file_says_percent,
                    std::string_view where);

/// The geometry and direction that words of a file tell: "Directional (10 Degree) Hemispherical",
/// "Sphere d/8 SPIN", "45/0". Nothing where they tell none.
struct NamedGeometry {
    MeasuredGeometry geometry = MeasuredGeometry::unknown;
    double mu_in = MeasuredValue::kNone;
};
NamedGeometry geometry_in(std::string_view words);

/// Adds a spectrum as a sample of its own.
/// @param lines  of the values; empty: the file has none
void add_spectrum(Measurements& list, const std::string& sample, MeasuredKind kind, double mu_in,
                  std::span<const double> wavelength_nm, std::span<const double> values,
                  std::span<const int> lines = {});

/// Adds L*, a*, b* to the last sample.
void add_lab(Measurements& list, MeasuredGeometry geometry, const std::array<double, 3>& lab,
             int line);

/// @throws UsageError  for standard errors, wavelengths and cosines out of range
void check(const MeasuredOptions& options);

/// Fills in what the options say, checks everything and sorts it.
void complete(Measurements& list, const MeasuredOptions& options);

}  // namespace miebrdf::measured
