#include "tools/bench/reference_data.h"

#include <sstream>
#include <stdexcept>

namespace miebrdf::bench {
namespace {

std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
    if (!line.empty() && line.back() == ',') fields.emplace_back();
    return fields;
}

}  // namespace

ReferenceData::ReferenceData(const std::string& name) {
    const char* text = built_in_table(name);
    if (text == nullptr) throw std::logic_error("no built-in reference table " + name);
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        if (line.empty() || line[0] == '#') continue;
        auto fields = split(line);
        if (columns_.empty()) {
            for (std::size_t i = 0; i < fields.size(); ++i) columns_[fields[i]] = i;
        } else {
            rows_.push_back(std::move(fields));
        }
    }
}

const std::string& ReferenceData::text(std::size_t row, const std::string& column) const {
    return rows_.at(row).at(columns_.at(column));
}

double ReferenceData::number(std::size_t row, const std::string& column) const {
    return std::stod(text(row, column));
}

}  // namespace miebrdf::bench
