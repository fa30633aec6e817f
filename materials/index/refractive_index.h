// Complex refractive index of one dataset as a function of wavelength.
#pragma once

#include <complex>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "materials/index/dataset.h"

namespace miebrdf::materials {

/// A table of n and k on its own grid, never resampled.
struct IndexTable {
    std::vector<double> wavelength_nm;  ///< vacuum, ascending, > 0
    std::vector<double> n;              ///< > 0
    std::vector<double> k;              ///< >= 0; all 0 when k_known is false
    bool k_known = true;  ///< false: k was not measured, which is not the same as k = 0
};

enum class Interpolation {
    pchip,  ///< monotone cubic in photon energy (Fritsch & Butland 1984): no overshoot, k >= 0
    linear_in_energy,
    linear_in_wavelength,  ///< what most other tools do
};
enum class Extrapolation { refuse, clamp };

struct IndexOptions {
    Interpolation interpolation = Interpolation::pchip;
    Extrapolation extrapolation = Extrapolation::refuse;  ///< clamp: the value at the nearer end
    /// Where n is known and k is not: true gives k = 0 instead of an error. Has no effect when k is
    /// unknown everywhere: then k is 0 and `k_known()` is false.
    bool missing_k_is_zero = false;
};

/// Where else to look when a wavelength is not covered; only used in the message.
struct Coverage {
    std::string name;
    double shortest_nm = 0.0;
    double longest_nm = 0.0;
};

/// Interpolates n and k separately, each on its own grid, monotonically (PCHIP) in photon energy;
/// dispersion formulas are evaluated exactly. Tables of fewer than 4 rows are interpolated linearly
/// in photon energy (PCHIP needs 4), a table of one row is valid at that wavelength alone.
/// Copies are cheap and share the table; `at` may be called from several threads.
class RefractiveIndex {
  public:
    /// @throws std::invalid_argument  for a table that is empty, not ascending or not physical
    RefractiveIndex(std::string material, IndexTable table);

    /// @param k  nothing when it is unknown
    /// @throws std::invalid_argument  for a series that is empty, not ascending or not physical, or
    ///         when n is missing or n and k have no wavelength in common
    RefractiveIndex(std::string material, std::optional<Series> n, std::optional<Series> k,
                    const IndexOptions& options = {}, std::vector<Coverage> alternatives = {});

    /// n + ik at a vacuum wavelength.
    /// @throws std::out_of_range  outside the data, naming material, asked and valid range; also
    ///         where a formula has no real value
    std::complex<double> at(double wavelength_nm) const;

    /// First and last wavelength at which both n and k are given (n alone when k is unknown).
    double shortest_nm() const;
    double longest_nm() const;
    bool covers(double wavelength_nm) const;
    bool k_known() const;

    /// n and k at every native wavelength of the range; for formulas 201 points even in energy.
    IndexTable table() const;

  private:
    struct State;
    std::shared_ptr<const State> state_;
};

}  // namespace miebrdf::materials
