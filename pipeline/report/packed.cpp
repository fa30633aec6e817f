#include "pipeline/report/packed.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace miebrdf::report {
namespace {

static_assert(std::endian::native == std::endian::little, "pages hold little-endian numbers");

template <typename Number>
std::string base64_of(const std::vector<Number>& numbers) {
    std::vector<unsigned char> bytes(numbers.size() * sizeof(Number));
    if (!bytes.empty()) std::memcpy(bytes.data(), numbers.data(), bytes.size());
    return base64(bytes);
}

constexpr double kLargestInteger = 32767.0;

}  // namespace

std::string base64(std::span<const unsigned char> bytes) {
    static constexpr char kLetters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k) three = three << 8 | (k < count ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += k <= count ? kLetters[three >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

nlohmann::json packed(std::span<const double> values) {
    std::vector<float> numbers;
    for (const double value : values) numbers.push_back(float(value));
    return {{"f32", base64_of(numbers)}};
}

nlohmann::json packed(const std::vector<std::vector<double>>& rows) {
    std::vector<double> all;
    for (const std::vector<double>& row : rows) all.insert(all.end(), row.begin(), row.end());
    return packed(all);
}

nlohmann::json packed(const LowRank& table) {
    const Eigen::Index rows = table.basis.rows(), rank = table.basis.cols();
    const Eigen::Index columns = table.coefficients.cols();
    std::vector<std::int16_t> basis(static_cast<std::size_t>(rows * rank));
    std::vector<double> coefficients;
    for (Eigen::Index k = 0; k < rank; ++k) {
        const double unit = table.basis.col(k).cwiseAbs().maxCoeff() / kLargestInteger;
        for (Eigen::Index row = 0; row < rows; ++row) {
            basis[std::size_t(row * rank + k)] =
                std::int16_t(std::lround(table.basis(row, k) / unit));
        }
        for (Eigen::Index c = 0; c < columns; ++c)
            coefficients.push_back(unit * table.coefficients(k, c));
    }
    return {{"rows", rows},
            {"rank", rank},
            {"columns", columns},
            {"scale", packed(std::span(table.scale.data(), std::size_t(rows)))},
            {"basis", {{"i16", base64_of(basis)}}},
            {"coefficients", packed(coefficients)}};
}

}  // namespace miebrdf::report
