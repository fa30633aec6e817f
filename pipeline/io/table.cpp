#include "pipeline/io/table.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <ostream>

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
        if (!std::isnan(*number)) fmt::format_to(std::back_inserter(line), "{}", *number);
    } else if (const auto* text = std::get_if<std::string>(&cell)) {
        append_text(line, *text);
    }
}

/// A header line and rows, each after `prefix`; nothing when there are no columns.
void write_rows(const std::vector<std::string>& columns, const std::vector<std::vector<Cell>>& rows,
                std::string_view prefix, std::ostream& out) {
    if (columns.empty()) return;
    fmt::memory_buffer lines;
    const auto append_line = [&](const auto& fields, const auto& append_field) {
        lines.append(prefix);
        for (std::size_t i = 0; i < fields.size(); ++i) {
            if (i > 0) lines.push_back(',');
            append_field(lines, fields[i]);
        }
        lines.push_back('\n');
        if (lines.size() < kWrittenAtOnce) return;
        out.write(lines.data(), static_cast<std::streamsize>(lines.size()));
        lines.clear();
    };
    append_line(columns, append_text);
    for (const auto& row : rows) append_line(row, append_cell);
    out.write(lines.data(), static_cast<std::streamsize>(lines.size()));
}

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
        std::string line = text_of(value);
        for (char& c : line) {
            if (c == '\n' || c == '\r') c = ' ';
        }
        out << "# " << name << ": " << line << '\n';
    }
    write_rows(table.report_columns, table.report, "# report: ", out);
    write_rows(table.columns, table.rows, "", out);
}

void write_json(const Table& table, std::ostream& out) {
    nlohmann::ordered_json json;
    auto& facts = json["facts"] = nlohmann::ordered_json::object();
    for (const auto& [name, value] : table.facts) {
        if (!facts.contains(name)) {
            facts[name] = json_of(value);
        } else {  // a fact may repeat (several sources): then it is a list
            if (!facts[name].is_array()) facts[name] = nlohmann::ordered_json::array({facts[name]});
            facts[name].push_back(json_of(value));
        }
    }
    json["columns"] = table.columns;
    auto& rows = json["rows"] = nlohmann::ordered_json::array();
    for (const auto& row : table.rows) {
        nlohmann::ordered_json fields = nlohmann::ordered_json::array();
        for (const Cell& cell : row) fields.push_back(json_of(cell));
        rows.push_back(std::move(fields));
    }
    for (const auto& row : table.report) {
        nlohmann::ordered_json object;
        for (std::size_t i = 0; i < row.size(); ++i)
            object[table.report_columns[i]] = json_of(row[i]);
        json["report"].push_back(std::move(object));
    }
    out << json.dump(1) << '\n';
}

}  // namespace miebrdf
