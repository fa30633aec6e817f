#include "pipeline/render/solved_brdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/render/table_nodes.h"

namespace miebrdf::render {

double SolvedBrdf::lobe_alpha() const {
    return surface_ && component_ != Component::subsurface ? surface_->beckmann_alpha() : 0.0;
}

void SolvedBrdf::add_multiple(double mu_in, double mu_out, double cos_azimuth,
                              std::span<double> reflection) const {
    const CubicTaps in = cosine_taps(mu_in, cosines_);
    const CubicTaps out = cosine_taps(mu_out, cosines_);
    const CubicTaps azimuth = azimuth_taps(cos_azimuth, azimuths_);
    const std::size_t count = reflection.size();
    const double scale = 1.0 / (mu_in + mu_out);
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t o = 0; o < 4; ++o) {
            const double pair = scale * in.weight[i] * out.weight[o];
            const std::size_t row = (in.first + i) * cosines_ + out.first + o;
            const float* values = &table_[(row * azimuths_ + azimuth.first) * count];
            for (std::size_t a = 0; a < 4; ++a) {
                const double weight = pair * azimuth.weight[a];
                for (std::size_t w = 0; w < count; ++w) reflection[w] += weight * double(*values++);
            }
        }
    }
}

void SolvedBrdf::evaluate(double mu_in, double mu_out, double cos_azimuth,
                          std::span<double> brdf) const {
    std::fill(brdf.begin(), brdf.end(), 0.0);
    if (component_ != Component::surface) {
        first_order_->add(mu_in, mu_out, cos_azimuth, brdf);
        add_multiple(mu_in, mu_out, cos_azimuth, brdf);
        // Interpolated values may undershoot where next to nothing is reflected.
        for (double& value : brdf) value = std::max(0.0, value / std::numbers::pi);
        if (surface_ && component_ == Component::total) surface_->weaken(mu_in, mu_out, brdf);
    }
    if (surface_ && component_ != Component::subsurface) {
        surface_->add(mu_in, mu_out, cos_azimuth, brdf);
    }
}

}  // namespace miebrdf::render
