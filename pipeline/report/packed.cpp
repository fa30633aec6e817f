#include "pipeline/report/packed.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "pipeline/io/markup.h"

namespace miebrdf::report {
namespace {

static_assert(std::endian::native == std::endian::little, "pages hold little-endian numbers");

constexpr double kLargestCoefficient = 32767.0;

/// Whole numbers of what `unit` counts.
std::vector<int> rounded_to(const Eigen::VectorXd& values, double unit) {
    std::vector<int> whole;
    for (const double value : values)
        whole.push_back(unit > 0.0 ? int(std::lround(value / unit)) : 0);
    return whole;
}

}  // namespace

nlohmann::json PageBytes::add(std::span<const double> values) {
    while (bytes_.size() % sizeof(float) != 0) bytes_.push_back(0);
    const std::size_t offset = bytes_.size();
    for (const double value : values) {
        const auto bits = std::bit_cast<std::array<unsigned char, 4>>(float(value));
        bytes_.insert(bytes_.end(), bits.begin(), bits.end());
    }
    return {{"f32", {offset, values.size()}}};
}

nlohmann::json PageBytes::add(const std::vector<std::vector<double>>& rows) {
    std::vector<double> all;
    for (const std::vector<double>& row : rows) all.insert(all.end(), row.begin(), row.end());
    return add(std::span<const double>(all));
}

nlohmann::json PageBytes::add(const Eigen::MatrixXd& rows) {
    const Eigen::MatrixXd columns = rows.transpose();
    return add(std::span<const double>(columns.data(), std::size_t(columns.size())));
}

nlohmann::json PageBytes::add(std::span<const int> values) {
    const std::size_t offset = bytes_.size();
    for (const int value : values) {
        // The sign in the lowest bit, then seven bits a byte, the highest set where more follow.
        auto rest =
            static_cast<std::uint32_t>(value) << 1 ^ static_cast<std::uint32_t>(value >> 31);
        for (; rest > 127; rest >>= 7) bytes_.push_back(static_cast<unsigned char>(rest | 128));
        bytes_.push_back(static_cast<unsigned char>(rest));
    }
    return {{"int", {offset, values.size()}}};
}

nlohmann::json PageBytes::add(const LowRank& table) {
    const Eigen::Index rows = table.basis.rows(), rank = table.basis.cols();
    std::vector<int> basis, coefficients;
    std::vector<double> units;
    for (Eigen::Index k = 0; k < rank; ++k) {
        const double largest = table.coefficients.row(k).cwiseAbs().maxCoeff();
        const double of_basis = table.step[k];
        const double of_coefficients = largest / kLargestCoefficient;
        units.push_back(of_basis * of_coefficients);
        const std::vector<int> column = rounded_to(table.basis.col(k), of_basis);
        basis.insert(basis.end(), column.begin(), column.end());
        const std::vector<int> row = rounded_to(table.coefficients.row(k), of_coefficients);
        coefficients.insert(coefficients.end(), row.begin(), row.end());
    }
    const auto span_of = [](const auto& vector) {
        return std::span<const double>(vector.data(), std::size_t(vector.size()));
    };
    return {{"rows", rows},
            {"rank", rank},
            {"columns", table.coefficients.cols()},
            {"scale", add(span_of(table.scale))},
            {"column_scale", add(span_of(table.column_scale))},
            {"basis", add(std::span<const int>(basis))},
            {"coefficients", add(std::span<const int>(coefficients))},
            {"unit", add(std::span<const double>(units))}};
}

std::string PageBytes::compressed(const nlohmann::json& root, int level) const {
    std::string text = root.dump();
    text.append((4 - text.size() % 4) % 4, ' ');
    std::vector<unsigned char> all(4 + text.size() + bytes_.size());
    for (std::size_t k = 0; k < 4; ++k) all[k] = static_cast<unsigned char>(text.size() >> (8 * k));
    std::copy(text.begin(), text.end(), all.begin() + 4);
    std::copy(bytes_.begin(), bytes_.end(), all.begin() + 4 + std::ptrdiff_t(text.size()));
    uLongf size = compressBound(static_cast<uLong>(all.size()));
    std::vector<unsigned char> packed(size);
    if (compress2(packed.data(), &size, all.data(), static_cast<uLong>(all.size()), level) != Z_OK)
        throw std::runtime_error("zlib cannot compress the page's numbers");
    packed.resize(size);
    return base64({reinterpret_cast<const char*>(packed.data()), packed.size()});
}

}  // namespace miebrdf::report
