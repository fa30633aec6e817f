#include "pipeline/render/solved_brdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/render/table_nodes.h"

namespace miebrdf::render {

double SolvedBrdf::lobe_alpha() const {
    return surface_ && component_ != Component::subsurface ? surface_->beckmann_alpha() : 0.0;
}

struct SolvedBrdf::Place {
    CubicTaps in, out, azimuth;
    double scale;  ///< from the table to R
};

SolvedBrdf::Place SolvedBrdf::place(double mu_in, double mu_out, double cos_azimuth) const {
    return {cosine_taps(mu_in, cosines_), cosine_taps(mu_out, cosines_),
            azimuth_taps(cos_azimuth, azimuths_), 1.0 / (mu_in + mu_out)};
}

Lane SolvedBrdf::multiple(const Place& place, std::size_t lane) const {
    Lane sum = Lane::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t o = 0; o < 4; ++o) {
            const auto pair = float(place.scale * place.in.weight[i] * place.out.weight[o]);
            const std::size_t row = (place.in.first + i) * cosines_ + place.out.first + o;
            const float* values =
                &table_[(row * azimuths_ + place.azimuth.first) * stride_ + lane * kLaneWidth];
            for (std::size_t a = 0; a < 4; ++a)
                sum += pair * float(place.azimuth.weight[a]) * lane_at(values + a * stride_);
        }
    }
    return sum;
}

void SolvedBrdf::evaluate(double mu_in, double mu_out, double cos_azimuth,
                          std::span<double> brdf) const {
    std::fill(brdf.begin(), brdf.end(), 0.0);
    if (component_ != Component::surface) {
        const Place many = place(mu_in, mu_out, cos_azimuth);
        const FirstOrderTable::Place once = first_order_->place(mu_in, mu_out, cos_azimuth);
        for (std::size_t first = 0; first < brdf.size(); first += kLaneWidth) {
            const std::size_t lane = first / kLaneWidth;
            // Interpolated values may undershoot where next to nothing is reflected.
            const Lane values = ((multiple(many, lane) + first_order_->reflection(once, lane)) *
                                 float(std::numbers::inv_pi))
                                    .max(0.0F);
            std::copy_n(values.data(), std::min(kLaneWidth, brdf.size() - first),
                        brdf.begin() + std::ptrdiff_t(first));
        }
        if (surface_ && component_ == Component::total) surface_->weaken(mu_in, mu_out, brdf);
    }
    if (surface_ && component_ != Component::subsurface) {
        surface_->add(mu_in, mu_out, cos_azimuth, brdf);
    }
}

}  // namespace miebrdf::render
