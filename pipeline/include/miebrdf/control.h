// How a caller watches and stops a computation, and what it may remember.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#pragma GCC visibility push(default)
namespace miebrdf {

class ResultCache;
class OpticsMemo;

/// Everything may be left as it is.
struct Control {
    int threads = 0;  ///< most threads to use; 0: one for each processor
    /// Called after each finished job of a stage, one call at a time, from any thread.
    std::function<void(const std::string& stage, std::size_t done, std::size_t total)> progress =
        {};
    /// Called when one of `total` jobs of a stage begins, and after each piece of a long job (how
    /// many pieces there will be is not known): they show that work goes on. From any thread,
    /// several at a time.
    std::function<void(const std::string& stage, std::size_t total)> job_begun = {};
    std::function<void()> piece_done = {};  ///< see job_begun
    /// Asked before each job and every tenth of a second or so within it, from any thread; true
    /// ends the computation with Cancelled.
    std::function<bool()> is_cancelled = {};
    /// Results of earlier runs (open_cache); none: everything is computed.
    std::shared_ptr<ResultCache> cache = {};
    /// Single scattering that several scenes have in common (make_optics_memo); none: each scene
    /// computes its own.
    std::shared_ptr<OpticsMemo> memo = {};
};

/// The user's cache of results, $XDG_CACHE_HOME/miebrdf/results.sqlite. Never an error: a file that
/// cannot be opened only means that nothing is remembered.
std::shared_ptr<ResultCache> open_cache();

/// For one run over several scenes; holds at most `limit_bytes`.
std::shared_ptr<OpticsMemo> make_optics_memo(std::size_t limit_bytes = std::size_t{128} << 20);

}  // namespace miebrdf
#pragma GCC visibility pop
