// The numbers of a page: arrays one behind the other, compressed, and a JSON object that says where
// each of them lies.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "pipeline/solve/low_rank.h"

namespace miebrdf::report {

class PageBytes {
  public:
    /// Appends single-precision numbers. @return {"f32": [offset, count]}
    nlohmann::json add(std::span<const double> values);
    /// The rows one after the other.
    nlohmann::json add(const std::vector<std::vector<double>>& rows);
    nlohmann::json add(const Eigen::MatrixXd& rows);
    /// Appends whole numbers in as few bytes as each needs. @return {"int": [offset, count]}
    nlohmann::json add(std::span<const int> values);
    /// {"rows", "rank", "columns", "scale", "column_scale", "basis", "coefficients", "unit"}: value
    /// = scale[row] column_scale[column] sum over k of unit[k] basis[k, row] coefficients[k,
    /// column]. The coefficients are rounded to 16 bits.
    nlohmann::json add(const LowRank& table);

    /// In base64, compressed by zlib: the length of the JSON text in four bytes, low first; the
    /// text; spaces up to a multiple of four; the arrays.
    /// @param level  of zlib, 1 (quick) to 9 (small)
    std::string compressed(const nlohmann::json& root, int level = 9) const;

  private:
    std::vector<unsigned char> bytes_;
};

}  // namespace miebrdf::report
