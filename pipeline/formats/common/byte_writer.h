// Little-endian numbers into a stream, whatever the machine's own byte order is.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <ostream>
#include <span>
#include <string_view>
#include <vector>

namespace miebrdf {

class ByteWriter {
  public:
    explicit ByteWriter(std::ostream& out) : out_(out) {}

    template <std::unsigned_integral Integer>
    void put(Integer value) {
        char bytes[sizeof(Integer)];
        for (std::size_t i = 0; i < sizeof(Integer); ++i) {
            bytes[i] = static_cast<char>((value >> (8 * i)) & 0xff);
        }
        out_.write(bytes, sizeof(Integer));
    }
    void put(std::int32_t value) { put(static_cast<std::uint32_t>(value)); }
    void put(float value) { put(std::bit_cast<std::uint32_t>(value)); }
    void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }

    template <typename Number>
    void put_all(std::span<const Number> numbers) {
        if constexpr (std::endian::native == std::endian::little) {
            out_.write(reinterpret_cast<const char*>(numbers.data()),
                       static_cast<std::streamsize>(numbers.size_bytes()));
        } else {
            for (const Number number : numbers) put(number);
        }
    }
    template <typename Number>
    void put_all(const std::vector<Number>& numbers) {
        put_all(std::span<const Number>(numbers));
    }

    void put_text(std::string_view text) {
        out_.write(text.data(), static_cast<std::streamsize>(text.size()));
    }
    void put_zeros(std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) out_.put('\0');
    }

  private:
    std::ostream& out_;
};

}  // namespace miebrdf
