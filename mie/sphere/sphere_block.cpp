#include "mie/sphere/sphere_block.h"

#include <algorithm>

#include "mie/sphere/sphere_lanes.h"
#include "mie/sphere/terms.h"

namespace miebrdf::mie {

void SphereSums::add(const SphereSums& other) {
    scattered += other.scattered;
    absorbed += other.absorbed;
    asymmetric += other.asymmetric;
}

void SphereSums::scale(double factor) {
    scattered *= factor;
    absorbed *= factor;
    asymmetric *= factor;
}

template <typename Scalar>
void SphereBlockOf<Scalar>::make_room(int new_terms, int new_size) {
    terms = new_terms;
    size = new_size;
    if (U.rows() >= terms + 1 && U.cols() == 2 * size) return;
    U.resize(terms + 1, 2 * size);
    V.resize(terms + 1, 2 * size);
}

template <typename Scalar>
SphereSums compute_spheres(std::complex<double> relative_index,
                           std::span<const double> size_parameters, std::span<const double> weights,
                           SphereBlockOf<Scalar>* block) {
    const int count = static_cast<int>(size_parameters.size());
    SphereSums total;
    if (block) {
        block->make_room(number_of_terms(size_parameters[count - 1]),
                         (count + lane_count - 1) / lane_count * lane_count);
    }
    for (int first = 0; first < count; first += lane_count) {
        Lanes x, weight;
        for (int lane = 0; lane < lane_count; ++lane) {
            const int i = std::min(first + lane, count - 1);  // the last one fills up, unweighted
            x[lane] = size_parameters[i];
            weight[lane] = first + lane < count ? weights[i] : 0.0;
        }
        const BlockColumns<Scalar> columns{block, first, weight.sqrt()};
        const LaneSums sums = compute_eight(relative_index, x, columns);
        total.scattered += (weight * sums.scattered).sum();
        total.absorbed += (weight * sums.absorbed).sum();
        total.asymmetric += (weight * sums.asymmetric).sum();
    }
    return total;
}

SphereSums compute_spheres(std::complex<double> relative_index,
                           std::span<const double> size_parameters, std::span<const double> weights,
                           std::nullptr_t) {
    SphereBlock* nowhere = nullptr;
    return compute_spheres(relative_index, size_parameters, weights, nowhere);
}

template struct SphereBlockOf<float>;
template struct SphereBlockOf<double>;
template SphereSums compute_spheres(std::complex<double>, std::span<const double>,
                                    std::span<const double>, SphereBlockOf<float>*);
template SphereSums compute_spheres(std::complex<double>, std::span<const double>,
                                    std::span<const double>, SphereBlockOf<double>*);

}  // namespace miebrdf::mie
