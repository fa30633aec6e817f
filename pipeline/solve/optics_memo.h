// Optics of species that are computed once: for the scenes of a run, and in the cache for later
// ones.
#pragma once

#include <miebrdf/control.h>

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "pipeline/solve/named_index.h"
#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

/// Results as a row of numbers, for the cache.
std::vector<double> packed(const MediumOptics& optics);
MediumOptics unpacked_optics(const std::vector<double>& numbers);

/// Optics that several scenes of one run have in common, up to a limit of memory. Thread-safe.
class OpticsMemo {
  public:
    explicit OpticsMemo(std::size_t limit_bytes) : free_bytes_(limit_bytes) {}

    std::shared_ptr<const MediumOptics> find(const std::string& hash);
    void keep(const std::string& hash, const MediumOptics& optics);
    int found() const;               ///< how often something was there
    std::size_t free_bytes() const;  ///< what is not kept for lack of room is computed again
    NamedIndexMemo& names() { return names_; }  ///< n and k: small, so not counted

  private:
    mutable std::mutex mutex_;
    std::map<std::string, std::shared_ptr<const MediumOptics>> known_;
    std::size_t free_bytes_;
    int found_ = 0;
    NamedIndexMemo names_;
};

/// Optics from where they are known, from an earlier scene of the run or from the cache; else
/// computed and kept in both.
/// @param hash  optics_hash
MediumOptics remembered_optics(const Control& control, const std::string& hash,
                               const std::function<MediumOptics()>& compute);

}  // namespace miebrdf
