// Little-endian numbers out of bytes that may be anything; never beyond their end.
#pragma once

#include <fmt/format.h>

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include <miebrdf/error.h>

namespace miebrdf {

/// Little-endian numbers where they lie in a file, at any alignment.
template <std::floating_point Real>
class RealView {
  public:
    RealView() = default;
    explicit RealView(std::string_view bytes) : bytes_(bytes) {}
    std::size_t size() const { return bytes_.size() / sizeof(Real); }
    Real operator[](std::size_t i) const {
        static_assert(std::endian::native == std::endian::little);
        Real value;
        std::memcpy(&value, bytes_.data() + i * sizeof(Real), sizeof(Real));
        return value;
    }
    RealView part(std::size_t first, std::size_t count) const {
        return RealView(bytes_.substr(first * sizeof(Real), count * sizeof(Real)));
    }

  private:
    std::string_view bytes_;
};

class ByteReader {
  public:
    explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

    std::size_t remaining() const { return bytes_.size() - position_; }

    /// @throws InputError  when fewer bytes are left
    std::string_view take(std::uint64_t count) {
        if (count > remaining()) {
            throw InputError(fmt::format("the file ends {} bytes early (at byte {})",
                                         count - remaining(), bytes_.size()));
        }
        const std::string_view part = bytes_.substr(position_, count);
        position_ += count;
        return part;
    }

    void seek(std::uint64_t position) {
        if (position > bytes_.size()) {
            throw InputError(
                fmt::format("the file points to byte {} but has {}", position, bytes_.size()));
        }
        position_ = position;
    }

    template <std::unsigned_integral Integer>
    Integer number() {
        const std::string_view bytes = take(sizeof(Integer));
        Integer value = 0;
        for (std::size_t i = 0; i < sizeof(Integer); ++i) {
            value |= static_cast<Integer>(static_cast<Integer>(static_cast<unsigned char>(bytes[i]))
                                          << (8 * i));
        }
        return value;
    }

    /// `count` floats or doubles, where they are. @throws InputError  unless they are all there
    template <std::floating_point Real>
    RealView<Real> view(std::uint64_t count) {
        if (count > remaining() / sizeof(Real)) {
            throw InputError(
                fmt::format("{} numbers announced, {} bytes left", count, remaining()));
        }
        return RealView<Real>(take(count * sizeof(Real)));
    }

    /// A copy of them.
    template <std::floating_point Real>
    std::vector<Real> reals(std::uint64_t count) {
        const RealView<Real> numbers = view<Real>(count);
        std::vector<Real> values(count);
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = numbers[i];
        return values;
    }

  private:
    std::string_view bytes_;
    std::size_t position_ = 0;
};

}  // namespace miebrdf
