// Runs the miebrdf program as a user would and keeps what it said.
#pragma once

#include <string>
#include <vector>

namespace miebrdf::support {

struct ProgramRun {
    int exit_code = -1;
    std::string out;
    std::string err;
};

/// @param arguments  as typed after `miebrdf`, read by /bin/sh
/// @param environment  put before the program, e.g. "MIEBRDF_DATABASE=x.db"
ProgramRun run_program(const std::string& arguments, const std::string& environment = {});

/// Names of the subcommands in a help text.
std::vector<std::string> commands_in(const std::string& help);

/// The rows of a CSV output by column name, '#' lines left out.
class CsvOutput {
  public:
    explicit CsvOutput(const std::string& text);
    std::size_t size() const { return rows_.size(); }
    const std::vector<std::string>& columns() const { return columns_; }
    const std::string& text(std::size_t row, const std::string& column) const;
    double number(std::size_t row, const std::string& column) const;

  private:
    std::vector<std::string> columns_;
    std::vector<std::vector<std::string>> rows_;
};

}  // namespace miebrdf::support
