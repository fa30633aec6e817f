#include "pipeline/render/surface_term.h"

#include <algorithm>
#include <cmath>

#include "pipeline/render/cubic_taps.h"
#include "pipeline/render/half_vector.h"
#include "pipeline/render/lanes.h"

namespace miebrdf::render {
namespace {

constexpr std::size_t kNodes = 64;
/// sqrt(mu) of the first node; rho is asked for at positive cosines only, and levels off there.
constexpr double kFirst = 0.01;

double node(std::size_t i) { return kFirst + (1.0 - kFirst) * double(i) / (kNodes - 1); }

CubicTaps taps_of(double mu) {
    return uniform_taps((std::sqrt(mu) - kFirst) / (1.0 - kFirst) * (kNodes - 1), kNodes);
}

}  // namespace

SurfaceTerm::SurfaceTerm(const std::vector<std::complex<double>>& refractive_index,
                         const rte::SurfaceOptions& options, rte::SurfaceCoupling coupling)
    : options_(options), shadowing_(options) {
    const auto count = Eigen::Index(refractive_index.size());
    const auto filled = Eigen::Index(lanes_for(refractive_index.size()) * kLaneWidth);
    square_.setOnes(filled);
    product_.setOnes(filled);
    normal_.resize(count);
    in_.resize(count, kNodes);
    out_.resize(count, kNodes);
    for (Eigen::Index w = 0; w < count; ++w) {
        const std::complex<double> index = refractive_index[std::size_t(w)];
        const std::complex<double> squared = index * index;
        square_[w] = squared.real();
        product_[w] = squared.imag() * squared.imag();
        normal_[w] = rte::normal_reflectance(index);
        const rte::SurfaceTransmission transmission({index, options}, coupling);
        for (std::size_t i = 0; i < kNodes; ++i) {
            const double mu = i + 1 == kNodes ? 1.0 : node(i) * node(i);
            in_(w, Eigen::Index(i)) = transmission.in(mu);
            out_(w, Eigen::Index(i)) = transmission.out(mu);
        }
    }
}

void SurfaceTerm::weaken(double mu_in, double mu_out, std::span<double> brdf) const {
    const auto between = [](const Eigen::ArrayXXd& table, const CubicTaps& taps) {
        const auto first = Eigen::Index(taps.first);
        return taps.weight[0] * table.col(first) + taps.weight[1] * table.col(first + 1) +
               taps.weight[2] * table.col(first + 2) + taps.weight[3] * table.col(first + 3);
    };
    Eigen::Map<Eigen::ArrayXd>(brdf.data(), Eigen::Index(brdf.size())) *=
        between(in_, taps_of(mu_in)) * between(out_, taps_of(mu_out));
}

void SurfaceTerm::add(double mu_in, double mu_out, double cos_azimuth,
                      std::span<double> brdf) const {
    const HalfVector half = half_vector(mu_in, mu_out, cos_azimuth);
    const double cos2 = half.cos_normal * half.cos_normal;
    const double tan2 = (1.0 - half.cos_normal) * (1.0 + half.cos_normal) / cos2;
    const double shape = 0.25 *
                         rte::normal_density(options_.distribution, options_.beckmann_alpha, tan2) *
                         shadowing_({mu_in, mu_out, half.cos_normal, half.cos_light});
    const double c = half.cos_light;
    if (options_.fresnel == rte::FresnelKind::schlick) {
        for (std::size_t w = 0; w < brdf.size(); ++w)
            brdf[w] += shape * rte::schlick_reflectance(normal_[Eigen::Index(w)], c);
        return;
    }
    // Born & Wolf 1999, ch. 14.2: u + iv = sqrt(m^2 - sin^2), r = u^2 + v^2.
    using Eight = Eigen::Array<double, kLaneWidth, 1>;
    const double sine2 = (1.0 - c) * (1.0 + c);
    for (std::size_t first = 0; first < brdf.size(); first += kLaneWidth) {
        const Eight t = square_.segment<kLaneWidth>(Eigen::Index(first)) - sine2;
        const Eight r = (t.square() + product_.segment<kLaneWidth>(Eigen::Index(first))).sqrt();
        const Eight u2c = 2.0 * c * (0.5 * (r + t)).max(0.0).sqrt();
        const Eight s = r + c * c;
        const Eight p = r * (c * c) + sine2 * sine2;
        const Eight ratio = (p - u2c * sine2) / (p + u2c * sine2);
        const Eight lobe = 0.5 * shape * (s - u2c) / (s + u2c) * (1.0 + ratio);
        const std::size_t count = std::min(kLaneWidth, brdf.size() - first);
        for (std::size_t w = 0; w < count; ++w) brdf[first + w] += lobe[Eigen::Index(w)];
    }
}

}  // namespace miebrdf::render
