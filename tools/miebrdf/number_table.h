// Columns of numbers by name: CSV with a header, as results and measurements come.
#pragma once

#include <string>
#include <vector>

namespace miebrdf::program {

class NumberTable {
  public:
    /// Lines that begin with # are comments; an empty field is not a number (NaN).
    /// @throws InputError  for a file that cannot be read, rows of other lengths than the header,
    ///         fields that are no numbers, and a table without rows
    explicit NumberTable(const std::string& path);

    /// Null where there is no such column.
    const std::vector<double>* find(const std::string& name) const;
    const std::vector<std::string>& names() const { return names_; }
    const std::string& path() const { return path_; }

  private:
    std::string path_;
    std::vector<std::string> names_;
    std::vector<std::vector<double>> columns_;
};

}  // namespace miebrdf::program
