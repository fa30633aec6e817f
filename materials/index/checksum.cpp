#include "materials/index/checksum.h"

#include <fmt/format.h>
#include <sodium/crypto_hash_sha256.h>

#include <array>
#include <bit>
#include <cstdint>

namespace miebrdf::materials {

std::string sha256_hex(std::string_view bytes) {
    std::array<unsigned char, crypto_hash_sha256_BYTES> digest{};
    crypto_hash_sha256(digest.data(), reinterpret_cast<const unsigned char*>(bytes.data()),
                       bytes.size());
    return fmt::format("{:02x}", fmt::join(digest, ""));
}

std::string to_bytes(const std::vector<double>& values) {
    std::string bytes;
    bytes.reserve(values.size() * 8);
    for (const double value : values) {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        for (int shift = 0; shift < 64; shift += 8)
            bytes += static_cast<char>(bits >> shift & 0xff);
    }
    return bytes;
}

std::vector<double> from_bytes(const void* bytes, std::size_t size) {
    const auto* byte = static_cast<const unsigned char*>(bytes);
    std::vector<double> values(size / 8);
    for (std::size_t i = 0; i < values.size(); ++i) {
        std::uint64_t bits = 0;
        for (int j = 7; j >= 0; --j) bits = bits << 8 | byte[8 * i + static_cast<std::size_t>(j)];
        values[i] = std::bit_cast<double>(bits);
    }
    return values;
}

std::string content_sha256(const Dataset& dataset) {
    std::string bytes;
    for (const auto* series : {&dataset.n, &dataset.k}) {
        if (!*series) {
            bytes += "unknown;";
            continue;
        }
        const Series& s = **series;
        bytes +=
            fmt::format("formula {} {} {} {};", s.formula, name_of(s.unit), s.x.size(), s.y.size());
        bytes += to_bytes({s.shortest_nm, s.longest_nm});
        bytes += to_bytes(s.x);
        bytes += to_bytes(s.y);
    }
    return sha256_hex(bytes);
}

}  // namespace miebrdf::materials
