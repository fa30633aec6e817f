#include "pipeline/render/surface_term.h"

#include <algorithm>
#include <cmath>

#include "pipeline/render/sampler.h"
#include "pipeline/render/table_nodes.h"

namespace miebrdf::render {
namespace {

/// Smith's masking by Beckmann's slopes depends on a = cot(theta) / alpha alone: mu (1 + Lambda) =
/// mu + alpha sin(theta) h(a). Its erfc and exponential were a tenth of a picture's time; the cubic
/// between these nodes errs by 2e-8 of h(0), and beyond the last h is below 1e-17.
constexpr std::size_t kSlopes = 256;
constexpr double kLastSlope = 6.0;

std::vector<float> beckmann_masking() {
    std::vector<float> masking;
    for (std::size_t k = 0; k < kSlopes; ++k) {
        const double a = kLastSlope * double(k) / (kSlopes - 1);
        const double secant = std::hypot(1.0, a);  // 1 / sin(theta) where alpha = 1
        const double mu = a / secant;
        const auto beckmann = rte::MicrofacetDistribution::beckmann;
        masking.push_back(float((rte::cosine_over_masking(beckmann, 1.0, mu) - mu) * secant));
    }
    return masking;
}

}  // namespace

SurfaceTerm::SurfaceTerm(const std::vector<std::complex<double>>& refractive_index,
                         const rte::SurfaceOptions& options)
    : options_(options),
      shadowing_(options),
      stride_(lanes_for(refractive_index.size()) * kLaneWidth) {
    const auto distribution = options.shadowing_distribution.value_or(options.distribution);
    if (distribution == rte::MicrofacetDistribution::beckmann)
        beckmann_masking_ = beckmann_masking();
    const auto count = Eigen::Index(refractive_index.size());
    square_.setOnes(Eigen::Index(stride_));
    product_.setOnes(Eigen::Index(stride_));
    normal_.resize(count);
    for (Eigen::Index w = 0; w < count; ++w) {
        const std::complex<double> index = refractive_index[std::size_t(w)];
        const std::complex<double> squared = index * index;
        square_[w] = squared.real();
        product_[w] = squared.imag() * squared.imag();
        normal_[w] = rte::normal_reflectance(index);
    }
}

SurfaceTerm::SurfaceTerm(const std::vector<std::complex<double>>& refractive_index,
                         const rte::SurfaceOptions& options, rte::SurfaceCoupling coupling,
                         int cosines)
    : SurfaceTerm(refractive_index, options) {
    const std::vector<double> nodes = cosine_nodes(cosines);
    in_.resize(nodes.size() * stride_);
    out_.resize(nodes.size() * stride_);
    for (std::size_t w = 0; w < refractive_index.size(); ++w) {
        const rte::SurfaceTransmission transmission({refractive_index[w], options}, coupling);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            in_[i * stride_ + w] = float(transmission.in(nodes[i]));
            out_[i * stride_ + w] = float(transmission.out(nodes[i]));
        }
    }
}

Lane SurfaceTerm::transmission(const CubicTaps& in, const CubicTaps& out, std::size_t lane) const {
    return interpolate(&in_[lane * kLaneWidth], stride_, in) *
           interpolate(&out_[lane * kLaneWidth], stride_, out);
}

double SurfaceTerm::in_over_masking(double mu_in) const {
    if (beckmann_masking_.empty()) return shadowing_.cosine_over_masking(mu_in);
    const double spread = options_.beckmann_alpha * std::sqrt((1.0 - mu_in) * (1.0 + mu_in));
    if (!(mu_in < kLastSlope * spread)) return mu_in;
    const CubicTaps taps = uniform_taps(mu_in / spread * ((kSlopes - 1) / kLastSlope), kSlopes);
    double sum = 0.0;
    for (std::size_t k = 0; k < 4; ++k)
        sum += double(taps.weight[k]) * double(beckmann_masking_[taps.first + k]);
    return mu_in + spread * sum;
}

void SurfaceTerm::add(double mu_in, double mu_out, double cos_azimuth,
                      std::span<double> brdf) const {
    const HalfVector half = half_vector(mu_in, mu_out, cos_azimuth);
    const double cos2 = half.cos_normal * half.cos_normal;
    const double tan2 = (1.0 - half.cos_normal) * (1.0 + half.cos_normal) / cos2;
    const double shape =
        0.25 * rte::normal_density(options_.distribution, options_.beckmann_alpha, tan2) *
        shadowing_({mu_in, mu_out, half.cos_normal, half.cos_light}, in_over_masking(mu_in));
    const double c = half.cos_light;
    if (options_.fresnel == rte::FresnelKind::schlick) {
        for (std::size_t w = 0; w < brdf.size(); ++w)
            brdf[w] += shape * rte::schlick_reflectance(normal_[Eigen::Index(w)], c);
        return;
    }
    // Born & Wolf 1999, ch. 14.2: u + iv = sqrt(m^2 - sin^2), r = u^2 + v^2.
    using Values = Eigen::Array<double, kLaneWidth, 1>;
    const double sine2 = (1.0 - c) * (1.0 + c);
    for (std::size_t first = 0; first < brdf.size(); first += kLaneWidth) {
        const Values t = square_.segment<kLaneWidth>(Eigen::Index(first)) - sine2;
        const Values r = (t.square() + product_.segment<kLaneWidth>(Eigen::Index(first))).sqrt();
        const Values u2c = 2.0 * c * (0.5 * (r + t)).max(0.0).sqrt();
        const Values s = r + c * c;
        const Values p = r * (c * c) + sine2 * sine2;
        const Values ratio = (p - u2c * sine2) / (p + u2c * sine2);
        const Values lobe = 0.5 * shape * (s - u2c) / (s + u2c) * (1.0 + ratio);
        const std::size_t count = std::min(kLaneWidth, brdf.size() - first);
        for (std::size_t w = 0; w < count; ++w) brdf[first + w] += lobe[Eigen::Index(w)];
    }
}

}  // namespace miebrdf::render
