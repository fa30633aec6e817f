// What the results of one run have in common, computed once: the optics of the same spheres.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "pipeline/solve/layer_jobs.h"
#include "pipeline/solve/medium_optics.h"

namespace miebrdf {

/// Owned by a run, handed on in RunControl::shared. Results are the same to the last bit with it
/// and without. It keeps only what a later job is known to use (`expect`), until the last one has,
/// and no more than its limit. May be used from several threads.
class SharedWork {
  public:
    /// Enough for 31 wavelengths of 32 x 32 directions on 24 nodes, three times.
    static constexpr std::int64_t kDefaultLimit_bytes = std::int64_t{128} << 20;

    explicit SharedWork(std::int64_t limit_bytes = kDefaultLimit_bytes);

    /// Takes note of what a request will compute: called for each one of the run, before the first.
    /// @throws UsageError, InputError  as computing it would
    void expect(const Request& request, LayerQuantity quantity);
    /// The same of a request whose jobs are known.
    /// @param request  its directions as the solver gets them
    void expect(const Request& request, const SceneMedia& media, LayerQuantity quantity,
                const LayerJobs& jobs);

    /// Optics that an earlier result has computed; null when they have to be.
    std::shared_ptr<const MediumOptics> optics(const std::string& hash);
    /// Keeps optics if a later result uses them.
    void keep(const std::string& hash, const MediumOptics& optics);

    std::int64_t free_bytes() const;
    int optics_found() const;

  private:
    struct Spheres {
        int to_come = 0;  ///< results that have not asked yet
        std::shared_ptr<const MediumOptics> optics;
        std::int64_t bytes = 0;
    };

    mutable std::mutex mutex_;
    std::int64_t free_bytes_;
    std::map<std::string, Spheres> spheres_;
    int optics_found_ = 0;
};

}  // namespace miebrdf
