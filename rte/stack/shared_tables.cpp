#include "rte/stack/shared_tables.h"

#include <algorithm>

namespace miebrdf::rte {
namespace {

std::size_t bytes_of_mode(int columns, const ZenithGrid& grid,
                          const RequestedDirections& requested) {
    const auto nodes = 2 * std::size_t(grid.size());
    const std::size_t cosines =
        std::size_t(requested.mu.size()) + requested.out.size() + requested.in.size();
    return sizeof(double) * (nodes + cosines) * std::size_t(columns);
}

bool are_same(const RequestedDirections& a, const RequestedDirections& b) {
    return a.mu.size() == b.mu.size() && a.mu == b.mu && a.out == b.out && a.in == b.in;
}

}  // namespace

const ZenithGrid& SharedTables::grid(GridKind kind, int count) {
    const std::pair key(kind, count);
    const auto known = grids_.find(key);
    if (known != grids_.end()) return known->second;
    return grids_.emplace(key, make_zenith_grid(kind, count)).first->second;
}

bool SharedTables::owns(const ZenithGrid& grid) const {
    return std::any_of(grids_.begin(), grids_.end(),
                       [&](const auto& entry) { return &entry.second == &grid; });
}

const PhaseMode& SharedTables::mode(int order, int degrees, const ZenithGrid& grid,
                                    const RequestedDirections& requested) {
    if (!are_same(requested, requested_)) {
        modes_.clear();
        bytes_ = 0;
        requested_ = requested;
    }
    const Key key{&grid, order, degrees};
    const auto known = modes_.find(key);
    if (known != modes_.end()) return known->second;
    const std::size_t bytes = bytes_of_mode(degrees - order, grid, requested);
    const bool keep = owns(grid) && bytes_ + bytes <= most_bytes_;
    PhaseMode& mode = keep ? modes_[key] : not_kept_;
    if (keep) bytes_ += bytes;
    make_phase_mode(order, degrees, grid, requested, mode);
    return mode;
}

}  // namespace miebrdf::rte
