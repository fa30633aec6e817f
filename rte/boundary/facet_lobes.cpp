#include "rte/boundary/facet_lobes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "rte/math/chebyshev.h"
#include "rte/math/interruption.h"
#include "rte/surface/fresnel.h"
#include "rte/surface/microfacet.h"

namespace miebrdf::rte {
namespace {

// The scale is 1 at the zenith, changes within a few degrees of the horizon, and is known to 1e-6
// between so many points of mu^(1/2).
constexpr int kScalePoints = 24;
constexpr int kMostPasses = 200;
constexpr double kSettled = 1e-12;

const math::ChebyshevPoints& scale_points() {
    static const math::ChebyshevPoints points(kScalePoints);
    return points;
}

Eigen::VectorXd cosines_of_points() {
    Eigen::VectorXd mu(kScalePoints);
    for (int k = 0; k < kScalePoints; ++k) mu[k] = std::pow(0.5 * (1.0 + scale_points()[k]), 2);
    return mu;
}

}  // namespace

OuterLobeScale::OuterLobeScale(std::shared_ptr<const RoughBoundary> boundary)
    : boundary_(std::move(boundary)), scale_(Eigen::VectorXd::Ones(kScalePoints)) {
    const Eigen::VectorXd mu = cosines_of_points();
    const Eigen::VectorXd reflected = boundary_->from_air(mu).outer_reflectance.cwiseMax(0.0);
    Eigen::MatrixXd sent(kScalePoints, kScalePoints);
    for (int k = 0; k < kScalePoints; ++k) sent.row(k) = sent_to_points(mu[k]);
    for (int pass = 0; pass < kMostPasses; ++pass) {
        const Eigen::VectorXd alone = reflected.cwiseQuotient(sent * scale_);
        const Eigen::VectorXd next = scale_.cwiseProduct(alone).cwiseSqrt();
        const double change = (next - scale_).cwiseAbs().maxCoeff();
        scale_ = next;
        if (change <= kSettled) break;
    }
}

Eigen::VectorXd OuterLobeScale::functions_at(double mu) const {
    return scale_points().weights(2.0 * std::sqrt(mu) - 1.0);
}

/// The energy that one facet reflects, by the functions of the points.
Eigen::RowVectorXd OuterLobeScale::sent_to_points(double mu_air) const {
    const RoughSurface& surface = boundary_->surface();
    const ScatteredRays rays =
        unhidden(scatter_by_facets(boundary_->index(), surface, mu_air), surface, mu_air).reflected;
    Eigen::RowVectorXd sent = Eigen::RowVectorXd::Zero(kScalePoints);
    for (std::size_t k = 0; k < rays.mu.size(); ++k)
        sent += rays.energy[k] * functions_at(rays.mu[k]).transpose();
    return sent;
}

Eigen::VectorXd OuterLobeScale::at(const Eigen::VectorXd& mu_air) const {
    Eigen::VectorXd scale = boundary_->from_air(mu_air).outer_reflectance.cwiseMax(0.0);
    for (Eigen::Index k = 0; k < scale.size(); ++k) scale[k] /= sent_to_points(mu_air[k]) * scale_;
    return scale;
}

namespace {

double one_plus_lambda_of(const RoughSurface& surface, double mu) {
    return cosine_over_masking(surface.distribution, surface.alpha, mu) / mu;
}

}  // namespace

MirroredLobe::MirroredLobe(double index, const RoughSurface& surface, UnscatteredReturn returned)
    : index_(index), surface_(surface), returned_(std::move(returned)) {}

MirroredLobe::Returning MirroredLobe::entering(double mu_air) const {
    const ScatteredRays rays =
        unhidden(scatter_by_facets(index_, surface_, mu_air), surface_, mu_air).refracted;
    Returning light;
    for (std::size_t k = 0; k < rays.mu.size(); ++k) {
        const double mu = rays.mu[k];
        const double energy = rays.energy[k] * returned_(mu);
        if (!(energy > 0.0)) continue;
        light.energy.push_back(energy);
        light.mu.push_back(mu);
        light.sine.push_back(std::sqrt(std::max(0.0, (1.0 - mu) * (1.0 + mu))));
        const double cosine = std::clamp(rays.cos_azimuth[k], -1.0, 1.0);
        light.cos_azimuth.push_back(cosine);
        light.sin_azimuth.push_back(std::sqrt((1.0 - cosine) * (1.0 + cosine)));
        light.one_plus_lambda.push_back(one_plus_lambda_of(surface_, mu));
    }
    return light;
}

/// The sum over rays of energy times the BTDF into air, by its reciprocal: from air, n^2 times
/// that. Walter et al. 2007, eq. 21. A ray stands for its mirror image on the other side of the
/// plane of incidence too.
double MirroredLobe::leaving(const Returning& light, const Leaving& towards, double azimuth) const {
    const double cosine = std::cos(azimuth), sine = std::sin(azimuth);
    const double peak = normal_density(surface_.distribution, surface_.alpha, 0.0);
    constexpr double faint = 1e-10;  // of the largest density
    double sum = 0.0;
    for (std::size_t k = 0; k < light.energy.size(); ++k) {
        const double mu = light.mu[k];
        for (const double side : {1.0, -1.0}) {
            // Between the heading of the ray and that of the light that leaves.
            const double along = light.cos_azimuth[k] * cosine + side * light.sin_azimuth[k] * sine;
            const double across =
                light.sin_azimuth[k] * cosine - side * light.cos_azimuth[k] * sine;
            // The light leaves along +x; the normal is along n w - v, w the ray and v in air.
            const double nx = index_ * light.sine[k] * along - towards.sine;
            const double ny = index_ * light.sine[k] * across;
            const double nz = index_ * mu - towards.mu;
            if (!(nz > 0.0)) continue;
            const double tan2 = (nx * nx + ny * ny) / (nz * nz);
            const double density = normal_density(surface_.distribution, surface_.alpha, tan2);
            if (!(density > faint * peak)) continue;
            const double length = std::sqrt(nx * nx + ny * ny + nz * nz);
            const double met = (towards.mu * nz + towards.sine * nx) / length;
            const double left = (mu * nz + light.sine[k] * (along * nx + across * ny)) / length;
            if (!(met > 0.0 && left > 0.0)) continue;
            const double step = index_ * left - met;
            sum += 0.5 * light.energy[k] * density * met * left *
                   (1.0 - fresnel_reflectance(index_, std::min(1.0, met))) *
                   seen_from_both_sides(towards.one_plus_lambda, light.one_plus_lambda[k]) /
                   (towards.mu * mu * step * step);
        }
    }
    return sum;
}

void MirroredLobe::add_to(std::vector<double>& reflection, const Directions& directions,
                          const Eigen::VectorXd& scale_in, const Eigen::VectorXd& scale_out) const {
    const auto all = [this](const std::vector<double>& cosines) {
        std::vector<std::pair<Returning, Leaving>> list;
        for (const double mu : cosines) {
            list.push_back(
                {entering(mu),
                 {mu, std::sqrt((1.0 - mu) * (1.0 + mu)), one_plus_lambda_of(surface_, mu)}});
        }
        return list;
    };
    const bool is_symmetric = directions.mu_in == directions.mu_out;
    const auto in = all(directions.mu_in);
    const auto out = is_symmetric ? in : all(directions.mu_out);
    const std::size_t azimuths = directions.azimuth_deg.size();
    std::vector<double> lobe(azimuths);
    for (std::size_t i = 0; i < in.size(); ++i) {
        math::interruption_point();
        for (std::size_t o = is_symmetric ? i : 0; o < out.size(); ++o) {
            const double scale =
                0.5 * std::numbers::pi * scale_in[Eigen::Index(i)] * scale_out[Eigen::Index(o)];
            // There and back again, so that both are the same to rounding.
            for (std::size_t a = 0; a < azimuths; ++a) {
                const double azimuth = directions.azimuth_deg[a] * (std::numbers::pi / 180.0);
                lobe[a] = scale * (leaving(in[i].first, out[o].second, azimuth) +
                                   leaving(out[o].first, in[i].second, azimuth));
                reflection[(i * out.size() + o) * azimuths + a] += lobe[a];
            }
            if (!is_symmetric || o == i) continue;
            for (std::size_t a = 0; a < azimuths; ++a)
                reflection[(o * out.size() + i) * azimuths + a] += lobe[a];
        }
    }
}

}  // namespace miebrdf::rte
