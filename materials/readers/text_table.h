// Tables as people, spreadsheets and instruments write them: one reader for every CSV that a user
// gives, whatever it is for.
#pragma once

#include <miebrdf/database.h>
#include <miebrdf/index.h>

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace miebrdf::materials {

/// What one file may have and unpack to: one budget for all readers, so that none of them exhausts
/// memory or time.
struct ReadingBudget {
    static constexpr std::uintmax_t kBytes = 256u << 20;
    static constexpr std::size_t kValues = 4'000'000;  ///< numbers, fields or lines
    /// Plain numbers of databases of single scattering, in files of up to kLargeBytes.
    static constexpr std::size_t kNumbers = 60'000'000;
    static constexpr std::uintmax_t kLargeBytes = 1u << 30;

    /// @throws ImportError  above most
    static void require_values(std::size_t count, const std::string& file, int line = 0,
                               std::size_t most = kValues);
};

/// @param most  bytes
/// @throws ImportError  when it cannot be read, is no ordinary file, or is larger
std::string read_bytes(const std::filesystem::path& file,
                       std::uintmax_t most = ReadingBudget::kBytes);
/// The text without its byte-order mark. @throws ImportError  for UTF-16, and too many lines
std::string without_mark(std::string text, const std::string& file);
/// The same of a file that must be text. @throws ImportError  for other bytes, too
std::string text_of(std::string bytes, const std::string& file);

/// A finite number with a decimal point or comma, "45 %" as 0.45; nothing for another text.
std::optional<double> table_number(std::string_view field);

/// The numbers of a line without quotes, as words. Blanks, tabs and semicolons separate them, and
/// commas too, unless the line can only be read with decimal commas ("400 1,5 0,01").
std::vector<std::string> split_numbers(std::string_view line);

/// The quantity and unit that a column or a remark names: "wavelength_um", "Wavelength (nm)",
/// "lambda[A]", "energy in eV", "nm". "wl" is what refractiveindex.info writes.
struct SpectralName {
    std::optional<Unit> unit;  ///< nothing: the name does not say
    bool is_wl = false;
};
/// Nothing when it names no wavelength, energy, wavenumber or frequency.
std::optional<SpectralName> spectral_name(std::string_view name);

/// A text line by line. Semicolons, tabs, commas or blanks separate fields, whichever of them the
/// line of names has, in this order; numbers have a decimal point or a decimal comma throughout.
class TextTable {
  public:
    TextTable(std::string_view text, std::string file, char comment = '#');

    /// Goes to the next line with fields; false at the end. Comments on the way are kept.
    bool next();
    /// Takes the current line for the one that names the columns.
    void take_names();

    const std::vector<std::string>& fields() const { return fields_; }
    const std::string& file() const { return file_; }
    int line() const { return line_; }
    /// The current line without its comment.
    std::string_view content() const { return content_; }
    bool ends_with_blank() const { return ends_with_blank_; }
    /// The text of comments, without their mark and blanks.
    const std::vector<std::string>& comments() const { return comments_; }

    /// A finite number; "45 %" is 0.45. @throws ImportError
    double number(std::string_view field);
    [[noreturn]] void refuse(const std::string& reason) const;

  private:
    std::vector<std::string> split(std::string_view content) const;

    std::string_view rest_;  ///< of the text
    std::string_view content_;
    bool ends_with_blank_ = false;
    std::string file_;
    char comment_;
    char separator_ = '\0';  ///< of the names; none yet
    std::size_t names_ = 0;
    bool has_point_ = false, has_comma_ = false;
    int line_ = 0;
    std::vector<std::string> fields_;
    std::vector<std::string> comments_;
};

/// Columns of numbers by name, read whole.
class NumberTable {
  public:
    /// An empty field is not a number (NaN).
    /// @throws ImportError  for a file that cannot be read, rows of other lengths than the line of
    ///         names, fields that are no numbers, and a table without rows
    explicit NumberTable(const std::string& path);

    const std::string& path() const { return path_; }
    const std::vector<std::string>& names() const { return names_; }
    std::size_t rows() const { return lines_.size(); }

    /// @throws ImportError  for a name that is missing, unknown or there twice
    void require_names(std::initializer_list<std::string_view> needed,
                       std::initializer_list<std::string_view> allowed = {}) const;
    /// Null where there is no such column. `wavelength_nm` is found in a column of wavelengths,
    /// energies or wavenumbers that names another unit, too.
    const std::vector<double>* find(std::string_view name) const;
    /// @throws ImportError  naming those that there are
    const std::vector<double>& column(std::string_view name) const;
    /// The only column beside the wavelengths. @throws ImportError  where there are several
    std::size_t spectrum() const;
    /// Shares of 1, of a column in percent too. @throws ImportError  above `largest`
    std::vector<double> fractions(std::size_t column, double largest) const;
    /// The number in a comment "name: X"; nothing where there is none.
    std::optional<double> comment(std::string_view name) const;

    /// Names the line of a row.
    [[noreturn]] void refuse(std::size_t row, const std::string& reason) const;
    [[noreturn]] void refuse(const std::string& reason) const;

  private:
    std::string path_;
    std::vector<std::string> names_;
    std::vector<std::vector<double>> columns_;
    std::vector<int> lines_;
    std::size_t wavelength_column_ = 0;
    std::vector<double> wavelength_nm_;
    std::vector<std::string> comments_;
};

}  // namespace miebrdf::materials
