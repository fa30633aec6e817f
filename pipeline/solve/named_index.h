// n + ik of materials by their names.
#pragma once

#include <miebrdf/database.h>
#include <miebrdf/scene.h>

#include <complex>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace miebrdf {

/// From these words on a note of a dataset is said with every result in visible light.
inline constexpr std::string_view kColourCaveat = "not for colours";

/// A material's n + ik and where it comes from.
struct ResolvedIndex {
    std::vector<std::complex<double>> index;
    std::string source;
    std::optional<double> density_g_cm3 = {};  ///< of a material by name, where it is known
    std::string caveat = {};  ///< what its table is not good for at these wavelengths, or empty
};

/// A change of n + ik at all wavelengths, of a material by the name that a scene calls it.
struct IndexShift {
    std::string name;
    double n = 0.0;           ///< added to n
    double share_of_k = 0.0;  ///< k becomes k (1 + this)
    double k_in_place_of_0 = 0.0;

    std::complex<double> of(std::complex<double> index) const {
        const double k = index.imag();
        return {index.real() + n, k > 0.0 ? k * (1.0 + share_of_k) : k_in_place_of_0};
    }
};

/// Indices that scenes of one run have looked up. Thread-safe. A database that changes during the
/// run is not asked again.
class NamedIndexMemo {
  public:
    std::optional<ResolvedIndex> find(const std::string& key) const;
    void keep(const std::string& key, const ResolvedIndex& index);

    /// False where nobody reads notes, as in fits: that of crowded layers takes up to 0.1 s.
    bool tells_crowding = true;
    /// Wavelengths that spectra are sampled over, of scenes that are solved at some of them in
    /// turn; empty: each scene's own. Set before the memo is used.
    std::vector<double> spectrum_nm = {};

  private:
    mutable std::mutex mutex_;
    std::map<std::string, ResolvedIndex> known_;
};

/// The user's own materials over the embedded ones, opened for the first medium that has a name:
/// scenes without names need no database.
class Materials {
  public:
    /// @param file  of the user's materials; empty: the default one
    /// @throws InputError  for a file that does not exist
    /// @param memo  null: nothing is remembered
    explicit Materials(const std::string& file, const materials::IndexOptions& options = {},
                       NamedIndexMemo* memo = nullptr);

    materials::Database& open();

    /// @param look_up  what to do where nothing is remembered of these
    ResolvedIndex remembered(const std::string& name, const std::vector<double>& wavelength_nm,
                             double k_floor, const std::function<ResolvedIndex()>& look_up) const;

    materials::RefractiveIndex index(const std::string& name);

    /// The shift of every index that is looked up from now on; empty: none.
    std::optional<IndexShift> shift = {};

  private:
    std::string file_;
    materials::IndexOptions options_;
    NamedIndexMemo* memo_;
    std::optional<materials::Database> database_;
};

/// @param species  a material, index: or table
/// @param k_floor  k is raised to it
/// @throws InputError  for unknown names and wavelengths that a material does not cover
ResolvedIndex resolve_index(const Species& species, const std::vector<double>& wavelength_nm,
                            double k_floor, Materials& materials);
ResolvedIndex resolve_index(const Species& species, const std::vector<double>& wavelength_nm,
                            const std::string& database = {}, double k_floor = 0.0);

}  // namespace miebrdf
