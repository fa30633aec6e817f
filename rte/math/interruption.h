// Where long loops may be stopped: between two of their steps they ask whether somebody wants them
// to go on. Who runs a job says so for its thread; without that the question costs a comparison.
#pragma once

#include <functional>

namespace miebrdf::math {

/// As long as one lives, interruption points of this thread ask `is_cancelled`.
class Interruptible {
  public:
    /// @param is_cancelled  must outlive this; empty: nobody asks
    explicit Interruptible(const std::function<bool()>& is_cancelled);
    ~Interruptible();
    Interruptible(const Interruptible&) = delete;
    Interruptible& operator=(const Interruptible&) = delete;

  private:
    const std::function<bool()>* before_;
};

/// To be called at least every tenth of a second or so of long work, and not more often than every
/// microsecond. Nothing may be left half-done that is used again: what is thrown ends the whole
/// job.
/// @throws Cancelled
void interruption_point();

}  // namespace miebrdf::math
