// Half-spaces solved before, for stacks that lie on the same one.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "rte/half_space/half_space.h"

namespace miebrdf::rte {

/// Bytes that several stores share; what does not fit is not kept.
class MemoryBudget {
  public:
    explicit MemoryBudget(std::int64_t bytes) : left_(bytes) {}
    bool take(std::int64_t bytes);  ///< false, and nothing taken, where less is left
    void give_back(std::int64_t bytes) { left_ += bytes; }
    std::int64_t left() const { return left_; }

  private:
    std::atomic<std::int64_t> left_;
};

/// Everything that solve_half_space depends on.
struct HalfSpaceProblem {
    HalfSpaceMethod method = HalfSpaceMethod::automatic;
    const ScatteringMode& medium;
    const PhaseMode& mode;
    const ZenithGrid& grid;
    const RequestedDirections& requested;
    double tolerance = 0.0;
};

/// Remembers solve_half_space by its arguments, number by number: what is found is bit for bit what
/// solving again would give. May be used from several threads; two that miss at the same time both
/// solve.
class SolvedHalfSpaces {
  public:
    /// @param budget  what is kept is taken from it, and given back at the end
    explicit SolvedHalfSpaces(std::shared_ptr<MemoryBudget> budget) : budget_(std::move(budget)) {}
    ~SolvedHalfSpaces();
    SolvedHalfSpaces(const SolvedHalfSpaces&) = delete;
    SolvedHalfSpaces& operator=(const SolvedHalfSpaces&) = delete;

    /// The half-space as solved before, or solved now and kept if there is room.
    /// @param result  overwritten
    void solve(const HalfSpaceProblem& problem, OrderWork& work, Reflector& result);

    int found() const { return found_; }  ///< how many solutions were not repeated
    std::size_t kept() const;             ///< how many there are

  private:
    using Key = std::vector<double>;
    static Key key_of(const HalfSpaceProblem& problem);

    std::shared_ptr<MemoryBudget> budget_;
    mutable std::mutex mutex_;
    std::map<Key, Reflector> known_;
    std::int64_t taken_bytes_ = 0;
    std::atomic<int> found_ = 0;
};

}  // namespace miebrdf::rte
