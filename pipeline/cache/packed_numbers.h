// Values as a row of numbers and back, for the cache and for pickles.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/cache/fields.h"

namespace miebrdf {

class NumberPacker {
  public:
    template <typename T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) NumberPacker& add(T value) {
        numbers_.push_back(static_cast<double>(value));
        return *this;
    }
    NumberPacker& add(const std::vector<double>& numbers);
    NumberPacker& add(const std::string& text);
    NumberPacker& add(std::complex<double> value) { return add(value.real()).add(value.imag()); }
    template <typename T>
    NumberPacker& add(const std::vector<T>& list) {
        add(list.size());
        for (const T& value : list) add(value);
        return *this;
    }
    template <typename T>
    NumberPacker& add(const std::optional<T>& value) {
        add(value.has_value());
        return value ? add(*value) : *this;
    }
    template <HasFields T>
    NumberPacker& add(const T& value) {
        std::apply([this](const auto&... field) { (this->add(field), ...); }, fields(value));
        return *this;
    }

    const std::vector<double>& numbers() const { return numbers_; }
    /// The numbers, which are not kept.
    std::vector<double> take() { return std::move(numbers_); }

  private:
    std::vector<double> numbers_;
};

/// Reads in the order in which they were added.
/// @throws std::runtime_error  when there are fewer numbers than asked for
class NumberUnpacker {
  public:
    explicit NumberUnpacker(const std::vector<double>& numbers) : numbers_(numbers) {}

    template <typename T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void read(T& value) {
        value = static_cast<T>(number());
    }
    void read(std::vector<double>& numbers);
    void read(std::string& text);
    void read(std::complex<double>& value);
    template <typename T>
    void read(std::vector<T>& list) {
        list.resize(count());
        for (T& value : list) read(value);
    }
    template <typename T>
    void read(std::optional<T>& value) {
        bool given = false;
        read(given);
        value.reset();
        if (given) read(value.emplace());
    }
    template <HasFields T>
    void read(T& value) {
        std::apply([this](auto&... field) { (this->read(field), ...); }, fields(value));
    }

  private:
    double number();
    std::size_t count();

    const std::vector<double>& numbers_;
    std::size_t next_ = 0;
};

}  // namespace miebrdf
