// Layers that lie below the topmost one of stacks solved before: who edits the topmost layer has
// the others solved once.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include "rte/layer/layer.h"

namespace miebrdf::rte {

/// The layers below the topmost one, as one reflector, in the Fourier orders that were solved.
/// Results are the same to the last bit. Thread-safe.
class KeptLayers {
  public:
    /// Fourier order, first Stokes component of the block, 1 + the coat that hides what is below
    /// (0: none does), and FourierMedium::brightness of the lowest medium.
    using Place = std::tuple<int, int, std::size_t, double>;
    struct Kept {
        Reflector layers;
        std::vector<double> brightness;  ///< StackMemory::brightness
    };

    /// @param stack  everything that the layers depend on, as bytes
    std::shared_ptr<const Kept> find(const std::string& stack, const Place& place) const;
    /// Once 64 MB are kept, all that was kept before is forgotten.
    void keep(const std::string& stack, const Place& place, Kept kept);
    int found() const;  ///< how often something was there

  private:
    mutable std::mutex mutex_;
    std::map<std::string, std::map<Place, std::shared_ptr<const Kept>>> known_;
    std::size_t bytes_ = 0;
    mutable int found_ = 0;
};

}  // namespace miebrdf::rte
