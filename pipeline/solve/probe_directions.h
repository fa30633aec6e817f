// Directions of all kinds, for a BRDF that is solved once and then asked anywhere.
#pragma once

#include "rte/stack/layered_reflection.h"

namespace miebrdf {

/// Where streams, moments and visible layers are decided for such a BRDF: steep and grazing,
/// forward and back. The tables' own directions at the very horizon would ask for many more
/// streams.
inline const rte::Directions& probe_directions() {
    static const rte::Directions directions{
        {0.05, 0.3, 0.6, 1.0}, {0.05, 0.2, 0.5, 0.8, 1.0}, {0, 45, 90, 135, 180}};
    return directions;
}

}  // namespace miebrdf
