// Numbers out of bytes of a file that is trusted; the machine is little-endian as the files are.
#pragma once

#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace miebrdf::support {

template <typename Number>
std::vector<Number> numbers_at(const std::string& bytes, std::size_t position, std::size_t count) {
    if (position + count * sizeof(Number) > bytes.size())
        throw std::runtime_error("the file is shorter than its layout");
    std::vector<Number> numbers(count);
    if (count > 0) std::memcpy(numbers.data(), bytes.data() + position, count * sizeof(Number));
    return numbers;
}

template <typename Number>
Number number_at(const std::string& bytes, std::size_t position) {
    return numbers_at<Number>(bytes, position, 1)[0];
}

}  // namespace miebrdf::support
