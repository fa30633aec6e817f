// n + ik of materials by their names.
#pragma once

#include <miebrdf/database.h>
#include <miebrdf/scene.h>

#include <complex>
#include <optional>
#include <string>
#include <vector>

namespace miebrdf {

/// The user's own materials over the embedded ones, opened for the first medium that has a name:
/// scenes without names need no database.
class Materials {
  public:
    /// @param file  of the user's materials; empty: the default one
    /// @throws InputError  for a file that does not exist
    explicit Materials(const std::string& file, const materials::IndexOptions& options = {});

    materials::Database& open();

    materials::RefractiveIndex index(const std::string& name);

  private:
    std::string file_;
    materials::IndexOptions options_;
    std::optional<materials::Database> database_;
};

/// A material's n + ik and where it comes from.
struct ResolvedIndex {
    std::vector<std::complex<double>> index;
    std::string source;
};

/// @param species  a material, index: or table
/// @param k_floor  k is raised to it
/// @throws InputError  for unknown names and wavelengths that a material does not cover
ResolvedIndex resolve_index(const Species& species, const std::vector<double>& wavelength_nm,
                            double k_floor, Materials& materials);
ResolvedIndex resolve_index(const Species& species, const std::vector<double>& wavelength_nm,
                            const std::string& database = {}, double k_floor = 0.0);

}  // namespace miebrdf
