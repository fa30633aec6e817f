#include "mie/angular_functions.h"

#include "mie/amplitudes.h"

namespace miebrdf::mie {

AngularFunctions::AngularFunctions(std::span<const double> angles_deg, int terms)
    : plus_(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(angles_deg.size()), terms + 1)),
      minus_(plus_) {
    for (Eigen::Index row = 0; row < plus_.rows(); ++row) {
        const double mu = cosine_of_scattering_angle(angles_deg[row]);
        double pi_before = 0, pi = 1;
        for (int n = 1; n <= terms; ++n) {  // as in scattering_amplitudes
            const double s = mu * pi;
            const double t = s - pi_before;
            const double tau = n * t - pi_before;
            const double weight = (2.0 * n + 1.0) / (n * (n + 1.0));
            plus_(row, n) = weight * (pi + tau);
            minus_(row, n) = weight * (pi - tau);
            pi_before = pi;
            pi = s + (n + 1.0) / n * t;
        }
    }
}

void AngularFunctions::add_intensity(const SphereBlock& block, Eigen::VectorXd& intensity) const {
    const Eigen::Index columns = 2 * block.size;
    Eigen::MatrixXd amplitude(plus_.rows(), columns);
    amplitude.noalias() =
        plus_.middleCols(1, block.terms) * block.U.block(1, 0, block.terms, columns);
    intensity += amplitude.rowwise().squaredNorm();
    amplitude.noalias() =
        minus_.middleCols(1, block.terms) * block.V.block(1, 0, block.terms, columns);
    intensity += amplitude.rowwise().squaredNorm();
}

}  // namespace miebrdf::mie
