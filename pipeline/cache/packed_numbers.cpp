#include "pipeline/cache/packed_numbers.h"

#include <stdexcept>

namespace miebrdf {

NumberPacker& NumberPacker::add(const std::vector<double>& numbers) {
    numbers_.push_back(static_cast<double>(numbers.size()));
    numbers_.insert(numbers_.end(), numbers.begin(), numbers.end());
    return *this;
}

NumberPacker& NumberPacker::add(const std::string& text) {
    return add(std::vector<double>(text.begin(), text.end()));
}

double NumberUnpacker::number() {
    if (next_ >= numbers_.size()) throw std::runtime_error("stored result is too short");
    return numbers_[next_++];
}

std::size_t NumberUnpacker::count() {
    const double size = number();
    if (!(size >= 0.0 && size <= static_cast<double>(numbers_.size() - next_))) {
        throw std::runtime_error("stored result is too short");
    }
    return static_cast<std::size_t>(size);
}

void NumberUnpacker::read(std::vector<double>& numbers) {
    const std::size_t size = count();
    const auto first = numbers_.begin() + static_cast<std::ptrdiff_t>(next_);
    next_ += size;
    numbers.assign(first, first + static_cast<std::ptrdiff_t>(size));
}

void NumberUnpacker::read(std::string& text) {
    std::vector<double> codes;
    read(codes);
    text.clear();
    for (const double code : codes) text.push_back(static_cast<char>(code));
}

void NumberUnpacker::read(std::complex<double>& value) {
    const double real = number();
    value = {real, number()};
}

}  // namespace miebrdf
