#include "rte/boundary/facet_lobes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "rte/boundary/smooth_boundary.h"
#include "rte/grid/refraction_grid.h"
#include "rte/math/chebyshev.h"
#include "rte/math/cosine_series.h"
#include "rte/math/interruption.h"
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

constexpr int kMostOrders = 1024;  // a narrower lobe is followed ray by ray
// Facets seen edge on end the lobe of a rough surface with a step, which so many azimuths and
// cosines describe to 2e-4 of the largest value; 45 to 1e-3 (GGX, alpha 0.4).
constexpr int kLeastSamples = 256;

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

/// From one cosine inside to one in air, or back: the BTDF from air over n^2, that into air times
/// n^2. Walter et al. 2007, eq. 21.
class MirroredLobe::Passage {
  public:
    Passage(double index, const RoughSurface& surface, double mu, double sine,
            double one_plus_lambda, const Leaving& towards)
        : index_(index),
          surface_(surface),
          mu_(mu),
          sine_(sine),
          air_(towards),
          nz_(index * mu - towards.mu),
          seen_(seen_from_both_sides(towards.one_plus_lambda, one_plus_lambda) /
                (towards.mu * mu)) {}

    /// Of headings that differ by an azimuth of this cosine and sine.
    double operator()(double along, double across) const {
        if (!(nz_ > 0.0)) return 0.0;
        // The light in air goes along +x; the normal is along n w - v, w inside and v in air.
        const double nx = index_ * sine_ * along - air_.sine;
        const double ny = index_ * sine_ * across;
        const double horizontal2 = nx * nx + ny * ny;
        const double density =
            normal_density(surface_.distribution, surface_.alpha, horizontal2 / (nz_ * nz_));
        const double length = std::sqrt(horizontal2 + nz_ * nz_);
        const double met = (air_.mu * nz_ + air_.sine * nx) / length;
        const double left = (mu_ * nz_ + sine_ * (along * nx + across * ny)) / length;
        if (!(density > 0.0 && met > 0.0 && left > 0.0)) return 0.0;
        const double step = index_ * left - met;
        return density * met * left * seen_ *
               (1.0 - boundary_reflectance(1.0, index_, std::min(1.0, met))) / (step * step);
    }

  private:
    double index_;
    const RoughSurface& surface_;
    double mu_, sine_;
    Leaving air_;
    double nz_, seen_;
};

MirroredLobe::Leaving MirroredLobe::towards(double mu_air) const {
    return {mu_air, std::sqrt((1.0 - mu_air) * (1.0 + mu_air)),
            one_plus_lambda_of(surface_, mu_air)};
}

/// The sum over rays of energy times the BTDF into air. A ray stands for its mirror image on the
/// other side of the plane of incidence too.
double MirroredLobe::leaving(const Returning& light, const Leaving& towards, double azimuth) const {
    const double cosine = std::cos(azimuth), sine = std::sin(azimuth);
    double sum = 0.0;
    for (std::size_t k = 0; k < light.energy.size(); ++k) {
        const Passage out(index_, surface_, light.mu[k], light.sine[k], light.one_plus_lambda[k],
                          towards);
        for (const double side : {1.0, -1.0}) {
            sum += 0.5 * light.energy[k] *
                   out(light.cos_azimuth[k] * cosine + side * light.sin_azimuth[k] * sine,
                       light.sin_azimuth[k] * cosine - side * light.cos_azimuth[k] * sine);
        }
    }
    return sum;
}

int MirroredLobe::orders() const {
    constexpr double fall = 9.0;  // -log 1e-4
    return int(std::clamp(fall / (surface_.alpha * (index_ - 1.0)), 12.0, double(kMostOrders)));
}

