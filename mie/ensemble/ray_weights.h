// Sizes weighted so that what is known to interfere among rays averages out.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "mie/ensemble/ray_phase.h"
#include "mie/sphere/lane_math.h"

namespace miebrdf::mie {

/// Rays of one number of ways p that come to one angle from several places of the sphere interfere:
/// the intensity has terms that turn with the size x as cos(f x) and sin(f x), slowly varying
/// factors aside. Geometric optics gives f: a ray that meets the sphere at the sine b of its angle
/// of incidence leaves with the phase 2 x [p (m^2 - b^2)^(1/2) - (1 - b^2)^(1/2)] (van de Hulst
/// 1957, section 12.22). Few sizes meet such a term at like phases, and what it leaves of their
/// mean is all of the noise of P by rays. Here the weights of the sizes are changed by no more than
/// is needed to give these terms, and low powers of ln x, the mean that they have over all sizes.
class RayInterference {
  public:
    /// The conditions that the sizes are to meet at one angle.
    struct Terms {
        std::vector<double> rates;  ///< f
        Eigen::VectorXd means;      ///< over all sizes, in the order of the rows of the conditions
    };

    /// Sizes that are to meet it.
    struct Sampled {
        Eigen::ArrayXd x, scaled;    ///< scaled: ln x, from -1 to 1 over all sizes
        Eigen::ArrayXd root_shares;  ///< of the area
    };

    RayInterference(double index, const RaySizes& sizes);

    Terms terms(int way, double theta) const;
    /// Whether there are any: where not, the intensity is smooth in size.
    bool is_seen(int way, double theta) const { return !rates(way, theta).empty(); }
    Sampled sampled(const WeightedSizes& sizes) const;
    /// New weights over those of the sizes: the least change, in squares. All 1 where these sizes
    /// cannot meet the terms without large weights of both signs.
    Eigen::VectorXd factors(const Terms& terms, const Sampled& sizes) const;
    /// Such factors for both samples, angle by angle, for the columns of a group that is way by
    /// way: those of eight sizes, then those of the next eight.
    std::array<AngularFunctionsOf<float>::Factors, 2> factors_of_columns(
        const RayGroup& group, const WeightedSizes* const (&sizes)[2],
        const AngularFunctionsOf<float>& angular, const Executor& run) const;

  private:
    struct Incidence {
        double outside, inside;  // angles of incidence and refraction
    };
    struct Ray {
        double phase, intensity;
    };
    void add_rays(int way, double angle, std::size_t first, std::size_t last,
                  std::vector<Ray>& to) const;
    std::vector<Ray> rays(int way, double theta) const;
    std::vector<double> rates(int way, double theta) const;
    Ray ray(int way, double outside, double target) const;
    double deviation(int way, double outside, double inside) const;
    double scaled(double x) const;  // ln x, from -1 to 1
    void put_means(double rate, double* means) const;

    double index_, smallest_x_, largest_x_;
    double log_centre_, log_half_;
    std::vector<Incidence> incidences_;
    // Gauss rules on pieces of equal width: the share of all sizes at the nodes of a piece, and the
    // same times ln x.
    double piece_width_ = 0;
    Lanes first_nodes_;
    std::vector<Lanes> shares_, scaled_shares_;
    Eigen::VectorXd means_of_powers_;
};

}  // namespace miebrdf::mie
