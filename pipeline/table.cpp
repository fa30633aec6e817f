#include "pipeline/table.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <ostream>

namespace miebrdf {
namespace {

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

nlohmann::ordered_json json_of(const Cell& cell) {
    if (const auto* number = std::get_if<double>(&cell)) {
        if (!std::isfinite(*number)) return nullptr;  // JSON has neither NaN nor infinity
        return *number;
    }
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    return nullptr;
}

}  // namespace

void write_csv(const Table& table, std::ostream& out) {
    for (const auto& [name, value] : table.facts) {
        std::string line = value;
        for (char& c : line) {
            if (c == '\n' || c == '\r') c = ' ';
        }
        out << "# " << name << ": " << line << '\n';
    }
    fmt::memory_buffer line;
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        if (i > 0) line.push_back(',');
        append_text(line, table.columns[i]);
    }
    line.push_back('\n');
    for (const auto& row : table.rows) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (i > 0) line.push_back(',');
            append_cell(line, row[i]);
        }
        line.push_back('\n');
        out.write(line.data(), static_cast<std::streamsize>(line.size()));
        line.clear();
    }
    out.write(line.data(), static_cast<std::streamsize>(line.size()));
}

void write_json(const Table& table, std::ostream& out) {
    nlohmann::ordered_json json;
    auto& facts = json["facts"] = nlohmann::ordered_json::object();
    for (const auto& [name, value] : table.facts) {
        if (!facts.contains(name)) {
            facts[name] = value;
        } else {  // a fact may repeat (several sources): then it is a list
            if (!facts[name].is_array()) facts[name] = nlohmann::ordered_json::array({facts[name]});
            facts[name].push_back(value);
        }
    }
    json["columns"] = table.columns;
    auto& rows = json["rows"] = nlohmann::ordered_json::array();
    for (const auto& row : table.rows) {
        nlohmann::ordered_json fields = nlohmann::ordered_json::array();
        for (const Cell& cell : row) fields.push_back(json_of(cell));
        rows.push_back(std::move(fields));
    }
    out << json.dump(1) << '\n';
}

}  // namespace miebrdf
