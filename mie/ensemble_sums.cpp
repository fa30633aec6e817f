#include "mie/ensemble_average.h"

namespace miebrdf::mie {

void EnsembleSums::add(const EnsembleSums& other) {
    spheres.scattered += other.spheres.scattered;
    spheres.absorbed += other.spheres.absorbed;
    spheres.asymmetric += other.spheres.asymmetric;
    if (covariance.width() >= 0) covariance.add(other.covariance);
    if (intensity.size() > 0) intensity += other.intensity;
}

void EnsembleSums::scale(double factor) {
    spheres.scattered *= factor;
    spheres.absorbed *= factor;
    spheres.asymmetric *= factor;
    covariance.scale(factor);
    intensity *= factor;
}

}  // namespace miebrdf::mie
