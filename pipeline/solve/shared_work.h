// What the results of one run have in common, computed once: the optics of the same spheres, and
// the half-space that several coats lie on.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "pipeline/solve/layer_jobs.h"
#include "pipeline/solve/medium_optics.h"
#include "rte/half_space/solved_half_spaces.h"

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

    /// Where the half-space of that name is shared; null when no other job has it.
    std::shared_ptr<rte::SolvedHalfSpaces> half_spaces(const std::string& base_hash);
    /// One of the jobs on it is done: after the last it is forgotten.
    void leave(const std::string& base_hash);

    std::int64_t free_bytes() const { return budget_->left(); }
    int half_spaces_found() const;  ///< solutions that were not repeated
    int optics_found() const;

  private:
    struct Base {
        int expected = 0;  ///< jobs of the whole run
        int done = 0;
        std::shared_ptr<rte::SolvedHalfSpaces> solved;
    };
    struct Spheres {
        int to_come = 0;  ///< results that have not asked yet
        std::shared_ptr<const MediumOptics> optics;
        std::int64_t bytes = 0;
    };

    std::shared_ptr<rte::MemoryBudget> budget_;
    mutable std::mutex mutex_;
    std::map<std::string, Base> bases_;
    std::map<std::string, Spheres> spheres_;
    int half_spaces_found_ = 0;  ///< of bases that are forgotten
    int optics_found_ = 0;
};

/// The half-space of one job, for as long as the job runs.
class SharedBase {
  public:
    /// @param shared  may be null: nothing is shared
    SharedBase(SharedWork* shared, const std::string& base_hash);
    ~SharedBase();
    SharedBase(const SharedBase&) = delete;
    SharedBase& operator=(const SharedBase&) = delete;

    rte::SolvedHalfSpaces* get() const { return solved_.get(); }

  private:
    SharedWork* shared_;
    const std::string& base_hash_;
    std::shared_ptr<rte::SolvedHalfSpaces> solved_;
};

}  // namespace miebrdf
