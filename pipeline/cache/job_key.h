// A key identifies a computation, so that its result can be found again.
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/cache/fields.h"

namespace miebrdf {

/// The text that identifies a job: everything its result depends on, in a fixed order, numbers to
/// the last bit. Two jobs are the same if and only if their texts are.
class JobKey {
  public:
    /// @param kind  which computation; the solver's version is part of it
    explicit JobKey(std::string_view kind);

    JobKey& add(std::string_view text);
    JobKey& add(std::span<const double> numbers);
    JobKey& add(const std::vector<double>& numbers) { return add(std::span(numbers)); }
    JobKey& add(const std::string& text) { return add(std::string_view(text)); }
    JobKey& add(const char* text) { return add(std::string_view(text)); }
    template <typename T>
    JobKey& add(const std::vector<T>& list) {
        add(list.size());
        for (const T& value : list) add(value);
        return *this;
    }

    /// Numbers, truth values and enumerations.
    template <typename T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) JobKey& add(T value) {
        const auto number = static_cast<double>(value);
        return add(std::span<const double>(&number, 1));
    }
    JobKey& add(mie::SizeDistributionKind kind) { return add(std::string_view(name_of(kind))); }
    JobKey& add(std::complex<double> value) { return add(value.real()).add(value.imag()); }
    template <typename T>
    JobKey& add(const std::optional<T>& value) {
        add(value.has_value());
        return value ? add(*value) : *this;
    }
    template <HasFields T>
    JobKey& add(const T& value) {
        std::apply([this](const auto&... field) { (this->add(field), ...); }, fields(value));
        return *this;
    }

    /// SHA-256 of the text, in hexadecimal.
    std::string hash() const;

  private:
    std::string bytes_;
};

}  // namespace miebrdf
