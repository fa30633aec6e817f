// Intensities from the spheres of a family of sizes, and waves that are kept for the next angles.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <map>
#include <tuple>
#include <vector>

#include "mie/ensemble/size_sums.h"

namespace miebrdf::mie {

/// Intensities from each family, angles x 2, and what its spheres scatter; their sums are the mean
/// over both. The second family is empty where there is one size only.
struct FamilyIntensity {
    Eigen::MatrixXd intensity;
    double scattered[2] = {0, 0};
    /// Of the mean over this level and those before it: 1 where those are no longer needed.
    double share = 0.5;
};

/// Of sums over parts at many angles (an empty intensity: not that part) those at `count` of them.
std::vector<FamilyIntensity> at_some_angles(const std::vector<FamilyIntensity>& parts,
                                            Eigen::Index first, Eigen::Index count);

/// Waves of one block of sizes, once they are computed.
struct KeptWaves {
    SphereBlockOf<float> block = {};
    double scattered = 0;
    bool is_there = false;
};

/// Waves of blocks of sizes that are asked for several times at different angles: in memory, as far
/// as it goes.
class WaveStore {
  public:
    /// Which block it is.
    struct Key {
        int part, family, level, first_size;
        bool operator<(const Key& other) const {
            return std::tie(part, family, level, first_size) <
                   std::tie(other.part, other.family, other.level, other.first_size);
        }
    };

    void open() { is_open_ = true; }
    /// Where the waves are or may be put, `numbers` of each kind; null: they are not kept.
    KeptWaves* place_of(const Key& key, double numbers);

  private:
    bool is_open_ = false;
    std::map<Key, KeptWaves> kept_ = {};
    double bytes_ = 0;
};

/// What spheres of some sizes scatter: intensities at angles, and all together.
struct SphereIntensity {
    Eigen::VectorXd at_angles;
    double scattered = 0;
};

/// The sum over blocks of sizes. Scalar: float or double.
/// @param places  of the blocks, in single precision; none: they are not kept
template <typename Scalar>
SphereIntensity intensity_of_spheres(std::complex<double> relative_index,
                                     const WeightedSizes& sizes,
                                     const std::vector<SizeChunks::Block>& blocks,
                                     const AngularFunctionsOf<Scalar>& angular,
                                     const std::vector<KeptWaves*>& places = {});

/// Orders of the largest sphere of a block.
int terms_of(const WeightedSizes& sizes, SizeChunks::Block of);

/// Families have spacings in this ratio (SizeFamilies).
inline constexpr double kFamilyShare[2] = {1.21, 1.29};

}  // namespace miebrdf::mie
