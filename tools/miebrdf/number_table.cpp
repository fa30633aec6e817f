#include "tools/miebrdf/number_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"

namespace miebrdf::program {

NumberTable::NumberTable(const std::string& path) : path_(path) {
    std::ifstream file(path);
    if (!file) throw InputError(fmt::format("table '{}' cannot be read", path));
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (line.empty() || line[0] == '#') continue;
        const std::vector<std::string> fields = split_list(line);
        if (names_.empty()) {
            names_ = fields;
            columns_.resize(fields.size());
            continue;
        }
        if (fields.size() != names_.size()) {
            throw InputError(fmt::format("table '{}', line {}: {} fields under {} names", path,
                                         number, fields.size(), names_.size()));
        }
        for (std::size_t c = 0; c < fields.size(); ++c) {
            try {
                columns_[c].push_back(fields[c].empty() ? std::numeric_limits<double>::quiet_NaN()
                                                        : parse_number(fields[c], names_[c]));
            } catch (const UsageError& error) {
                throw InputError(
                    fmt::format("table '{}', line {}: {}", path, number, error.what()));
            }
        }
    }
    if (columns_.empty() || columns_[0].empty())
        throw InputError(fmt::format("table '{}' has no rows; the first line names columns", path));
}

const std::vector<double>* NumberTable::find(const std::string& name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    return found == names_.end() ? nullptr : &columns_[std::size_t(found - names_.begin())];
}

}  // namespace miebrdf::program
