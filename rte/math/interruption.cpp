#include "rte/math/interruption.h"

#include <miebrdf/error.h>

namespace miebrdf::math {
namespace {

thread_local const std::function<bool()>* asked = nullptr;

}  // namespace

Interruptible::Interruptible(const std::function<bool()>& is_cancelled) : before_(asked) {
    asked = is_cancelled ? &is_cancelled : nullptr;
}

Interruptible::~Interruptible() { asked = before_; }

void interruption_point() {
    if (asked != nullptr && (*asked)()) throw Cancelled();
}

}  // namespace miebrdf::math
