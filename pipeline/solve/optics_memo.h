// Optics of species that are computed once: for the scenes of a run, and in the cache for later
// ones.
#pragma once

#include <miebrdf/control.h>
#include <miebrdf/transfer.h>

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/solve/named_index.h"
#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

namespace rte {
class KeptLayers;
class RoughBoundaries;
}  // namespace rte
class SizeLattice;

/// Results as a row of numbers, for the cache.
std::vector<double> packed(const MediumOptics& optics);
MediumOptics unpacked_optics(const std::vector<double>& numbers);

/// The memory of what a MediumOptics has of lists and tables.
std::size_t bytes_of(const MediumOptics& optics);

/// Packed optics that outlive a run, or that several processes share. Thread-safe.
class OpticsStore {
  public:
    virtual ~OpticsStore() = default;
    /// Empty if they are not there. @param hash  optics_hash
    virtual std::optional<std::vector<double>> find(const std::string& hash) = 0;
    virtual void store(const std::string& hash, const std::vector<double>& numbers) = 0;
};

/// Optics that several scenes of one run have in common, up to a limit of memory. Thread-safe.
class OpticsMemo {
  public:
    /// @param shared  with other processes; null: none
    explicit OpticsMemo(std::size_t limit_bytes, std::shared_ptr<OpticsStore> shared = {});

    std::shared_ptr<const MediumOptics> find(const std::string& hash);
    void keep(const std::string& hash, const MediumOptics& optics);
    void keep(const std::string& hash, const MediumOptics& optics, std::size_t bytes);
    /// Rows of numbers that take long to compute and are asked for again, as a surface's shares.
    std::optional<std::vector<double>> find_numbers(const std::string& hash) const;
    void keep_numbers(const std::string& hash, std::vector<double> numbers);
    int found() const;               ///< how often something was there
    std::size_t free_bytes() const;  ///< what is not kept for lack of room is computed again
    NamedIndexMemo& names() { return names_; }  ///< n and k: small, so not counted
    /// Matrices of rough boundaries: of some MB, not counted.
    const std::shared_ptr<rte::RoughBoundaries>& rough_boundaries() const {
        return rough_boundaries_;
    }
    std::mutex& sampling() { return sampling_; }  ///< of whoever samples a spectrum
    OpticsStore* shared() const { return shared_.get(); }

    /// Whether spheres a little different, for derivatives, are kept too: scenes of one run ask for
    /// the same ones again; set before the memo is used.
    bool keeps_changes = false;
    /// What is solved of layers below the topmost one; null: nothing is kept of them.
    std::shared_ptr<rte::KeptLayers> kept_layers = {};
    /// Above 0: spheres are averaged once, with the whole phase function and to this tolerance, for
    /// every demand that this meets; their moments, depths and phase function are asked for.
    double whole_tolerance = 0.0;
    /// Where spheres of sizes that change come from (species_optics); set before the memo is used.
    std::shared_ptr<const SizeLattice> lattice = {};

  private:
    mutable std::mutex mutex_;
    std::mutex sampling_;
    std::map<std::string, std::shared_ptr<const MediumOptics>> known_;
    std::map<std::string, std::vector<double>> numbers_;
    std::size_t free_bytes_;
    std::shared_ptr<OpticsStore> shared_;
    int found_ = 0;
    NamedIndexMemo names_;
    std::shared_ptr<rte::RoughBoundaries> rough_boundaries_;
};

/// Memory of solutions that has the memo's boundaries and layers, where there is a memo.
rte::SolutionMemory memory_of(const Control& control);

/// Optics from where they are known: from an earlier scene of the run, from other processes, or
/// from the cache; else computed and kept in all of them.
/// @param hash  optics_hash
MediumOptics remembered_optics(const Control& control, const std::string& hash,
                               const std::function<MediumOptics()>& compute);

/// Numbers from where they are known: the memo, or the cache; else computed and kept in both.
/// @param hash  of everything that they depend on
std::vector<double> remembered_numbers(const Control& control, const std::string& hash,
                                       const std::function<std::vector<double>()>& compute);

}  // namespace miebrdf
