// What identifies a computation, so that its result can be found again.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace miebrdf {

/// The text that identifies a job: everything its result depends on, in a fixed order, numbers to
/// the last bit. Two jobs are the same if and only if their texts are.
class JobKey {
  public:
    /// @param kind  which computation; the solver's version is part of it
    explicit JobKey(std::string_view kind);
    JobKey& add(std::string_view text);
    JobKey& add(double number);
    JobKey& add(int number) { return add(static_cast<double>(number)); }
    JobKey& add(bool flag) = delete;  ///< so that no text literal becomes a flag
    JobKey& add(std::span<const double> numbers);
    /// SHA-256 of the text, in hexadecimal.
    std::string hash() const;

  private:
    std::string bytes_;
};

}  // namespace miebrdf
