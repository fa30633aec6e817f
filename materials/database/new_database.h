// The moment in which a user's database comes into being.
#pragma once

#include <filesystem>

namespace miebrdf::materials {

/// Puts a complete database without materials at `file`, in one step: other processes see no file
/// or all of it, and of several that create it at once the first wins and the others find it there.
/// Does nothing when the file exists, or where the system cannot do this (no unnamed files or hard
/// links, a folder that does not exist or is read-only): then SQLite creates it when it is opened.
/// @throws DatabaseError  when it cannot be written (a full disk); then there is no file
void create_database_file(const std::filesystem::path& file);

}  // namespace miebrdf::materials
