// Numbers as text inside a page: little-endian arrays in base64.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "pipeline/report/low_rank.h"

namespace miebrdf::report {

/// RFC 4648, with padding.
std::string base64(std::span<const unsigned char> bytes);

/// {"f32": base64} of single-precision numbers.
nlohmann::json packed(std::span<const double> values);
/// The rows one after the other.
nlohmann::json packed(const std::vector<std::vector<double>>& rows);
/// {"rows", "rank", "columns", "scale", "basis", "coefficients"}; the basis as 16-bit integers, each
/// column over its largest value, which is multiplied into the coefficients.
nlohmann::json packed(const LowRank& table);

}  // namespace miebrdf::report
