#include "pipeline/io/table.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>
#include <ostream>

#include "materials/readers/text.h"

namespace miebrdf {
namespace {

constexpr std::size_t kWrittenAtOnce = 1 << 16;

void append_text(fmt::memory_buffer& line, const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) {
        line.append(text);
        return;
    }
    line.push_back('"');
    for (const char c : text) {
        if (c == '"') line.push_back('"');
        line.push_back(c);
    }
    line.push_back('"');
}

void append_cell(fmt::memory_buffer& line, const Cell& cell) {
    if (const auto* number = std::get_if<double>(&cell)) {
        if (!std::isnan(*number))
            fmt::format_to(std::back_inserter(line), FMT_COMPILE("{}"), *number);
    } else if (const auto* text = std::get_if<std::string>(&cell)) {
        append_text(line, *text);
    }
}

/// Text that goes out whenever enough of it has come together.
class Pieces {
  public:
    explicit Pieces(std::ostream& out) : out_(out) {}
    ~Pieces() { write(); }
    Pieces(const Pieces&) = delete;
    Pieces& operator=(const Pieces&) = delete;

    fmt::memory_buffer& text() { return text_; }
    void write_if_many() {
        if (text_.size() >= kWrittenAtOnce) write();
    }

  private:
    void write() {
        out_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
        text_.clear();
    }

    std::ostream& out_;
    fmt::memory_buffer text_;
};

/// Calls visit(row) for the stored rows and for those that are made now.
template <typename Visit>
void for_each_row(const Table& table, const Visit& visit) {
    for (const auto& row : table.rows) visit(row);
    std::vector<Cell> row;
    for (std::size_t i = 0; i < table.more_rows.count; ++i) {
        table.more_rows.fill(i, row);
        visit(row);
    }
}

void write_names(Pieces& pieces, std::string_view prefix, const std::vector<std::string>& names) {
    fmt::memory_buffer& text = pieces.text();
    text.append(prefix);
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (i > 0) text.push_back(',');
        append_text(text, names[i]);
    }
    text.push_back('\n');
}

/// Writes rows. Numbers take time, and most are those of the row before: their text is kept.
class RowWriter {
  public:
    explicit RowWriter(Pieces& pieces, std::string_view prefix = "")
        : pieces_(pieces), prefix_(prefix) {}

    void write(const std::vector<Cell>& row) {
        fmt::memory_buffer& text = pieces_.text();
        text.append(prefix_);
        before_.resize(std::max(before_.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (i > 0) text.push_back(',');
            const auto* number = std::get_if<double>(&row[i]);
            if (number == nullptr) {
                append_cell(text, row[i]);
            } else {
                text.append(text_of(*number, before_[i]));
            }
        }
        text.push_back('\n');
        pieces_.write_if_many();
    }

  private:
    struct NumberText {
        std::uint64_t bits = 0;
        fmt::memory_buffer text;  ///< empty: no number yet
    };
    static std::string_view text_of(double number, NumberText& before) {
        const auto bits = std::bit_cast<std::uint64_t>(number);
        if (before.text.size() == 0 || before.bits != bits) {
            before.bits = bits;
            before.text.clear();
            append_cell(before.text, number);
        }
        return {before.text.data(), before.text.size()};
    }

    Pieces& pieces_;
    std::string_view prefix_;
    std::vector<NumberText> before_;
};

nlohmann::ordered_json json_of(const Cell& cell) {
    if (const auto* number = std::get_if<double>(&cell)) {
        if (!std::isfinite(*number)) return nullptr;  // JSON has neither NaN nor infinity
        return *number;
    }
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    return nullptr;
}

/// A fact as it stands in a comment line.
std::string text_of(const Cell& cell) {
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    const auto* number = std::get_if<double>(&cell);
    return number == nullptr || std::isnan(*number) ? "" : fmt::format("{}", *number);
}

}  // namespace

double rounded(double value, int digits) {
    return std::stod(fmt::format("{:.{}g}", value, digits));
}

void write_csv(const Table& table, std::ostream& out) {
    for (const auto& [name, value] : table.facts) {
        out << "# " << materials::printable(name) << ": " << materials::printable(text_of(value))
            << '\n';
    }
    Pieces pieces(out);
    if (!table.columns.empty()) {
        write_names(pieces, "", table.columns);
        RowWriter lines(pieces);
        for_each_row(table, [&](const auto& row) { lines.write(row); });
    }
    if (table.report_columns.empty()) return;
    write_names(pieces, "# report: ", table.report_columns);
    RowWriter lines(pieces, "# report: ");
    for (const auto& row : table.report) lines.write(row);
}

// The rows are put between what comes before and after them, as one document would be written with
// an indentation of 1.
void write_json(const Table& table, std::ostream& out) {
    nlohmann::ordered_json head;
    auto& facts = head["facts"] = nlohmann::ordered_json::object();
    for (const auto& [name, value] : table.facts) {
        if (!facts.contains(name)) {
            facts[name] = json_of(value);
        } else {  // a fact may repeat (several sources): then it is a list
            if (!facts[name].is_array()) facts[name] = nlohmann::ordered_json::array({facts[name]});
            facts[name].push_back(json_of(value));
        }
    }
    head["columns"] = table.columns;
    nlohmann::ordered_json tail = nlohmann::ordered_json::object();
    for (const auto& row : table.report) {
        nlohmann::ordered_json object;
        for (std::size_t i = 0; i < row.size(); ++i)
            object[table.report_columns[i]] = json_of(row[i]);
        tail["report"].push_back(std::move(object));
    }
    constexpr std::string_view kEnd = "\n}";
    const std::string before = head.dump(1), after = tail.dump(1);
    out << std::string_view(before).substr(0, before.size() - kEnd.size()) << ",\n \"rows\": [";
    bool is_first = true;
    {
        Pieces pieces(out);
        for_each_row(table, [&](const auto& row) {
            fmt::memory_buffer& text = pieces.text();
            text.append(std::string_view(is_first ? "\n  [" : ",\n  ["));
            for (std::size_t i = 0; i < row.size(); ++i) {
                text.append(std::string_view(i > 0 ? ",\n   " : "\n   "));
                text.append(json_of(row[i]).dump());
            }
            text.append(std::string_view(row.empty() ? "]" : "\n  ]"));
            is_first = false;
            pieces.write_if_many();
        });
    }
    out << (is_first ? "]" : "\n ]");
    if (tail.empty()) {
        out << "\n}\n";
    } else {
        out << ',' << std::string_view(after).substr(1) << '\n';
    }
}

}  // namespace miebrdf
