// Complex refractive index of one dataset as a function of wavelength.
#pragma once

#include <complex>
#include <string>
#include <vector>

namespace miebrdf::materials {

/// A table of n and k on its own grid, never resampled.
struct IndexTable {
    std::vector<double> wavelength_nm;  ///< vacuum, ascending, > 0
    std::vector<double> n;              ///< > 0
    std::vector<double> k;              ///< >= 0; all 0 when k_known is false
    bool k_known = true;  ///< false: k was not measured, which is not the same as k = 0
};

/// Interpolates a table monotonically (PCHIP) in photon energy, n and k separately.
class RefractiveIndex {
  public:
    /// @throws std::invalid_argument  for a table that is empty, not ascending or not physical
    RefractiveIndex(std::string material, IndexTable table);

    /// n + ik at a vacuum wavelength.
    /// @throws std::out_of_range  outside the table, naming material, asked and valid range
    std::complex<double> at(double wavelength_nm) const;

    double shortest_nm() const;
    double longest_nm() const;
    const IndexTable& table() const { return table_; }

  private:
    std::string material_;
    IndexTable table_;
    // interpolation state: see refractive_index.cpp
};

}  // namespace miebrdf::materials
