#include "rte/first_order/ways.h"

#include <algorithm>
#include <cmath>

#include "rte/first_order/beams.h"
#include "rte/first_order/meridian_planes.h"
#include "rte/phase/polarisation.h"

namespace miebrdf::rte {
namespace {

/// (exp(-tau / mu) - exp(-tau / mu')) / (mu - mu'), 0 for a layer without bottom.
double forward_quotient(double tau, double mu, double other) {
    if (std::isinf(tau)) return 0.0;
    const double a = tau / std::max(mu, other), b = tau / std::min(mu, other);
    const double x = b - a;
    const double mean = x > 0.0 ? -std::expm1(-x) / x : 1.0;
    return std::exp(-a) * mean * tau / (mu * other);
}

}  // namespace

double strength_of(const ScaledMedium& medium, const Optics& seen) {
    return seen.single_scattering_albedo / medium.scaled.depth_factor;
}

ShareWeights::ShareWeights(const ScaledMedium& medium, double mu_in, double mu_out) {
    const double tau = medium.scaled_optical_depth, n2 = medium.index * medium.index;
    back = -std::expm1(-tau * (1.0 / mu_in + 1.0 / mu_out)) / (4.0 * n2 * (mu_in + mu_out));
    forward = forward_quotient(tau, mu_in, mu_out) / (4.0 * n2);
}

Eigen::Matrix4d PolarisedWays::matrix(const ScatteringMatrix& F, const ScatteringMatrix& F_forward,
                                      double azimuth_deg) const {
    const Eigen::Vector4d mirrored(1.0, 1.0, -1.0, -1.0);
    const auto upside_down = [&](const Eigen::Matrix4d& M) -> Eigen::Matrix4d {
        return mirrored.asDiagonal() * M * mirrored.asDiagonal();
    };
    const Eigen::Matrix4d turned = turned_to_meridians(F, mu_in, mu_out, azimuth_deg);
    Eigen::Matrix4d sum = back * (out_down * turned * in_down);
    if (!(forward > 0.0)) return sum;
    const Eigen::Matrix4d on = turned_forward(F_forward, mu_in, mu_out, azimuth_deg);
    sum += back * (out_up * upside_down(turned) * in_up) +
           forward * (out_up * on * in_down + out_down * upside_down(on) * in_up);
    return sum;
}

double PolarisedWays::intensity(const ScatteringMatrix& F, const ScatteringMatrix& F_forward,
                                double half_cosine, double half_sine) const {
    // Boundaries and mirrors do not mix I and Q with U and V.
    const auto between = [](const Eigen::Matrix4d& out, const Eigen::Matrix2d& M,
                            const Eigen::Matrix4d& in) {
        return out(0, 0) * (M(0, 0) * in(0, 0) + M(0, 1) * in(1, 0)) +
               out(0, 1) * (M(1, 0) * in(0, 0) + M(1, 1) * in(1, 0));
    };
    const Eigen::Matrix2d turned = turned_intensity(F, mu_in, mu_out, half_cosine, half_sine);
    const double sum = back * between(out_down, turned, in_down);
    if (!(forward > 0.0)) return sum;
    const Eigen::Matrix2d on =
        turned_forward_intensity(F_forward, mu_in, mu_out, half_cosine, half_sine);
    return sum + back * between(out_up, turned, in_up) +
           forward * (between(out_up, on, in_down) + between(out_down, on, in_up));
}

std::vector<PolarisedWays> polarised_ways(const FirstOrder& first_order, double mu_in,
                                          double mu_out) {
    const ScaledStack& stack = first_order.stack();
    const auto in = beams_of<FresnelMatrix>(stack, mu_in);
    const auto out = beams_of<FresnelMatrix>(stack, mu_out);
    std::vector<PolarisedWays> ways;
    ways.reserve(in.size());
    for (std::size_t k = 0; k < in.size(); ++k) {
        const ScaledMedium& medium = stack.media[k];
        const ShareWeights share(medium, in[k].mu, out[k].mu);
        const double strength = strength_of(medium, first_order.optics(k));
        const bool any_up = in[k].up.unpolarised() > 0.0 || out[k].up.unpolarised() > 0.0;
        ways.push_back({in[k].mu, out[k].mu, strength * share.back,
                        any_up ? strength * share.forward : 0.0, mueller_of(in[k].down),
                        mueller_of(in[k].up), mueller_of(out[k].down), mueller_of(out[k].up)});
    }
    return ways;
}

Eigen::Matrix4d scattered_matrix(const FirstOrder& first_order,
                                 const std::vector<PolarisedWays>& ways, double cosine,
                                 double azimuth_deg, std::vector<ScatteringMatrix>& back,
                                 std::vector<ScatteringMatrix>& forward) {
    back.resize(ways.size());
    forward.resize(ways.size());
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
    for (std::size_t k = 0; k < ways.size(); ++k) {
        const ScatteringAngles angles(ways[k].mu_in, ways[k].mu_out);
        back[k] = exact_matrix(first_order.optics(k), angles.back(cosine));
        if (ways[k].forward > 0.0)
            forward[k] = exact_matrix(first_order.optics(k), angles.forward(cosine));
        sum += ways[k].matrix(back[k], forward[k], azimuth_deg);
    }
    return sum;
}

}  // namespace miebrdf::rte
