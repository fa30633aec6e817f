#include "tests/support/program.h"

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

#include "tests/support/temporary_folder.h"

namespace miebrdf::support {

ProgramRun run_program(const std::string& arguments, const std::string& environment) {
    const TemporaryFolder folder;
    // A cache of its own: no test may pass because an older program was right.
    const std::string command = "XDG_CACHE_HOME='" + folder.path().string() + "' " + environment +
                                " '" MIEBRDF_PROGRAM "' " + arguments + " >'" + (folder / "out") +
                                "' 2>'" + (folder / "err") + "' </dev/null";
    const int status = std::system(command.c_str());
    ProgramRun run;
    run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    run.out = read_file(folder / "out");
    run.err = read_file(folder / "err");
    return run;
}

std::vector<std::string> commands_in(const std::string& help) {
    std::vector<std::string> names;
    std::istringstream lines(help.substr(std::min(help.find("Subcommands:"), help.size())));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line) && line.rfind("  ", 0) == 0) {
        // Long descriptions go on below, further to the right.
        if (line[2] != ' ') names.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
    return names;
}

CsvOutput::CsvOutput(const std::string& text) {
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line)) {
        if (line.empty() || line[0] == '#') continue;
        std::vector<std::string> fields;
        std::string field;
        std::istringstream stream(line);
        while (std::getline(stream, field, ',')) fields.push_back(field);
        if (line.back() == ',') fields.emplace_back();
        if (columns_.empty()) {
            columns_ = std::move(fields);
        } else {
            rows_.push_back(std::move(fields));
        }
    }
}

const std::string& CsvOutput::text(std::size_t row, const std::string& column) const {
    const auto found = std::find(columns_.begin(), columns_.end(), column);
    if (found == columns_.end()) throw std::runtime_error("no column " + column);
    return rows_.at(row).at(static_cast<std::size_t>(found - columns_.begin()));
}

double CsvOutput::number(std::size_t row, const std::string& column) const {
    return std::stod(text(row, column));
}

}  // namespace miebrdf::support
