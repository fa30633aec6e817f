// A result as rows and columns, and the two ways to write it.
#pragma once

#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace miebrdf {

/// One field of a table. The empty state is "no value": an empty CSV field, a JSON null.
using Cell = std::variant<std::monostate, double, std::string>;
/// Empty where there is no value.
inline Cell cell_of(const std::optional<double>& value) { return value ? Cell(*value) : Cell(); }

/// Rows that exist only while they are written: a cell of a stored row takes 40 bytes, ten million
/// rows of them several GB.
struct RowSource {
    std::size_t count = 0;
    /// Puts the cells of one row into `row`, which holds those of the row before. Asked for in
    /// order, each once.
    std::function<void(std::size_t index, std::vector<Cell>& row)> fill = {};
};

struct Table {
    /// Facts about the whole table, in order: version, command, units, sources, reports.
    std::vector<std::pair<std::string, Cell>> facts = {};
    std::vector<std::string> columns = {};
    std::vector<std::vector<Cell>> rows = {};
    RowSource more_rows = {};  ///< written after `rows`
    /// A second, small table about the first: how each part of it came about. May be empty.
    std::vector<std::string> report_columns = {};
    std::vector<std::vector<Cell>> report = {};
};

/// A number to `digits` significant digits: estimates have no more.
double rounded(double value, int digits);

/// `# name: value` lines, the report as `# report: a,b` lines, a header line, rows; numbers in the
/// shortest form that reads back to the same double. Text that needs it is quoted (RFC 4180).
/// Not-a-number becomes an empty field. Written piece by piece: the text is never held whole.
void write_csv(const Table& table, std::ostream& out);

/// One object: the facts under "facts", then "columns" and "rows", and the
/// report as "report", one object a row. Not-a-number becomes null. Written piece by piece too.
void write_json(const Table& table, std::ostream& out);

}  // namespace miebrdf
