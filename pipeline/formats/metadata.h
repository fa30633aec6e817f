// What a file of numbers must say besides its numbers, as JSON: inside the file where the format
// has room for it, else in a .json file beside it.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "pipeline/solve/brdf_source.h"

namespace miebrdf::exports {

/// How a format writes what is the same in all of them.
struct Conventions {
    std::string format;  ///< name on the command line
    bool cosine_included =
        false;                 ///< of the stored values; readers' results are BRDFs all the same
    std::string azimuth_zero;  ///< which side the format's azimuth 0 is
    std::string colour;        ///< primaries, illuminant, observer; empty: spectral
};

/// Units, cosine, azimuth zero, wavelengths, colour, version, command line, sources.
nlohmann::ordered_json metadata(const BrdfSource& source, const Conventions& conventions);

/// `file` + ".json".
std::filesystem::path sidecar_path(const std::filesystem::path& file);

/// Writes metadata beside `file`, whole or not at all.
/// @throws InputError
void write_sidecar(const std::filesystem::path& file, const nlohmann::ordered_json& metadata);

}  // namespace miebrdf::exports
