// Which spheres, and which of their sizes, change with the numbers of a scene.
#pragma once

#include <miebrdf/ensemble.h>
#include <miebrdf/scene.h>

#include <optional>
#include <vector>

namespace miebrdf::fitting {

/// What differs between the spheres of two scenes of the same words, and the hosts of these.
enum class SphereChange {
    none,
    sizes,  ///< alone, of spheres whose law has a width
    other
};
SphereChange sphere_change(const Scene& a, const Scene& b);

/// The sizes of spheres whose law has a width, as far as they are the same in scenes of the same
/// words.
class VariedSizes {
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
