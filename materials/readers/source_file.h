// Files on disk, as the readers want them.
#pragma once

#include <filesystem>
#include <string>

namespace miebrdf::materials {

struct SourceFile {
    std::filesystem::path path;
    std::string text;    ///< of a .k.spd without its .eta.spd: empty
    std::string k_text;  ///< of the .k.spd beside an .eta.spd
};

/// @throws ImportError  when it cannot be read, or is larger than 256 MiB
std::string read_text(const std::filesystem::path& file);
SourceFile read_source(const std::filesystem::path& file);

/// "dir/X.eta.spd" and "dir/X.k.spd" -> "dir/X"; any other path unchanged.
std::filesystem::path spd_base(const std::filesystem::path& file);

/// The file's name without folder and extension: "GAP.NK" -> "GAP", "Ag.eta.spd" -> "Ag".
std::string source_stem(const std::filesystem::path& file);

}  // namespace miebrdf::materials
