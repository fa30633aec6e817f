// SHA-256 (FIPS 180-4) of source files and of stored figures.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <miebrdf/index.h>

namespace miebrdf::materials {

/// 64 lower-case hexadecimal digits.
std::string sha256_hex(std::string_view bytes);

/// Checksum of the figures alone: the same table in two files has the same checksum.
std::string content_sha256(const Dataset& dataset);

/// Little-endian doubles, as they are stored and summed.
std::string to_bytes(const std::vector<double>& values);
std::vector<double> from_bytes(const void* bytes, std::size_t size);

}  // namespace miebrdf::materials
