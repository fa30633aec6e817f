#include "tools/miebrdf/sparkline.h"

#include <fmt/format.h>

#include <algorithm>

namespace miebrdf::program {
namespace {

constexpr int kWidth = 48;
constexpr const char* kBlocks[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};

double linear(const std::vector<double>& x, const std::vector<double>& y, double at) {
    const auto above = std::lower_bound(x.begin(), x.end(), at);
    if (above == x.begin()) return y.front();
    if (above == x.end()) return y.back();
    const auto i = static_cast<std::size_t>(above - x.begin());
    const double t = (at - x[i - 1]) / (x[i] - x[i - 1]);
    return y[i - 1] + t * (y[i] - y[i - 1]);
}

}  // namespace

std::string sparkline(const std::vector<double>& x, const std::vector<double>& y) {
    if (x.empty()) return "";
    const auto [lowest, highest] = std::minmax_element(y.begin(), y.end());
    std::string line;
    for (int i = 0; i < kWidth; ++i) {
        const double value = linear(x, y, x.front() + (x.back() - x.front()) * i / (kWidth - 1));
        const double height = *highest > *lowest ? (value - *lowest) / (*highest - *lowest) : 0.0;
        line += kBlocks[std::clamp(static_cast<int>(height * 8), 0, 7)];
    }
    return fmt::format("{:.5g} to {:.5g} {}", *lowest, *highest, line);
}

}  // namespace miebrdf::program
