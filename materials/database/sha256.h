// SHA-256 (FIPS 180-4): checksums of source files and of stored figures.
#pragma once

#include <string>
#include <string_view>

namespace miebrdf::materials {

/// 64 lower-case hexadecimal digits.
std::string sha256_hex(std::string_view bytes);

}  // namespace miebrdf::materials
