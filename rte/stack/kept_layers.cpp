#include "rte/stack/kept_layers.h"

#include <utility>

namespace miebrdf::rte {

std::shared_ptr<const KeptLayers::Kept> KeptLayers::find(const std::string& stack,
                                                         const Place& place) const {
    const std::lock_guard lock(mutex_);
    const auto of_stack = known_.find(stack);
    if (of_stack == known_.end()) return nullptr;
    const auto found = of_stack->second.find(place);
    if (found == of_stack->second.end()) return nullptr;
    ++found_;
    return found->second;
}

int KeptLayers::found() const {
    const std::lock_guard lock(mutex_);
    return found_;
}

void KeptLayers::keep(const std::string& stack, const Place& place, Kept kept) {
    constexpr std::size_t most_bytes = std::size_t{64} << 20;
    const Reflector& layers = kept.layers;
    const std::size_t bytes =
        sizeof(double) *
        std::size_t(layers.nodes.size() + layers.rows.size() + layers.multiple.size());
    const std::lock_guard lock(mutex_);
    if (bytes_ + bytes > most_bytes) {
        known_.clear();
        bytes_ = 0;
    }
    bytes_ += bytes;
    known_[stack][place] = std::make_shared<const Kept>(std::move(kept));
}

}  // namespace miebrdf::rte
