#include "pipeline/render/solved_material.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace miebrdf::render {

void SolvedMaterial::evaluate(double mu_in, double mu_out, double cos_azimuth,
                              std::span<double> brdf) const {
    table_.evaluate(mu_in, mu_out, cos_azimuth, brdf, CompactTable::Lobes::of_pictures);
    // Interpolated values may undershoot where next to nothing is reflected.
    for (double& value : brdf) value = std::max(value, 0.0);
}

InterpolationError interpolation_error(const CompactTable& table, const Brdf& exact) {
    Directions d;
    for (int i = 0; i < 8; ++i) {
        // Two lists that are not each other's, nor the table's.
        d.mu_in.push_back(0.05 + 0.13 * i);
        d.mu_out.push_back(0.07 + 0.13 * i);
    }
    d.azimuth_deg = {1.0, 22.0, 58.0, 91.0, 127.0, 158.0, 179.0};
    const BrdfValues values = exact.evaluate(d);
    const std::size_t block = d.mu_out.size() * d.azimuth_deg.size();
    std::vector<double> errors, looked_up(table.wavelengths());
    for (std::size_t i = 0; i < d.mu_in.size(); ++i) {
        std::size_t index = i * block;
        for (const double mu_out : d.mu_out) {
            for (const double azimuth : d.azimuth_deg) {
                table.evaluate(d.mu_in[i], mu_out, std::cos(azimuth * std::numbers::pi / 180.0),
                               looked_up);
                for (std::size_t w = 0; w < looked_up.size(); ++w) {
                    const std::vector<double>& total = values.slices[w].total;
                    const auto first = total.begin() + std::ptrdiff_t(i * block);
                    const double largest = *std::max_element(first, first + std::ptrdiff_t(block));
                    errors.push_back(std::abs(looked_up[w] - total[index]) / largest);
                }
                ++index;
            }
        }
    }
    std::sort(errors.begin(), errors.end());
    return {errors[errors.size() / 2], errors.back()};
}

}  // namespace miebrdf::render
