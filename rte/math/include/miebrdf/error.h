// Errors. Every exception that this library throws is an Error.
#pragma once

#include <charconv>
#include <stdexcept>
#include <string>
#include <utility>

#pragma GCC visibility push(default)
namespace miebrdf {

/// Base of all exceptions. Where one value was at fault, it is named with the field that held it
/// and with what would have been allowed; otherwise these are empty and what() says it all.
class Error : public std::runtime_error {
  public:
    explicit Error(const std::string& message) : std::runtime_error(message) {}
    /// what() reads "FIELD: VALUE is out of range; allowed: ALLOWED".
    Error(std::string field, std::string value, std::string allowed)
        : std::runtime_error(field + ": " + value + " is out of range; allowed: " + allowed),
          field_(std::move(field)),
          value_(std::move(value)),
          allowed_(std::move(allowed)) {}
    Error(std::string field, double value, std::string allowed)
        : Error(std::move(field), shortest(value), std::move(allowed)) {}

    /// With a message of its own, where the value needs more words.
    Error(const std::string& message, std::string field, std::string value, std::string allowed)
        : std::runtime_error(message),
          field_(std::move(field)),
          value_(std::move(value)),
          allowed_(std::move(allowed)) {}

    /// The name of what was wrong, e.g. "mu_in"; may be empty, as may the other two.
    const std::string& field() const { return field_; }
    const std::string& value() const { return value_; }      ///< as given; may be empty
    const std::string& allowed() const { return allowed_; }  ///< what would be right

  private:
    /// The shortest text that reads back to the same number.
    static std::string shortest(double value) {
        char text[32];
        return {text, std::to_chars(text, text + sizeof text, value).ptr};
    }

    std::string field_, value_, allowed_;
};

/// The request itself is wrong: an unknown word, a number out of range, lists that do not fit.
class UsageError : public Error {
    using Error::Error;
};

/// Data that the request points to is missing, damaged, or does not cover it.
class InputError : public Error {
    using Error::Error;
};

/// A computation was stopped on request; nothing was half-written.
class Cancelled : public Error {
  public:
    Cancelled() : Error("cancelled") {}
};

}  // namespace miebrdf
#pragma GCC visibility pop
