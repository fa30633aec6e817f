// Grids and Legendre tables for solutions at the same directions.
#pragma once

#include <cstddef>
#include <map>
#include <utility>

#include "rte/phase/phase_mode.h"

namespace miebrdf::rte {

/// Keeps what depends on directions, nodes and orders but on no medium: wavelengths and layers need
/// it again. Not for two threads.
class SharedTables {
  public:
    /// @param most_bytes  of Legendre tables; those beyond, and all for 0, are made again every
    /// time
    explicit SharedTables(std::size_t most_bytes = 16 << 20) : most_bytes_(most_bytes) {}

    /// @param kind, count  as of make_zenith_grid
    /// @return valid as long as this
    const ZenithGrid& grid(GridKind kind, int count);

    /// As make_phase_mode. Tables are kept until other directions are requested; those of grids
    /// that are not of this are not kept.
    /// @return valid until the next call
    const PhaseMode& mode(int order, int degrees, const ZenithGrid& grid,
                          const RequestedDirections& requested);

  private:
    struct Key {
        const ZenithGrid* grid;
        int order, degrees;
        auto operator<=>(const Key&) const = default;
    };

    bool owns(const ZenithGrid& grid) const;

    std::size_t most_bytes_;
    std::map<std::pair<GridKind, int>, ZenithGrid> grids_;
    RequestedDirections requested_;
    std::map<Key, PhaseMode> modes_;
    PhaseMode not_kept_;
    std::size_t bytes_ = 0;
};

}  // namespace miebrdf::rte
