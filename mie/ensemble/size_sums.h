// Sums over the sizes of one pass: efficiencies, products of partial waves, intensities at
// angles.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/ensemble/moment_transform.h"
#include "mie/sizes/size_nodes.h"
#include "mie/sphere/scatterer.h"
#include "mie/sphere/sphere_block.h"

namespace miebrdf::mie {

/// The lower triangle of a symmetric quadratic form; what is below the diagonal counts twice.
template <typename Scalar>
class TriangularForm {
  public:
    /// Memory grows; what is in the rows is left.
    void make_room(int count);

    int count() const { return count_; }
    int row_size() const { return row_size_; }  ///< count(), in whole pieces of the products
    /// Columns beyond the diagonal, to the end of the piece at least, are to be zero.
    Scalar* row(int n) { return values_.data() + n * static_cast<std::ptrdiff_t>(row_size_); }
    const Scalar* row(int n) const {
        return values_.data() + n * static_cast<std::ptrdiff_t>(row_size_);
    }
    /// End of the piece that a column is in.
    static int piece_end(int column);

  private:
    int count_ = 0, row_size_ = 0;
    std::vector<Scalar> values_;
};

/// The phase function at listed angles, from the partial waves of the spheres:
/// S1 +- S2 = sum_n (2n+1)/(n(n+1)) (a_n +- b_n) (pi_n +- tau_n): the tables of the angular part,
/// shared by all sizes. Scalar: float or double.
template <typename Scalar>
class AngularFunctionsOf {
  public:
    AngularFunctionsOf() = default;
    /// @throws UsageError  for an angle outside 0 to 180 degrees
    AngularFunctionsOf(std::span<const double> angles_deg, int terms,
                       const Executor& run = run_in_order);
    /// Tables at cosines of scattering angles, in [-1, 1].
    AngularFunctionsOf(const Eigen::ArrayXd& cosines, int terms, const Executor& run);

    int angle_count() const { return angle_count_; }
    double cosine(int angle) const { return cosines_[angle]; }

    /// Adds sum over the block's spheres of |S1 + S2|^2 + |S1 - S2|^2 at each angle; with the
    /// weights of SphereSums this is P times 2 * scattered.
    void add_intensity(const SphereBlockOf<Scalar>& block, Eigen::VectorXd& intensity) const;
    /// Adds it with each column times a factor of its own at each angle.
    /// @param factors  row = angle, column = that of the block
    using Factors = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    void add_intensity(const SphereBlockOf<Scalar>& block, const Eigen::Ref<const Factors>& factors,
                       Eigen::VectorXd& intensity) const;

    /// Adds the same of |S1 + S2|^2, |S1 - S2|^2, Re and Im (S1 + S2)(S1 - S2)*, one column each:
    /// all of the scattering matrix.
    void add_products(const SphereBlockOf<Scalar>& block, Eigen::ArrayXXd& products) const;

    /// S1 + S2 and S1 - S2 of each sphere: row = angle, columns [0, size) real, then imaginary.
    struct Amplitudes {
        typename SphereBlockOf<Scalar>::Matrix sum, difference;
    };
    Amplitudes amplitudes(const SphereBlockOf<Scalar>& block) const;
    /// Adds those products with A = S1 + S2, B = S1 - S2 of one block and A', B' of another:
    /// Re A A'*, Re B B'*, Re and Im A B'*; the first two where there are two columns.
    /// @param factors  of each sphere; empty: 1
    static void add_products(const Amplitudes& one, const Amplitudes& other,
                             const Eigen::Array<Scalar, 1, Eigen::Dynamic>& factors,
                             Eigen::ArrayXXd& products);

    using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

    /// Adds weight times the same of waves that are known by their products: forms of
    /// U_n and U_m*, n = first + row, m = first + column, and of V.
    void add_forms(double weight, const TriangularForm<Scalar>& plus,
                   const TriangularForm<Scalar>& minus, int first,
                   Eigen::VectorXd& intensity) const;

  private:
    void make_room(Eigen::Index angle_count, int terms);
    void fill(const Eigen::ArrayXd& mu, const Executor& run);
    void fill_tile(int tile, const double* cosines);

    int tile_count() const;
    int angles_in(int tile) const;
    const Scalar* of_tile(const Matrix& functions, int tile, int order) const;

    using Waves = typename SphereBlockOf<Scalar>::Matrix;
    template <typename Visit>
    void visit_amplitudes(const Matrix& functions, const SphereBlockOf<Scalar>& block,
                          const Waves& waves, const Visit& visit) const;
    Waves amplitudes(const Matrix& functions, const SphereBlockOf<Scalar>& block,
                     const Waves& waves) const;

    int angle_count_ = 0, terms_ = 0;
    Eigen::ArrayXd cosines_;
    // Tile by tile of kAnglesPerTile angles: row = angle of the tile, column = n (0 unused) of the
    // first tile, of the second, ...
    Matrix plus_, minus_;
};

using AngularFunctions = AngularFunctionsOf<double>;

/// Tables in the precision that the sums at their angles have.
using AngularTables = std::variant<AngularFunctions, AngularFunctionsOf<float>>;

/// Tables at cosines in [-1, 1].
AngularTables angular_tables(const Eigen::ArrayXd& cosines, int terms, bool single_precision,
                             const Executor& run);

inline bool is_single(const AngularTables& tables) {
    return std::holds_alternative<AngularFunctionsOf<float>>(tables);
}

/// Sums over sizes, weighted by their share of the geometric cross-section over x^2.
struct SizeSums {
    SphereSums spheres;
    SphereSums every_other;     ///< of the first, third, ... size alone
    BandCovariance covariance;  ///< empty without moments
    Eigen::VectorXd intensity;  ///< at the angles asked for
    Eigen::ArrayXXd products;   ///< the same, of add_products; of spheroids their series
    double doubt = 0;           ///< error of `spheres.scattered`: of T-matrices

    void add(const SizeSums& other);
    void scale(double factor);
};

/// The sums that are wanted besides efficiencies and g.
struct SizeSumOptions {
    int terms = 0;                          ///< partial waves of the largest sphere
    int band_width = -1;                    ///< of the covariance; -1: none
    bool single_precision = false;          ///< of products; with angles that of their tables
    const AngularTables* angles = nullptr;  ///< where intensities are summed
    bool with_matrix = false;               ///< products at the angles, not intensities
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

    /// Chunks for several threads, and the least sizes of each.
    static constexpr int kMost = 4, kLeast = 32;

    /// @param most  chunks; fewer when each would have less than kLeast sizes
    explicit SizeChunks(int size_count, int most = kMost);
    int count() const { return count_; }
    std::vector<Block> blocks(int chunk) const;

  private:
    int size_count_, count_, per_chunk_;
};

/// Which of `count` chunks, listed from small to large spheres, a job takes: large and small ones
/// in turn, so that both halves of the jobs (that is how an executor shares them out) cost the
/// same.
inline int chunk_of_job(int job, int count) { return job % 2 == 0 ? count - 1 - job / 2 : job / 2; }

constexpr int kMostSizesPerBlock = 40;

/// Sums over all sizes, in chunks of blocks that do not depend on the executor.
SizeSums sum_over_sizes(const Scatterer& scatterer, const WeightedSizes& sizes,
                        const SizeSumOptions& options, const Executor& run);

}  // namespace miebrdf::mie
