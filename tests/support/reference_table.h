// Tables of reference numbers: CSV with '#' comments and one header line (tests/reference).
#pragma once

#include <map>
#include <string>
#include <vector>

namespace miebrdf::support {

class ReferenceTable {
  public:
    /// @param path  relative to tests/reference, e.g. "mie/single_sphere.csv"
    /// @throws std::runtime_error  when the file is missing or a row has the wrong number of fields
    explicit ReferenceTable(const std::string& path);

    std::size_t size() const { return rows_.size(); }
    const std::string& text(std::size_t row, const std::string& column) const;
    /// @throws std::runtime_error  when the field is not a number
    double number(std::size_t row, const std::string& column) const;
    bool has_column(const std::string& column) const { return columns_.count(column) > 0; }

  private:
    std::string path_;
    std::map<std::string, std::size_t> columns_;
    std::vector<std::vector<std::string>> rows_;
};

}  // namespace miebrdf::support
