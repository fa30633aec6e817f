// Media with their names looked up: from here on no stage needs the database.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "materials/database/database.h"
#include "materials/index/refractive_index.h"
#include "pipeline/cache/job_key.h"
#include "pipeline/scene/medium.h"

namespace miebrdf {

/// A medium together with the table that its name stands for.
struct ResolvedMedium {
    Medium medium;
    std::optional<materials::RefractiveIndex> table;  ///< of a database medium
    std::string source;  ///< one line for the output: which figures, from where

    /// n + ik at a vacuum wavelength, k raised to `k_floor`; empty for media without an index.
    /// @throws InputError  outside the table, naming material and valid range
    std::optional<std::complex<double>> index_at(double wavelength_nm, double k_floor) const;

    /// Adds what the optics of this medium at a wavelength depend on.
    /// @param particles  of the scene; the medium's own sizes come before them
    void add_to(JobKey& key, double wavelength_nm, const ParticleOptions& particles) const;
};

/// Refuses particles of the index of their host: without contrast nothing scatters, and an albedo
/// has no meaning.
/// @throws UsageError  naming index, host and wavelength; InputError as index_at
void require_contrast(const ResolvedMedium& medium, const std::vector<double>& wavelengths_nm,
                      const ParticleOptions& particles);

/// Looks names up in a user's database file laid over the embedded database; an empty `file` is
/// the default one (materials::default_user_database), which need not exist. The databases are
/// opened for the first medium that has a name: scenes without names need none.
class MediumResolver {
  public:
    /// @throws InputError  when a file is named that does not exist
    explicit MediumResolver(const std::string& file = {});

    /// @throws InputError  for an unknown name, with the nearest known ones; when the file is no
    ///         materials database or is damaged
    ResolvedMedium resolve(const Medium& medium);

  private:
    std::string file_;
    std::optional<materials::Database> database_;
};

}  // namespace miebrdf
