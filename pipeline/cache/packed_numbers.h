// Results as a row of numbers and back, for the cache.
#pragma once

#include <string>
#include <vector>

namespace miebrdf {

class NumberPacker {
  public:
    NumberPacker& add(double number);
    NumberPacker& add(const std::vector<double>& numbers);
    NumberPacker& add(const std::string& text);
    const std::vector<double>& numbers() const { return numbers_; }

  private:
    std::vector<double> numbers_;
};

/// Reads in the order in which they were added.
/// @throws std::runtime_error  when there are fewer numbers than asked for
class NumberUnpacker {
  public:
    explicit NumberUnpacker(const std::vector<double>& numbers) : numbers_(numbers) {}
    double number();
    std::vector<double> list();
    std::string text();

  private:
    std::size_t count();

    const std::vector<double>& numbers_;
    std::size_t next_ = 0;
};

}  // namespace miebrdf
