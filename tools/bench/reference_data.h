// Tables of tests/reference, carried by the program so that it can judge itself anywhere.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace miebrdf::bench {

/// A CSV table with '#' comments and one header line.
class ReferenceData {
  public:
    /// @param name  path relative to tests/reference
    /// @throws std::logic_error  for a table that was not built in
    explicit ReferenceData(const std::string& name);

    std::size_t size() const { return rows_.size(); }
    const std::string& text(std::size_t row, const std::string& column) const;
    double number(std::size_t row, const std::string& column) const;

  private:
    std::map<std::string, std::size_t> columns_;
    std::vector<std::vector<std::string>> rows_;
};

/// Text of a built-in table; nullptr if there is none of this name.
const char* built_in_table(const std::string& name);

}  // namespace miebrdf::bench
