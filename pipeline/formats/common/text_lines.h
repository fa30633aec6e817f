// Lines and numbers of text formats; numbers as std::from_chars reads them, in no locale.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <string>
#include <string_view>
#include <vector>

#include <miebrdf/error.h>

namespace miebrdf {

/// Hands out lines without their ends ("\n" or "\r\n") and knows where it is.
class TextLines {
  public:
    TextLines(std::string_view text, std::string format)
        : text_(text), format_(std::move(format)) {}

    bool next(std::string_view& line) {
        if (position_ >= text_.size()) return false;
        std::size_t end = text_.find('\n', position_);
        if (end == text_.npos) end = text_.size();
        line = text_.substr(position_, end - position_);
        if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
        position_ = end + 1;
        ++number_;
        return true;
    }

    /// The text after the last line handed out.
    std::string_view rest() const {
        return position_ < text_.size() ? text_.substr(position_) : std::string_view();
    }

    [[noreturn]] void refuse(const std::string& reason) const {
        throw InputError(fmt::format("{}, line {}: {}", format_, number_, reason));
    }

    double number(std::string_view text) const {
        while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
        while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
        double value = 0.0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (text.empty() || error != std::errc() || end != text.data() + text.size()) {
            refuse(fmt::format("'{}' is no number", text.substr(0, 40)));
        }
        return value;
    }

    /// Numbers between any of `separators`.
    std::vector<double> numbers(std::string_view text, std::string_view separators) const {
        std::vector<double> values;
        std::size_t position = text.find_first_not_of(separators);
        while (position != text.npos) {
            const std::size_t end = std::min(text.find_first_of(separators, position), text.size());
            values.push_back(number(text.substr(position, end - position)));
            position = text.find_first_not_of(separators, end);
        }
        return values;
    }

  private:
    std::string_view text_;
    std::string format_;
    std::size_t position_ = 0;
    int number_ = 0;
};

}  // namespace miebrdf
