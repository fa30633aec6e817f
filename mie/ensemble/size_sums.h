// What the sizes of one pass sum to.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "mie/ensemble/band_covariance.h"
#include "mie/ensemble/executor.h"
#include "mie/sizes/size_nodes.h"
#include "mie/sphere/angular_functions.h"
#include "mie/sphere/sphere_block.h"

namespace miebrdf::mie {

/// Sums over sizes, weighted by their share of the geometric cross-section over x^2.
struct SizeSums {
    SphereSums spheres;
    BandCovariance covariance;  ///< empty without moments
    Eigen::VectorXd intensity;  ///< at the angles asked for

    void add(const SizeSums& other);
    void scale(double factor);
};

/// What is summed, besides efficiencies and g.
struct SizeSumOptions {
    int terms = 0;                             ///< partial waves of the largest sphere
    int band_width = -1;                       ///< of the covariance; -1: none
    bool single_precision = false;             ///< of products; not with angles
    const AngularFunctions* angles = nullptr;  ///< in double precision
};

/// Size parameters and weights of nodes, for compute_spheres.
struct WeightedSizes {
    WeightedSizes() = default;
    WeightedSizes(const SizeNodes& nodes, double wave_number_per_um);
    std::vector<double> parameters, weights;
};

/// Sizes cut into chunks for an executor, and each chunk into blocks of about 40 (U and V of a
/// block stay near the cache).
class SizeChunks {
  public:
    struct Block {
        int first, count;
    };

    /// @param most  chunks; fewer when each would have less than `least` sizes
    SizeChunks(int size_count, int most, int least);
    int count() const { return count_; }
    std::vector<Block> blocks(int chunk) const;

  private:
    int size_count_, count_, per_chunk_;
};

/// Which of `count` chunks, listed from small to large spheres, a job takes: large and small ones
/// in turn, so that both halves of the jobs (that is how an executor shares them out) cost the
/// same.
inline int chunk_of_job(int job, int count) { return job % 2 == 0 ? count - 1 - job / 2 : job / 2; }

constexpr int most_sizes_per_block = 40;

/// Sums over all sizes, in chunks of blocks that do not depend on the executor.
SizeSums sum_over_sizes(std::complex<double> relative_index, const WeightedSizes& sizes,
                        const SizeSumOptions& options, const Executor& run);

}  // namespace miebrdf::mie
