#include "mie/ensemble/paired_intensity.h"

#include <type_traits>

#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

constexpr double kMostKept = 30e6;  // bytes

template <typename Scalar>
double spheres_of(const Scatterer& scatterer, const WeightedSizes& sizes, SizeChunks::Block of,
                  SphereBlockOf<Scalar>& block) {
    const std::size_t count = of.count;
    return 2 * compute_spheres(scatterer, {sizes.parameters.data() + of.first, count},
                               {sizes.weights.data() + of.first, count}, &block)
                   .scattered;
}

}  // namespace

std::vector<PairedIntensity> at_some_angles(const std::vector<PairedIntensity>& parts,
                                            Eigen::Index first, Eigen::Index count) {
    std::vector<PairedIntensity> some(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (parts[i].intensity.size() == 0) continue;
        some[i] = {parts[i].intensity.middleRows(first, count),
                   {parts[i].scattered[0], parts[i].scattered[1]},
                   parts[i].share};
    }
    return some;
}

KeptWaves* WaveStore::place_of(const Key& key, double numbers) {
    const auto known = kept_.find(key);
    if (known != kept_.end()) return &known->second;
    const double bytes = 4 * sizeof(float) * numbers;  // U and V, real and imaginary
    if (!(bytes_ + bytes <= kMostKept)) return nullptr;
    bytes_ += bytes;
    return &kept_[key];
}

int terms_of(const Scatterer& scatterer, const WeightedSizes& sizes, SizeChunks::Block of) {
    return scatterer.terms(sizes.parameters[of.first + of.count - 1]);
}

template <typename Scalar>
SphereIntensity intensity_of_spheres(const Scatterer& scatterer, const WeightedSizes& sizes,
                                     const std::vector<SizeChunks::Block>& blocks,
                                     const AngularFunctionsOf<Scalar>& angular,
                                     const std::vector<KeptWaves*>& places) {
    SphereBlockOf<Scalar> block;
    block.make_room(terms_of(scatterer, sizes, blocks.back()), kMostSizesPerBlock);
    SphereIntensity sum{Eigen::VectorXd::Zero(angular.angle_count())};
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        if constexpr (std::is_same_v<Scalar, float>) {
            if (!places.empty() && places[i] != nullptr) {
                KeptWaves& kept = *places[i];
                if (!kept.is_there)
                    kept.scattered = spheres_of(scatterer, sizes, blocks[i], kept.block);
                kept.is_there = true;
                angular.add_intensity(kept.block, sum.at_angles);
                sum.scattered += kept.scattered;
                continue;
            }
        }
        sum.scattered += spheres_of(scatterer, sizes, blocks[i], block);
        angular.add_intensity(block, sum.at_angles);
    }
    return sum;
}

template SphereIntensity intensity_of_spheres(const Scatterer&, const WeightedSizes&,
                                              const std::vector<SizeChunks::Block>&,
                                              const AngularFunctionsOf<float>&,
                                              const std::vector<KeptWaves*>&);
template SphereIntensity intensity_of_spheres(const Scatterer&, const WeightedSizes&,
                                              const std::vector<SizeChunks::Block>&,
                                              const AngularFunctionsOf<double>&,
                                              const std::vector<KeptWaves*>&);

}  // namespace miebrdf::mie
