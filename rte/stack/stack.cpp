#include "rte/stack/stack.h"

#include <fmt/format.h>

#include <stdexcept>

namespace miebrdf::rte {

void validate(const Stack& stack) {
    if (stack.base_kind == BaseKind::half_space) validate(stack.base);
    if (!(stack.ground_albedo >= 0.0 && stack.ground_albedo <= 1.0)) {
        throw std::invalid_argument(
            fmt::format("ground albedo {}; allowed: [0, 1]", stack.ground_albedo));
    }
    for (const Coat& coat : stack.coats) {
        validate(coat.optics);
        if (!(coat.optical_depth >= 0.0)) {
            throw std::invalid_argument(
                fmt::format("optical depth {}; allowed: 0 or more", coat.optical_depth));
        }
    }
}

}  // namespace miebrdf::rte
