#include "pipeline/render/ray_table.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pipeline/render/table_nodes.h"
#include "pipeline/solve/wavelength_table.h"

namespace miebrdf::render {

RayTable::RayTable(const std::vector<BrdfTable>& tables, const TableSize& size)
    : cosines_(std::size_t(size.cosines)), azimuths_(std::size_t(size.azimuths)) {
    if (size.cosines < 4 || size.azimuths < 4) {
        throw UsageError(fmt::format("table of {} cosines and {} azimuths; allowed: 4 or more",
                                     size.cosines, size.azimuths));
    }
    if (tables.empty()) throw UsageError("no wavelength to render");
    const BrdfTable::State& first = tables.front().state();
    part_ = first.part;
    std::vector<std::vector<rte::ScaledMedium>> stacks;
    std::vector<std::complex<double>> surface_index;
    for (const BrdfTable& table : tables) {
        const BrdfTable::State& state = table.state();
        for (const double nm : table.wavelength_nm()) wavelength_nm_.push_back(nm);
        for (const WavelengthTable& at : state.tables)
            stacks.push_back(at.has_optical_steps() ? std::vector<rte::ScaledMedium>()
                                                    : at.media());
        for (const auto index : state.scene.surface_index) surface_index.push_back(index);
    }
    stride_ = lanes_for(wavelength_nm_.size()) * kLaneWidth;
    table_.resize(cosines_ * cosines_ * azimuths_ * stride_);
    const std::vector<double> cosines = cosine_nodes(size.cosines);
    const std::vector<double> azimuth_deg = azimuth_nodes_deg(size.azimuths);
    std::size_t w = 0;
    for (const BrdfTable& table : tables) {
        const BrdfTable::State& state = table.state();
        for (const SharpPart& sharp : state.sharp) {
            for (std::size_t own = 0; own < sharp.wavelengths(); ++own) {
                const WavelengthTable& at = sharp.table(own);
                fill(w++, at.smooth(), once_of(sharp, own), cosines, azimuth_deg);
            }
        }
    }
    first_order_.emplace(stacks, first.solver.single_scattering_correction);
    if (first.scene.surface) {
        surface_.emplace(surface_index, *first.scene.surface, first.scene.coupling, size.cosines);
    }
    if (first.scene.boundary) add_boundary(tables);
}

void RayTable::add_boundary(const std::vector<BrdfTable>& tables) {
    constexpr double mirror_alpha = 0.02;
    const rte::Boundary& boundary = *tables.front().state().scene.boundary;
    std::vector<std::complex<double>> index;
    for (const BrdfTable& table : tables) {
        const ResolvedScene& scene = table.state().scene;
        for (std::size_t w = 0; w < scene.wavelength_nm.size(); ++w)
            index.emplace_back(scene.top_index(w));
    }
    surface_.emplace(
        index, rte::SurfaceOptions{
                   .beckmann_alpha = boundary.is_rough() ? boundary.roughness : mirror_alpha,
                   .distribution = boundary.is_rough() ? boundary.distribution
                                                       : rte::MicrofacetDistribution::beckmann});
}

RayTable::ScatteredOnce RayTable::once_of(const SharpPart& sharp, std::size_t w) {
    if (!sharp.table(w).has_optical_steps()) return {};
    return [&sharp, w, scratch = std::make_shared<FirstOrder::Scratch>()](
               double mu_in, double mu_out, std::span<const double> cos_azimuth,
               std::span<double> reflection) {
        sharp.scattered_once(w, mu_in, mu_out, cos_azimuth, reflection, *scratch);
    };
}

void RayTable::fill(std::size_t w, const SmoothPart& smooth, const ScatteredOnce& once,
                    const std::vector<double>& cosines, const std::vector<double>& azimuth_deg) {
    std::vector<double> cos_azimuth, added(azimuth_deg.size(), 0.0);
    for (const double azimuth : azimuth_deg)
        cos_azimuth.push_back(std::cos(azimuth * std::numbers::pi / 180));
    std::size_t index = 0;
    std::vector<double> series;
    for (const double mu_in : cosines) {
        for (const double mu_out : cosines) {
            smooth.series_at(mu_in, mu_out, series);
            if (once) once(mu_in, mu_out, cos_azimuth, added);
            for (std::size_t a = 0; a < cos_azimuth.size(); ++a) {
                const double value =
                    (mu_in + mu_out) * (math::cosine_sum(series, cos_azimuth[a]) + added[a]);
                if (!std::isfinite(value)) {
                    throw InputError(
                        fmt::format("no physical solution at {} nm; try other streams "
                                    "or a smaller tolerance",
                                    wavelength_nm_[w]));
                }
                table_[index++ * stride_ + w] = float(value);
            }
        }
    }
}

double RayTable::lobe_alpha() const {
    return surface_ && part_ != BrdfPart::subsurface ? surface_->beckmann_alpha() : 0.0;
}

struct RayTable::Place {
    CubicTaps in, out, azimuth;
    std::array<float, 16> pair;  ///< weight[i] weight[o] / (mu_in + mu_out), o fastest
    FirstOrderTable::Place once;
};

RayTable::Place RayTable::place(double mu_in, double mu_out, double cos_azimuth) const {
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

Lane RayTable::multiple(const Place& place, std::size_t lane) const {
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

Lane RayTable::subsurface(const Place& place, std::size_t lane) const {
    Lane once = first_order_->reflection(place.once, lane);
    // What a surface lets through is in the table already.
    if (surface_ && surface_->weakens() && part_ == BrdfPart::total)
        once *= surface_->transmission(place.in, place.out, lane);
    // Interpolated values may undershoot where next to nothing is reflected.
    return ((multiple(place, lane) + once) * float(std::numbers::inv_pi)).max(0.0F);
}

void RayTable::evaluate(double mu_in, double mu_out, double cos_azimuth,
                        std::span<double> brdf) const {
    if (part_ == BrdfPart::surface) {
        std::fill(brdf.begin(), brdf.end(), 0.0);
    } else {
        const Place here = place(mu_in, mu_out, cos_azimuth);
        for (std::size_t first = 0; first < brdf.size(); first += kLaneWidth) {
            const Lane values = subsurface(here, first / kLaneWidth);
            std::copy_n(values.data(), std::min(kLaneWidth, brdf.size() - first),
                        brdf.begin() + std::ptrdiff_t(first));
        }
    }
    if (surface_ && part_ != BrdfPart::subsurface) {
        surface_->add(mu_in, mu_out, cos_azimuth, brdf);
    }
}

InterpolationError interpolation_error(const RayTable& table, const Brdf& exact) {
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
