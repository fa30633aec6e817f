// Layers against photons: the outside check of everything, within its confidence interval.
#pragma once

#include "tools/bench/scenes.h"
#include "tools/stress/battery.h"

namespace miebrdf::stress {

/// Compares plane albedo and, but for rough boundaries, reflection at one incidence with photons.
void compare_with_photons(const Case& is, const rte::Stack& stack,
                          const rte::Directions& directions, int photons);

}  // namespace miebrdf::stress
