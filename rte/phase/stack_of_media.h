// A stack of media as the discrete equations see it.
#pragma once

#include <algorithm>
#include <complex>
#include <memory>
#include <optional>
#include <vector>

#include "rte/phase/scaled_medium.h"

namespace miebrdf::rte {

class KeptLayers;
class RoughBoundaries;

struct ScaledStack {
    std::vector<ScaledMedium> media;  ///< from the bottom up; media[0] is the half-space, if any
    BaseKind base = BaseKind::half_space;
    double ground_albedo = 0.0;
    std::optional<GroundBrdf> ground = {};  ///< of BaseKind::brdf
    std::complex<double> mirror_index = 1.0;
    /// The indices of what lies on the ground or mirror, and of the topmost medium, as far as
    /// boundaries see them: without a boundary the topmost is 1, media have their neighbours'
    /// index.
    double ground_index = 1.0, top_index = 1.0;
    std::optional<Boundary> boundary = {};  ///< empty too where the topmost medium is as air
    /// Where `boundary` is rough, those that were made before; never null then.
    std::shared_ptr<RoughBoundaries> rough_boundaries = {};
    /// What was solved of layers below the topmost one; null: nothing is kept.
    std::shared_ptr<KeptLayers> kept_layers = {};
    int moments = 1;  ///< Legendre moments of the medium that has most
    /// The flux into what lies below is wanted (Reflector::transmittance_at_requested): nothing is
    /// left out.
    bool transmits = false;
    /// Lower bound of the largest reflection at every incidence (least_brightness): below a deep
    /// coat is left out what does not show beside that. 0: nothing is.
    double brightness = 0.0;

    /// Any index but one: nodes and requested cosines differ from medium to medium.
    bool refracts() const {
        return top_index != 1.0 || ground_index != 1.0 ||
               std::any_of(media.begin(), media.end(),
                           [](const ScaledMedium& medium) { return medium.index != 1.0; });
    }
    /// Beams come back from mirrors or boundaries below a medium.
    bool has_mirrors() const {
        return base == BaseKind::mirror || ground_index != top_index ||
               std::any_of(media.begin(), media.end(), [this](const ScaledMedium& medium) {
                   return medium.index != top_index;
               });
    }
};

}  // namespace miebrdf::rte
