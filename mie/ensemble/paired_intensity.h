// Intensities from the spheres of a sample of sizes, and waves that are kept for the next angles.
#pragma once

#include <Eigen/Core>
#include <map>
#include <tuple>
#include <vector>

#include "mie/ensemble/size_sums.h"

namespace miebrdf::mie {

/// Intensities from each of two samples of sizes, angles x 2, and what its spheres scatter; their
/// sums are the mean over both. The second sample is empty where there is one size only.
struct PairedIntensity {
    Eigen::MatrixXd intensity;
    double scattered[2] = {0, 0};
    /// The weight of this level in the mean over it and those before it: 1 where those are no
    /// longer needed.
    double share = 0.5;
};

/// The rows of `count` angles from `first` on, part by part (an empty intensity: that part is not
/// there).
std::vector<PairedIntensity> at_some_angles(const std::vector<PairedIntensity>& parts,
                                            Eigen::Index first, Eigen::Index count);

/// Waves of one block of sizes, once they are computed.
struct KeptWaves {
    SphereBlockOf<float> block = {};
    double scattered = 0;
    bool is_there = false;
};

/// Keeps the waves of blocks of sizes that are asked for several times at different angles in
/// memory, as far as that goes.
class WaveStore {
  public:
    /// Which block it is.
    struct Key {
        int part, sample, level, first_size;
        bool operator<(const Key& other) const {
            return std::tie(part, sample, level, first_size) <
                   std::tie(other.part, other.sample, other.level, other.first_size);
        }
    };

    /// Where the waves are or may be put, `numbers` of each kind; null: they are not kept.
    KeptWaves* place_of(const Key& key, double numbers);

  private:
    std::map<Key, KeptWaves> kept_ = {};
    double bytes_ = 0;
};

/// The light that spheres of some sizes scatter: at angles, and all together.
struct SphereIntensity {
    Eigen::VectorXd at_angles;
    double scattered = 0;
};

/// The sum over blocks of sizes. Scalar: float or double.
/// @param places  of the blocks, in single precision; none: they are not kept
template <typename Scalar>
SphereIntensity intensity_of_spheres(const Scatterer& scatterer, const WeightedSizes& sizes,
                                     const std::vector<SizeChunks::Block>& blocks,
                                     const AngularFunctionsOf<Scalar>& angular,
                                     const std::vector<KeptWaves*>& places = {});

/// Orders of the largest sphere of a block.
int terms_of(const Scatterer& scatterer, const WeightedSizes& sizes, SizeChunks::Block of);

/// The samples have spacings in this ratio (PairedSizeSamples).
inline constexpr double kSampleShare[2] = {1.21, 1.29};

}  // namespace miebrdf::mie
