// SOPRA .nk: `code min max intervals`, then intervals + 1 pairs n k on a uniform grid.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "materials/index/units.h"
#include "materials/readers/file_format.h"
#include "materials/readers/text_table.h"

namespace miebrdf::materials {
namespace {

constexpr std::string_view kSeparators = " \t\r\n\f\v;,";

/// The stream of words of the file, each with its line. DOS files end at Ctrl-Z.
class Words {
  public:
    explicit Words(std::string_view text, std::string_view separators = kSeparators)
        : text_(text.substr(0, text.find('\x1a'))), separators_(separators) {}

    /// The next word, empty at the end.
    std::string_view next() {
        while (at_ < text_.size() && separates(text_[at_])) {
            if (text_[at_] == '\n') ++line_;
            ++at_;
        }
        const std::size_t start = at_;
        while (at_ < text_.size() && !separates(text_[at_])) ++at_;
        return text_.substr(start, at_ - start);
    }

    int line() const { return line_; }

  private:
    bool separates(char c) const { return separators_.find(c) != std::string_view::npos; }

    std::string_view text_, separators_;
    std::size_t at_ = 0;
    int line_ = 1;
};

struct SopraHeader {
    int code = 0;
    double first = 0.0, last = 0.0;
    int intervals = 0;
};

std::optional<SopraHeader> read_sopra_header(Words& words) {
    const auto code = table_number(words.next());
    const auto first = table_number(words.next());
    const auto last = table_number(words.next());
    const auto intervals = table_number(words.next());
    if (!code || !first || !last || !intervals) return std::nullopt;
    if (!(*code >= 1 && *code <= 4 && *code == std::floor(*code))) return std::nullopt;
    if (!(*first > 0 && *last > *first && std::isfinite(*last))) return std::nullopt;
    if (!(*intervals >= 1 && *intervals < kMostRows && *intervals == std::floor(*intervals))) {
        return std::nullopt;
    }
    return SopraHeader{static_cast<int>(*code), *first, *last, static_cast<int>(*intervals)};
}

Unit unit_of(int code) {
    switch (code) {
        case 1:
            return Unit::electronvolt;
        case 2:
            return Unit::micrometre;
        case 3:
            return Unit::per_centimetre;
        default:
            return Unit::nanometre;
    }
}

// The collection's INAS.NK declares micrometres for a grid of photon energies; read as eV it is the
// table of Aspnes & Studna, Phys. Rev. B 27, 985 (1983). Recognised by its header and first row, so
// that a renamed copy is read right and nothing else is touched.
bool is_mislabelled_inas(const SopraHeader& header, const RawTable& table) {
    return header.code == 2 && header.first == 1 && header.last == 6 && header.intervals == 200 &&
           table.rows.front().n == 3.548 && table.rows.front().k == 0.278;
}

// Commas separate numbers or are decimal. They are decimal where the numbers between blanks are as
// many as the header announces; and where they are fewer, but none has a point and some a comma.
Words words_of(std::string_view text) {
    const std::string_view blanks = kSeparators.substr(0, kSeparators.size() - 1);
    Words words(text, blanks);
    const auto header = read_sopra_header(words);
    if (!header) return Words(text);
    int missing = 2 * (header->intervals + 1);
    bool has_points = false, has_commas = false;
    for (std::string_view word = words.next(); missing > 0 && table_number(word);
         word = words.next()) {
        has_points = has_points || word.find('.') != word.npos;
        has_commas = has_commas || word.find(',') != word.npos;
        --missing;
    }
    const bool are_decimal = missing == 0 || (has_commas && !has_points);
    return are_decimal ? Words(text, blanks) : Words(text);
}

// The announced rows are followed by surplus numbers, or by words such as "Dispersion law".
void read_trailer(Words& words, Dataset& dataset, int announced, const std::string& file) {
    std::string remark;
    int surplus = 0;
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
        if (remark.empty() && table_number(word)) {
            ++surplus;
        } else if (remark.size() < 500) {
            remark += (remark.empty() ? "" : " ") + std::string(word);
        }
    }
    if (surplus >= announced) {
        throw ImportError(file, words.line(),
                          fmt::format("{} numbers follow the {} that the header announces; decimal "
                                      "commas need blanks between the numbers",
                                      surplus, announced));
    }
    if (surplus > 0) {
        dataset.corrections.push_back(
            fmt::format("{} numbers after the last announced row ignored", surplus));
    }
    dataset.note = remark;
}

bool looks_like_sopra(std::string_view text) {
    Words words = words_of(text);
    if (!read_sopra_header(words)) return false;
    return table_number(words.next()) && table_number(words.next());
}

Dataset read_sopra(const SourceFile& source, const ReadOptions& options) {
    const std::string file = source.path.string();
    Words words = words_of(source.text);
    const std::optional<SopraHeader> header = read_sopra_header(words);
    if (!header) {
        throw ImportError(
            file, 1,
            "no SOPRA header: expected a unit code 1-4, first, last and the number of "
            "intervals");
    }
    Dataset dataset;
    dataset.format = "sopra";
    dataset.source = "SOPRA";
    dataset.licence = "unclear: SOPRA S.A. published its tables without a licence";
    RawTable table;
    table.unit = unit_of(header->code);
    for (int i = 0; i <= header->intervals; ++i) {
        RawRow row;
        // Both ends exactly as printed; between them the grid is uniform in its unit.
        row.x = i == header->intervals
                    ? header->last
                    : header->first + (header->last - header->first) * i / header->intervals;
        for (double* value : {&row.n, &row.k}) {
            const std::string_view word = words.next();
            if (word.empty()) {
                throw ImportError(
                    file, words.line(),
                    fmt::format("ends after {} of the {} rows that its header announces", i,
                                header->intervals + 1));
            }
            row.line = words.line();
            const auto number = table_number(word);
            if (!number) {
                throw ImportError(file, row.line,
                                  fmt::format("'{}' is not a number", word.substr(0, 40)));
            }
            *value = *number;
        }
        table.rows.push_back(row);
    }
    if (is_mislabelled_inas(*header, table)) {
        table.unit = Unit::electronvolt;
        dataset.corrections.push_back("header says um, but the grid is photon energy: read as eV");
    }
    read_trailer(words, dataset, 2 * (header->intervals + 1), file);
    add_table(dataset, std::move(table), file, options);
    return dataset;
}

int sopra_code(const Dataset& d, Unit unit) {
    switch (unit) {
        case Unit::electronvolt:
            return 1;
        case Unit::micrometre:
            return 2;
        case Unit::per_centimetre:
            return 3;
        case Unit::nanometre:
            return 4;
        default:
            refuse_export(d, "sopra", fmt::format("it has no unit {}", name_of(unit)));
    }
}

std::vector<ExportFile> write_sopra(const Dataset& d, const ExportOptions& options) {
    const JointTable table = joint_table(d, "sopra", options);
    const std::size_t count = table.n.x.size();
    const auto ascending = [&](std::size_t i) {  // in the unit, as the format wants it
        return is_reciprocal(table.n.unit) ? count - 1 - i : i;
    };
    if (count < 2) refuse_export(d, "sopra", "it needs two rows");
    const double first = table.n.x[ascending(0)];
    const double last = table.n.x[ascending(count - 1)];
    const int intervals = static_cast<int>(count) - 1;
    std::string text =
        fmt::format("{} {} {} {}\r\n", sopra_code(d, table.n.unit), first, last, intervals);
    for (int i = 0; i <= intervals; ++i) {
        const std::size_t row = ascending(static_cast<std::size_t>(i));
        const double expected = i == intervals ? last : first + (last - first) * i / intervals;
        // Decimal steps (0.36, 0.365, ...) are rounded one by one: the reader's grid differs from
        // them by units in the last place, not by a step.
        const double rounding = 4 * std::numeric_limits<double>::epsilon() * std::max(first, last);
        if (!(std::abs(table.n.x[row] - expected) <= rounding)) {
            refuse_export(d, "sopra",
                          fmt::format("its grid is not uniform ({} {} where {} is expected)",
                                      table.n.x[row], name_of(table.n.unit), expected));
        }
        fmt::format_to(std::back_inserter(text), "{} {}\r\n", table.n.y[row], table.k[row]);
    }
    return {{".nk", std::move(text)}};
}

}  // namespace

extern const FileFormat kSopra;
constinit const FileFormat kSopra{
    .name = "sopra",
    .other_name = "nk",
    .title = "SOPRA",
    .endings = {".nk"},
    .caseless_names = true,
    .looks_like = looks_like_sopra,
    .read = read_sopra,
    .write = write_sopra,
};

}  // namespace miebrdf::materials
