#include "tests/support/reference_table.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace miebrdf::support {
namespace {

std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> fields;
    std::string field;
    std::istringstream stream(line);
    while (std::getline(stream, field, ',')) fields.push_back(field);
    if (!line.empty() && line.back() == ',') fields.emplace_back();
    return fields;
}

}  // namespace

ReferenceTable::ReferenceTable(const std::string& path) : path_(path) {
    std::ifstream file(std::string(MIEBRDF_REFERENCE_DIR) + "/" + path);
    if (!file) throw std::runtime_error("no reference table " + path);
    std::string line;
    while (std::getline(file, line)) {
        if (line.empty() || line[0] == '#') continue;
        std::vector<std::string> fields = split(line);
        if (columns_.empty()) {
            for (std::size_t i = 0; i < fields.size(); ++i) columns_[fields[i]] = i;
        } else if (fields.size() != columns_.size()) {
            throw std::runtime_error(fmt::format("{}: {} fields in row '{}', {} columns", path,
                                                 fields.size(), line, columns_.size()));
        } else {
            rows_.push_back(std::move(fields));
        }
    }
}

const std::string& ReferenceTable::text(std::size_t row, const std::string& column) const {
    const auto found = columns_.find(column);
    if (found == columns_.end()) throw std::runtime_error(path_ + ": no column " + column);
    return rows_.at(row)[found->second];
}

double ReferenceTable::number(std::size_t row, const std::string& column) const {
    const std::string& field = text(row, column);
    char* end = nullptr;
    const double value = std::strtod(field.c_str(), &end);
    if (end == field.c_str() || *end != '\0') {
        throw std::runtime_error(
            fmt::format("{}: '{}' in column {} is no number", path_, field, column));
    }
    return value;
}

}  // namespace miebrdf::support
