// What can go wrong with names, files and databases of optical constants.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace miebrdf::materials {

/// The file is no database of ours, damaged, of a newer version, locked, or cannot be written.
class DatabaseError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The file's bytes are no database, or no longer a whole one: trying again cannot help.
class DamagedDatabase : public DatabaseError {
  public:
    using DatabaseError::DatabaseError;
};

/// No material has the name, or several do; `candidates` are the names that would have been known.
class UnknownMaterial : public std::runtime_error {
  public:
    UnknownMaterial(const std::string& message, std::string asked,
                    std::vector<std::string> candidate_names)
        : std::runtime_error(message),
          name(std::move(asked)),
          candidates(std::move(candidate_names)) {}

    std::string name;
    std::vector<std::string> candidates;  ///< nearest first; may be empty
};

/// A file of optical constants that cannot be read or accepted.
class ImportError : public std::runtime_error {
  public:
    /// @param line  counted from 1; 0 when the reason concerns the whole file
    ImportError(const std::string& file, int line, const std::string& reason)
        : std::runtime_error(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " + reason),
          line_(line),
          reason_(reason) {}

    int line() const { return line_; }
    const std::string& reason() const { return reason_; }

  private:
    int line_;
    std::string reason_;
};

}  // namespace miebrdf::materials
