// Measurements are judged by these: tables of tests/reference, which the benchmark carries so that
// it can judge anywhere, and the reflectance of a rough surface once more, from the textbook.
#pragma once

#include <complex>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace miebrdf::bench {

/// A column of a table, and the number or text that a row has there.
struct Where {
    std::string column;
    std::variant<double, std::string> value;
};

/// A CSV table with '#' comments and one header line.
class ReferenceData {
  public:
    /// @param name  path relative to tests/reference
    /// @throws std::logic_error  for a table that was not built in
    explicit ReferenceData(const std::string& name);

    std::size_t size() const { return rows_.size(); }
    const std::string& text(std::size_t row, const std::string& column) const;
    double number(std::size_t row, const std::string& column) const;
    /// The first row that has all of these.
    /// @throws std::logic_error  where there is none
    std::size_t row(const std::vector<Where>& wanted) const;
    double number(const std::string& column, const std::vector<Where>& wanted) const {
        return number(row(wanted), column);
    }

  private:
    std::string name_;
    std::map<std::string, std::size_t> columns_;
    std::vector<std::vector<std::string>> rows_;
};

/// Text of a built-in table; nullptr if there is none of this name.
const char* built_in_table(const std::string& name);

/// Integral over the hemisphere of D G F / (4 mu_in mu_out) mu_out: Beckmann's distribution,
/// Smith's height-correlated masking (Heitz 2014, eq. 99), Fresnel's amplitudes in complex
/// arithmetic. Adaptive Gauss-Kronrod quadrature (Boost) in azimuth within mu_out, to 1e-11; no
/// code of rte/.
/// @param alpha  Beckmann slope parameter
double textbook_reflectance(double alpha, std::complex<double> index, double mu_in);

}  // namespace miebrdf::bench
