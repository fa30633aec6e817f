// The content that readers give a dataset: rows as a file gives them, and what its comments say of
// their origin.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <miebrdf/database.h>

namespace miebrdf::materials {

struct ReadOptions {
    /// Negative k down to this is noise around 0 and set to 0; below it the file is refused. The
    /// largest in the SOPRA collection is 6e-3 (ALSB).
    double negative_k_tolerance = 1e-2;
    /// Rows that are no numbers or not physical are left out and recorded, up to a tenth of all,
    /// instead of refusing the file.
    bool skip_bad_rows = false;
    /// The unit of the first column, where a file does not name it.
    std::optional<Unit> unit{};
};

/// Longer tables are refused: no source has them, and a wrong header could ask for any amount of
/// memory.
inline constexpr std::size_t kMostRows = 1'000'000;

struct RawRow {
    double x = 0.0;  ///< in the table's unit
    double n = 0.0;
    double k = 0.0;
    int line = 0;  ///< of the file, from 1
};

struct RawTable {
    Unit unit = Unit::nanometre;
    bool has_n = true;
    bool has_k = true;
    std::vector<RawRow> rows;
};

/// Rows left out on request.
class BadRows {
  public:
    /// Runs `read`; when it refuses a row and that is asked for, the refusal is kept instead.
    template <typename Read>
    void try_row(const ReadOptions& options, const Read& read) {
        if (!options.skip_bad_rows) return read();
        try {
            read();
        } catch (const ImportError& error) {
            add(error);
        }
    }
    void add(const ImportError& error);
    /// @throws ImportError  the first refusal, when more than a tenth of the rows are bad
    void record(Dataset& dataset, std::size_t good_rows);

  private:
    std::vector<ImportError> refusals_;
};

/// Puts the rows in order of wavelength, drops repeated wavelengths (the first is kept), sets
/// slightly negative k to 0, and adds both series to the dataset; every change is recorded in its
/// corrections.
/// @throws ImportError  naming file and line of a row that is not physical
void add_table(Dataset& dataset, RawTable table, const std::string& file,
               const ReadOptions& options);

/// Rows of wavelength and n, k or both, without a line of names. Remarks may name the unit of the
/// first column; what else they say of the origin goes to its place, all other words into the note.
struct BareColumns {
    char comment = '#';
    Unit unit = Unit::nanometre;  ///< where neither the file nor the options name one
    bool has_n = true, has_k = true;
    std::string_view usual_remark = {};  ///< that says nothing of the origin
    bool takes_remarks = true;           ///< false: another file says the same
};
/// @throws ImportError  for another number of columns, and for words that are no number
void read_bare_columns(Dataset& dataset, std::string_view text, const BareColumns& columns,
                       const std::string& file, const ReadOptions& options);
/// The unit that the file names, else the one asked for, else `by_default`. A contradiction between
/// the first two is recorded.
Unit settle_unit(Dataset& dataset, const std::optional<Unit>& named, const ReadOptions& options,
                 Unit by_default);
/// Puts the words of remarks about the origin to their places, all others into the note.
void take_remarks(Dataset& dataset, const std::vector<std::string>& remarks);
/// True when the first line that is neither empty nor a comment has `count` numbers.
bool first_row_has(std::string_view text, char comment, std::size_t count);

/// Begins the comment lines that carry provenance in formats with '#' comments but no such keys.
inline constexpr std::string_view kProvenanceMark = "# miebrdf ";

/// One line for each thing that is known, without line breaks.
std::vector<std::string> provenance_lines(const Dataset& dataset);

/// Reads one of these lines into the dataset; other lines change nothing.
/// @returns whether it was one
bool read_provenance_line(Dataset& dataset, std::string_view line);

}  // namespace miebrdf::materials
