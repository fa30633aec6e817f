// Computes the scenes of a sweep, chunk by chunk.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/sweep/optics_folder.h"
#include "pipeline/sweep/parts.h"
#include "pipeline/sweep/table_writer.h"

namespace miebrdf::sweep {

/// Share `number` of `of`, from 1: every `of`-th chunk.
struct Share {
    std::size_t number = 1, of = 1;
};

/// Reads `3/8`. @throws UsageError
Share parse_share(const std::string& text);

/// The processor time that a chunk took.
struct ChunkCost {
    Chunk chunk;
    double processor_seconds = 0.0;  ///< of all threads together
};

struct RunReport {
    std::size_t chunks = 0;             ///< of this share
    std::size_t found = 0;              ///< of them, computed by an earlier run
    std::size_t computed_scenes = 0;    ///< by this run
    std::vector<ChunkCost> costs = {};  ///< in the order in which they were computed
};

/// Single scattering that is kept for later scenes.
inline constexpr std::size_t kSharedBytes = std::size_t{512} << 20;

/// The scenes of these numbers side by side, each on this many threads (0: all).
/// @throws Cancelled
std::vector<SceneResult> solve_scenes(const Sweep& sweep, const Layout& layout,
                                      const std::vector<std::size_t>& scenes, int threads_of_each,
                                      const Control& control);

/// Computes the scenes of one chunk. The first scene of every group goes first, its Mie theory on
/// all threads; the others find that in the memo, and each is one thread's.
/// @throws Cancelled
std::vector<SceneResult> compute_chunk(const Sweep& sweep, const Layout& layout, const Chunk& chunk,
                                       const Control& control);

/// Whether other processes work on the same sweep, and want to know its single scattering.
enum class Company { alone, with_others };

/// Computes chunks one after the other and stores them; they share a memo of single scattering.
class ChunkWorker {
  public:
    /// @param control  without a cache: parts remember
    ChunkWorker(const Sweep& sweep, const Layout& layout, const Parts& parts, Company company,
                Control control);

    /// @throws Cancelled; InputError  when the part cannot be written
    void compute(const Chunk& chunk, RunReport& report);
    /// Computes a chunk unless somebody else stores it meanwhile.
    void compute_unless(const Chunk& chunk, RunReport& report,
                        const std::function<bool()>& is_there);

  private:
    const Sweep& sweep_;
    const Layout& layout_;
    const Parts& parts_;
    std::shared_ptr<OpticsFolder> folder_;
    Control control_;
};

/// Computes what is missing of a share and stores it, chunk by chunk.
/// @throws Cancelled; InputError  when a part cannot be written
RunReport run_share(const Sweep& sweep, const Layout& layout, const Parts& parts,
                    const Share& share, const Control& control);

/// Summary over the scenes of a table.
struct TableReport {
    std::size_t scenes = 0;
    std::size_t failed = 0;         ///< scenes without any value
    std::size_t incomplete = 0;     ///< scenes with values at some of their wavelengths
    std::size_t not_converged = 0;  ///< of the others
    double error_estimate = 0.0;    ///< largest of those that did not fail
    std::string first_remark = {};  ///< of a scene that lacks values, else of one not converged
};

/// Writes the whole table, in the order of the scenes: equal bytes, whoever computed them.
/// @throws InputError  for chunks that are missing, with their numbers
TableReport write_table(const Parts& parts, TableWriter& writer, const Control& control);

}  // namespace miebrdf::sweep
