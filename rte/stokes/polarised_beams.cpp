#include "rte/stokes/polarised_beams.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rte/first_order/first_order.h"
#include "rte/grid/refraction_grid.h"
#include "rte/phase/polarisation.h"
#include "rte/stack/refracted_first_order.h"

namespace miebrdf::rte {
namespace {

const FresnelMatrix kWhole = FresnelMatrix::identity();

// A boundary over what returns s: r + (1 - r)^2 s / (1 - r s).
FresnelMatrix seen_through(const FresnelMatrix& r, const FresnelMatrix& s) {
    const FresnelMatrix t = passing(r);
    return r + t * t * s / (kWhole - r * s);
}

// A beam's way through every medium, and what comes back of it, seen from above.
struct PolarisedReturns {
    std::vector<double> mu, attenuation;              ///< in each medium
    std::vector<FresnelMatrix> step, step_and_below;  ///< boundary at its bottom; with all below
    FresnelMatrix top;                                ///< at the top of the topmost medium
};

PolarisedReturns polarised_returns(const ScaledStack& stack, double mu_air) {
    PolarisedReturns beam;
    double below_index = stack.ground_index;
    FresnelMatrix from_below;
    if (stack.base == BaseKind::mirror) {
        from_below = fresnel_reflection(below_index, stack.mirror_index,
                                        refracted_cosine(below_index, mu_air));
    }
    for (const ScaledMedium& medium : stack.media) {
        const double mu = refracted_cosine(medium.index, mu_air);
        const FresnelMatrix r = fresnel_reflection(medium.index, below_index, mu);
        beam.mu.push_back(mu);
        beam.attenuation.push_back(std::exp(-medium.scaled_optical_depth / mu));
        beam.step.push_back(r);
        beam.step_and_below.push_back(seen_through(r, from_below));
        const double attenuation = beam.attenuation.back();
        from_below = beam.step_and_below.back() * (attenuation * attenuation);
        below_index = medium.index;
    }
    beam.top = from_below;
    return beam;
}

// F of a medium at an angle, times albedo / (1 - albedo f).
ScatteringMatrix strength_of(const ScaledMedium& medium, const Optics& seen, double cosine) {
    const double factor = seen.single_scattering_albedo / medium.scaled.depth_factor;
    ScatteringMatrix F = exact_matrix(seen, cosine);
    for (double* element : {&F.a1, &F.a2, &F.a3, &F.a4, &F.b1, &F.b2}) *element *= factor;
    return F;
}

// All that light scattered once in one medium sends from one beam into another.
Eigen::Matrix4d scattered_once(const ScaledMedium& medium, const Optics& seen,
                               const PolarisedBeam& in, const PolarisedBeam& out,
                               double azimuth_deg) {
    const double tau = medium.scaled_optical_depth;
    const double n2 = medium.index * medium.index;
    const double cosine = std::cos(azimuth_deg * (std::numbers::pi / 180.0));
    const Eigen::Vector4d mirrored(1.0, 1.0, -1.0, -1.0);
    const auto upside_down = [&](const Eigen::Matrix4d& M) -> Eigen::Matrix4d {
        return mirrored.asDiagonal() * M * mirrored.asDiagonal();
    };
    const Eigen::Matrix4d in_down = mueller_of(in.down), in_up = mueller_of(in.up);
    const Eigen::Matrix4d out_down = mueller_of(out.down), out_up = mueller_of(out.up);
    const Eigen::Matrix4d back =
        turned_to_meridians(strength_of(medium, seen, cos_scattering_angle(in.mu, out.mu, cosine)),
                            in.mu, out.mu, azimuth_deg);
    Eigen::Matrix4d sum =
        (out_down * back * in_down + out_up * upside_down(back) * in_up) *
        (-std::expm1(-tau * (1.0 / in.mu + 1.0 / out.mu)) / (4.0 * n2 * (in.mu + out.mu)));
    if (in.up.unpolarised() <= 0.0 && out.up.unpolarised() <= 0.0) return sum;
    const Eigen::Matrix4d on =
        turned_forward(strength_of(medium, seen, cos_forward_angle(in.mu, out.mu, cosine)), in.mu,
                       out.mu, azimuth_deg);
    sum += (out_up * on * in_down + out_down * upside_down(on) * in_up) *
           (forward_quotient(tau, in.mu, out.mu) / (4.0 * n2));
    return sum;
}

// What a smooth boundary makes of light scattered once below it, straight in and out.
Eigen::Matrix4d seen_from_air(const Eigen::Matrix4d& inside, double n, double mu_in,
                              double mu_out) {
    const Eigen::Matrix4d in = mueller_of(passing(fresnel_reflection(1.0, n, mu_in)));
    const Eigen::Matrix4d out = mueller_of(passing(fresnel_reflection(1.0, n, mu_out)));
    return out * inside * in / (n * n);
}

Eigen::Matrix4d scattered_inside(const ScaledStack& stack, const std::vector<Optics>& seen,
                                 double mu_in_air, double mu_out_air, double azimuth_deg) {
    return scattered_once(stack.media, seen, refracted_cosine(stack.top_index, mu_in_air),
                          refracted_cosine(stack.top_index, mu_out_air), azimuth_deg);
}

}  // namespace

Eigen::Matrix4d scattered_once(const ScaledStack& stack, const std::vector<Optics>& seen,
                               double mu_in, double mu_out, double azimuth_deg) {
    if (has_straight_paths(stack)) {
        return seen_from_air(scattered_inside(stack, seen, mu_in, mu_out, azimuth_deg),
                             stack.top_index, mu_in, mu_out);
    }
    const auto in = polarised_beams(stack, mu_in), out = polarised_beams(stack, mu_out);
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
    for (std::size_t k = 0; k < stack.media.size(); ++k)
        sum += scattered_once(stack.media[k], seen[k], in[k], out[k], azimuth_deg);
    return sum;
}

double change_of_straight_paths(const ScaledStack& stack, const std::vector<Optics>& seen,
                                double mu_in, double mu_out, double azimuth_deg) {
    const Eigen::Matrix4d inside = scattered_inside(stack, seen, mu_in, mu_out, azimuth_deg);
    const double unpolarised = inside(0, 0) * straight_paths_factor(stack.top_index, mu_in, mu_out);
    if (!(unpolarised > 0.0)) return 1.0;
    return seen_from_air(inside, stack.top_index, mu_in, mu_out)(0, 0) / unpolarised;
}

std::vector<PolarisedBeam> polarised_beams(const ScaledStack& stack, double mu_air) {
    const PolarisedReturns returns = polarised_returns(stack, mu_air);
    std::vector<PolarisedBeam> beams(stack.media.size());
    const FresnelMatrix r = fresnel_reflection(1.0, stack.top_index, mu_air);
    FresnelMatrix down = passing(r) / (kWhole - r * returns.top);
    for (std::size_t i = beams.size(); i-- > 0;) {
        beams[i] = {returns.mu[i], down, down * returns.step_and_below[i] * returns.attenuation[i]};
        down = down * returns.attenuation[i];
        if (i == 0) break;
        const double below = returns.attenuation[i - 1];
        const FresnelMatrix seen = returns.step_and_below[i - 1] * (below * below);
        down = down * passing(returns.step[i]) / (kWhole - returns.step[i] * seen);
    }
    return beams;
}

FresnelMatrix polarised_mirror_reflection(const ScaledStack& stack, double mu_air) {
    return seen_through(fresnel_reflection(1.0, stack.top_index, mu_air),
                        polarised_returns(stack, mu_air).top);
}

StokesFirstOrderOfStack::StokesFirstOrderOfStack(const Directions& directions, int components,
                                                 const SolverOptions& options)
    : directions_(directions), components_(components), options_(options) {}

void StokesFirstOrderOfStack::add_to(std::vector<double>& reflection, const ScaledStack& stack) {
    if (has_straight_paths(stack)) {
        add_straight(reflection, stack);
    } else {
        add_all_paths(reflection, stack);
    }
}

void StokesFirstOrderOfStack::add_straight(std::vector<double>& reflection,
                                           const ScaledStack& stack) {
    const double n = stack.top_index;
    if (!straight_) {
        inside_ = refracted(directions_, n);
        straight_.emplace(inside_, components_, options_);
    }
    if (n == 1.0) {
        straight_->add_to(reflection, stack.media);
        return;
    }
    std::vector<double> inside(reflection.size(), 0.0);
    straight_->add_to(inside, stack.media);
    const auto c = Eigen::Index(components_);
    const auto azimuths = Eigen::Index(directions_.azimuth_deg.size());
    std::size_t first = 0;
    for (const double mu_in : directions_.mu_in) {
        const Eigen::Matrix4d in = mueller_of(passing(fresnel_reflection(1.0, n, mu_in)));
        for (const double mu_out : directions_.mu_out) {
            const Eigen::Matrix4d out = mueller_of(passing(fresnel_reflection(1.0, n, mu_out)));
            for (Eigen::Index a = 0; a < azimuths; ++a) {
                using Strided = Eigen::Map<Eigen::Matrix<double, -1, -1, Eigen::RowMajor>, 0,
                                           Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;
                const Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic> stride(c * azimuths, azimuths);
                const Strided within(inside.data() + first + std::size_t(a), c, c, stride);
                Strided outside(reflection.data() + first + std::size_t(a), c, c, stride);
                outside += out.topLeftCorner(c, c) * within * in.topLeftCorner(c, c) / (n * n);
            }
            first += std::size_t(c * c * azimuths);
        }
    }
}

void StokesFirstOrderOfStack::add_all_paths(std::vector<double>& reflection,
                                            const ScaledStack& stack) const {
    const std::vector<Optics> seen =
        media_of_first_order(stack.media, options_.single_scattering_correction);
    const std::size_t azimuths = directions_.azimuth_deg.size();
    const auto c = std::size_t(components_);
    std::size_t first = 0;
    for (const double mu_in : directions_.mu_in) {
        for (const double mu_out : directions_.mu_out) {
            for (std::size_t a = 0; a < azimuths; ++a) {
                const Eigen::Matrix4d sum =
                    rte::scattered_once(stack, seen, mu_in, mu_out, directions_.azimuth_deg[a]);
                for (std::size_t e = 0; e < c * c; ++e)
                    reflection[first + e * azimuths + a] +=
                        sum(Eigen::Index(e / c), Eigen::Index(e % c));
            }
            first += c * c * azimuths;
        }
    }
}

}  // namespace miebrdf::rte