// With K of Passage, its orders K^m, and nodes p of cosines inside,
//     R = pi int dmu mu int dphi' n^2 K(in; mu, phi') returned(mu) K(out; mu, phi - phi'),
//     R^m = 2 pi^2 n^2 sum_p mu_p w_p returned_p K^m(in; p) K^m(out; p).
std::vector<Eigen::MatrixXd> MirroredLobe::by_order(const Eigen::VectorXd& mu,
                                                    const Eigen::VectorXd& scale, int count) const {
    // Panels of half the nodes resolve in the cosine what so many orders do in the azimuth.
    const int samples = std::max(kLeastSamples, std::max(count, orders()));
    const ZenithGrid nodes = RefractionGrid({index_}, samples).in_medium(index_);
    Eigen::MatrixXd transform(count, samples + 1);
    Eigen::VectorXd along(samples + 1), across(samples + 1);
    for (int a = 0; a <= samples; ++a) {
        const double azimuth = std::numbers::pi * a / samples;
        const double weight = (a == 0 || a == samples ? 0.5 : 1.0) / samples;
        along[a] = std::cos(azimuth);
        across[a] = std::sin(azimuth);
        for (int m = 0; m < count; ++m)
            transform(m, a) =
                weight * std::cos(std::numbers::pi * double((m * a) % (2 * samples)) / samples);
    }
    std::vector<Leaving> directions;
    for (const double cosine : mu) directions.push_back(towards(cosine));

    std::vector<Eigen::MatrixXd> sum(std::size_t(count),
                                     Eigen::MatrixXd::Zero(mu.size(), mu.size()));
    constexpr Eigen::Index kBlock = 32;  // of nodes: what is kept of them
    Eigen::MatrixXd passing, of_order(mu.size(), kBlock);
    for (Eigen::Index first = 0; first < nodes.mu.size(); first += kBlock) {
        math::interruption_point();
        const Eigen::Index block = std::min(kBlock, nodes.mu.size() - first);
        passing.resize(samples + 1, mu.size() * block);
        for (Eigen::Index p = 0; p < block; ++p) {
            const double inside = nodes.mu[first + p];
            const double sine = std::sqrt((1.0 - inside) * (1.0 + inside));
            const double hidden = one_plus_lambda_of(surface_, inside);
            const double root = std::sqrt(inside * nodes.weights[first + p] * returned_(inside));
            for (Eigen::Index d = 0; d < mu.size(); ++d) {
                const Passage passage(index_, surface_, inside, sine, hidden,
                                      directions[std::size_t(d)]);
                for (int a = 0; a <= samples; ++a)
                    passing(a, p * mu.size() + d) = root * passage(along[a], across[a]);
            }
        }
        const Eigen::MatrixXd series = transform * passing;
        for (int m = 0; m < count; ++m) {
            of_order.resize(mu.size(), block);
            of_order.reshaped() = series.row(m).transpose();
            sum[std::size_t(m)].noalias() += of_order * of_order.transpose();
        }
    }
    const double factor = 2.0 * std::pow(std::numbers::pi * index_, 2);
    for (Eigen::MatrixXd& order : sum)
        order = factor * scale.asDiagonal() * order * scale.asDiagonal();
    return sum;
}

void MirroredLobe::add_to(std::vector<double>& reflection, const Directions& directions,
                          const Eigen::VectorXd& scale_in, const Eigen::VectorXd& scale_out) const {
    const bool is_symmetric = directions.mu_in == directions.mu_out;
    const auto in = scale_in.size(), out = is_symmetric ? 0 : scale_out.size();
    const double pairs = double(scale_in.size() * scale_out.size());
    const double azimuths = double(directions.azimuth_deg.size()),
                 samples = double(std::max(kLeastSamples, orders()));
    constexpr double kRays = 4000.0;  // of a beam and their mirror images, there and back
    if (orders() == kMostOrders || double(in + out) * samples * samples > kRays * pairs * azimuths)
        return add_by_rays(reflection, directions, scale_in, scale_out);

    Eigen::VectorXd mu(in + out), scale(in + out);
    mu.head(in) = Eigen::Map<const Eigen::VectorXd>(directions.mu_in.data(), in);
    scale.head(in) = scale_in;
    if (!is_symmetric) {
        mu.tail(out) = Eigen::Map<const Eigen::VectorXd>(directions.mu_out.data(), out);
        scale.tail(out) = scale_out;
    }
    const std::vector<Eigen::MatrixXd> lobe = by_order(mu, scale, int(samples));
    const std::size_t lanes = math::kSeriesLanes;
    std::vector<double> series((lobe.size() + lanes - 1) / lanes * lanes, 0.0);
    std::size_t next = 0;
    for (Eigen::Index i = 0; i < in; ++i) {
        for (Eigen::Index o = 0; o < scale_out.size(); ++o) {
            for (std::size_t m = 0; m < lobe.size(); ++m)
                series[m] = (m == 0 ? 1.0 : 2.0) * lobe[m](i, is_symmetric ? o : in + o);
            for (const double azimuth : directions.azimuth_deg)
                reflection[next++] +=
                    math::cosine_sum(series, std::cos(azimuth * (std::numbers::pi / 180.0)));
        }
    }
}

void MirroredLobe::add_by_rays(std::vector<double>& reflection, const Directions& directions,
                               const Eigen::VectorXd& scale_in,
                               const Eigen::VectorXd& scale_out) const {
    const auto all = [this](const std::vector<double>& cosines) {
        std::vector<std::pair<Returning, Leaving>> list;
        for (const double mu : cosines) list.push_back({entering(mu), towards(mu)});
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
