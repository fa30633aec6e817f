#include "pipeline/render/solved_brdf.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "pipeline/render/table_nodes.h"

namespace miebrdf::render {

double SolvedBrdf::lobe_alpha() const {
    return surface_ && component_ != Component::subsurface ? surface_->beckmann_alpha() : 0.0;
}

struct SolvedBrdf::Place {
    CubicTaps in, out, azimuth;
    std::array<float, 16> pair;  ///< weight[i] weight[o] / (mu_in + mu_out), o fastest
    FirstOrderTable::Place once;
};

SolvedBrdf::Place SolvedBrdf::place(double mu_in, double mu_out, double cos_azimuth) const {
    Place place{cosine_taps(mu_in, cosines_),
                cosine_taps(mu_out, cosines_),
                azimuth_taps(cos_azimuth, azimuths_),
                {},
                first_order_->place(mu_in, mu_out, cos_azimuth)};
    const auto scale = float(1.0 / (mu_in + mu_out));
    for (std::size_t k = 0; k < 16; ++k)
        place.pair[k] = scale * place.in.weight[k / 4] * place.out.weight[k % 4];
    return place;
}

Lane SolvedBrdf::multiple(const Place& place, std::size_t lane) const {
    std::array<Lane, 4> at_azimuth;
    at_azimuth.fill(Lane::Zero());
    for (std::size_t k = 0; k < 16; ++k) {
        const std::size_t row = (place.in.first + k / 4) * cosines_ + place.out.first + k % 4;
        const float* values =
            &table_[(row * azimuths_ + place.azimuth.first) * stride_ + lane * kLaneWidth];
        for (std::size_t a = 0; a < 4; ++a)
            at_azimuth[a] += place.pair[k] * lane_at(values + a * stride_);
    }
    const auto& weight = place.azimuth.weight;
    return weight[0] * at_azimuth[0] + weight[1] * at_azimuth[1] + weight[2] * at_azimuth[2] +
           weight[3] * at_azimuth[3];
}

Lane SolvedBrdf::subsurface(const Place& place, std::size_t lane) const {
    const Lane reflection = multiple(place, lane) + first_order_->reflection(place.once, lane);
    // Interpolated values may undershoot where next to nothing is reflected.
    Lane brdf = (reflection * float(std::numbers::inv_pi)).max(0.0F);
    if (surface_ && component_ == Component::total)
        brdf *= surface_->transmission(place.in, place.out, lane);
    return brdf;
}

void SolvedBrdf::evaluate(double mu_in, double mu_out, double cos_azimuth,
                          std::span<double> brdf) const {
    if (component_ == Component::surface) {
        std::fill(brdf.begin(), brdf.end(), 0.0);
    } else {
        const Place here = place(mu_in, mu_out, cos_azimuth);
        for (std::size_t first = 0; first < brdf.size(); first += kLaneWidth) {
            const Lane values = subsurface(here, first / kLaneWidth);
            std::copy_n(values.data(), std::min(kLaneWidth, brdf.size() - first),
                        brdf.begin() + std::ptrdiff_t(first));
        }
    }
    if (surface_ && component_ != Component::subsurface) {
        surface_->add(mu_in, mu_out, cos_azimuth, brdf);
    }
}

}  // namespace miebrdf::render
