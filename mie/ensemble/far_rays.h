// Rays of many ways through a sphere, summed in closed form.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "mie/ensemble/size_sums.h"

namespace miebrdf::mie {

struct RayIntensity {
    Eigen::VectorXd at_angles;
    double scattered = 0;  ///< as PairedIntensity
};

/// The intensity of all rays from first_way on, incoherently:
///     sum_p <S_p S_p*> = sum_{n,m} F_n F_m <B_n B_m* / (1 - R_n R_m*)> / 4,
///     B_n = T_n R_n^(first_way - 1),
/// with the responses T, R of RayResponse and the angular functions F: nothing of the interference
/// between rays of different ways is sampled, nor any resonance. Rays of many ways are those of the
/// orders near x, some tens of them: the cost is their number squared for each size.
RayIntensity intensity_of_far_rays(std::complex<double> relative_index, int first_way,
                                   const WeightedSizes& sizes, int first_size, int size_count,
                                   const AngularFunctionsOf<float>& angular);

}  // namespace miebrdf::mie
