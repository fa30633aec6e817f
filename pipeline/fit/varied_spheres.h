// Which numbers of a scene change its spheres, and how.
#pragma once

#include <miebrdf/ensemble.h>
#include <miebrdf/scene.h>

#include <optional>
#include <vector>

namespace miebrdf::fitting {

/// Whether other spheres, or spheres in another host, are in two scenes of the same words.
bool have_other_spheres(const Scene& a, const Scene& b);

/// The sizes of spheres whose law has a width, as far as they are the same in scenes of the same
/// words.
class SizesInScenes {
  public:
    void add(const Scene& scene);

    bool vary() const { return vary_; }
    bool variances_vary() const { return variances_vary_; }
    /// Those that do not.
    std::vector<mie::SizeDistribution> fixed() const;

  private:
    struct Sizes {
        mie::SizeDistribution sizes;
        std::optional<double> specific_surface_m2_per_kg;
        bool is_fixed = true;
    };
    std::vector<Sizes> sizes_;  ///< in the order of the words
    bool vary_ = false, variances_vary_ = false;
};

}  // namespace miebrdf::fitting
