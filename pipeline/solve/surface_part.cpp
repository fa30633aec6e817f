#include "pipeline/solve/surface_part.h"

#include <mutex>
#include <optional>

#include <miebrdf/surface.h>
#include "pipeline/cache/job_key.h"
#include "pipeline/cache/packed_numbers.h"
#include "pipeline/solve/distinct_directions.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/rules.h"
#include "rte/math/quadrature.h"
#include "rte/surface/reflectance_table.h"

namespace miebrdf {
namespace {

// rho is smooth in mu but for grazing light on a nearly smooth surface: 32 Gauss nodes integrate it
// to 1e-7 at alpha 0.3.
constexpr int kNodesOfMean = 32;

rte::SurfaceLobe lobe_of(const ResolvedScene& scene, std::size_t w) {
    return {scene.surface_index[w], *scene.surface};
}

std::vector<double> lobe_values(const rte::SurfaceLobe& lobe, const Directions& d) {
    const bool symmetric = is_symmetric(d);
    const std::size_t outgoing = d.mu_out.size(), azimuths = d.azimuth_deg.size();
    std::vector<double> values;
    values.reserve(d.mu_in.size() * outgoing * azimuths);
    for (std::size_t i = 0; i < d.mu_in.size(); ++i) {
        for (std::size_t o = 0; o < outgoing; ++o) {
            const std::size_t mirrored = (o * outgoing + i) * azimuths;
            for (std::size_t a = 0; a < azimuths; ++a) {
                values.push_back(symmetric && o < i
                                     ? values[mirrored + a]
                                     : lobe.brdf(d.mu_in[i], d.mu_out[o], d.azimuth_deg[a]));
            }
        }
    }
    return values;
}

SurfacePart compute(const ResolvedScene& scene, std::size_t w, const Directions& d,
                    SurfaceDemand demand) {
    const rte::SurfaceLobe lobe = lobe_of(scene, w);
    SurfacePart part;
    part.lobe = lobe_values(lobe, d);
    if (demand == SurfaceDemand::lobe) return part;
    const rte::SurfaceTransmission transmission(lobe, scene.coupling);
    for (const double mu : d.mu_in) part.in.push_back(transmission.in(mu));
    for (const double mu : d.mu_out) part.out.push_back(transmission.out(mu));
    return part;
}

SurfacePart looked_up(const ResolvedScene& scene, std::size_t w, const Directions& d,
                      SurfaceDemand demand, const Control& control) {
    JobKey key("surface");
    add_surface(key, scene, w);
    SurfacePart part;
    auto& [lobe, in, out] = part;
    const std::vector<double> numbers =
        remembered_numbers(control, key.add(demand).add(d).hash(), [&] {
            const SurfacePart made = compute(scene, w, d, demand);
            return NumberPacker().add(made.lobe).add(made.in).add(made.out).take();
        });
    NumberUnpacker unpacker(numbers);
    unpacker.read(lobe);
    unpacker.read(in);
    unpacker.read(out);
    return part;
}

std::vector<double> with_nodes_of_mean(std::vector<double> mu_in) {
    const math::Quadrature rule = math::gauss_legendre(kNodesOfMean, 0.0, 1.0);
    mu_in.insert(mu_in.end(), rule.nodes.begin(), rule.nodes.end());
    return mu_in;
}

/// In this form layers that absorb nothing give 1 to the last bit.
double with_surface(double rho, double layers) { return layers + rho * (1.0 - layers); }

}  // namespace

void add_surface(JobKey& key, const ResolvedScene& scene, std::size_t w) {
    key.add(scene.surface_index[w]).add(*scene.surface).add(scene.coupling);
}

SurfacePart surface_part(const ResolvedScene& scene, std::size_t w, const Directions& directions,
                         SurfaceDemand demand, const Control& control) {
    const DistinctDirections distinct(directions);
    SurfacePart part = looked_up(scene, w, distinct.directions(), demand, control);
    part.lobe = distinct.spread(part.lobe);
    if (demand == SurfaceDemand::lobe) return part;
    part.in = distinct.spread_incident(part.in);
    part.out = distinct.spread_outgoing(part.out);
    return part;
}

SurfaceOverAlbedos::SurfaceOverAlbedos(const ResolvedScene& scene, const std::vector<double>& mu_in,
                                       const std::vector<std::size_t>& wavelengths,
                                       const Control& control)
    : rho_(scene.surface_index.size()) {
    const std::vector<double> cosines = with_nodes_of_mean(mu_in);
    std::optional<rte::ReflectanceTable> table;  // made where not all are known
    std::once_flag is_made;
    const auto find = [&](std::size_t k) {
        JobKey key("surface over albedos");
        key.add(scene.surface_index[wavelengths[k]]).add(*scene.surface).add(cosines);
        rho_[wavelengths[k]] = remembered_numbers(control, key.hash(), [&] {
            std::call_once(is_made,
                           [&] { table.emplace(*scene.surface, cosines, wavelengths.size()); });
            return table->at(scene.surface_index[wavelengths[k]]);
        });
    };
    if (wavelengths.size() == 1)
        find(0);
    else
        run_parallel("surface", wavelengths.size(), control, find);
}

void SurfaceOverAlbedos::add_to(std::size_t w, std::vector<double>& albedos) const {
    const std::vector<double>& rho = rho_[w];
    const std::size_t asked = rho.size() - kNodesOfMean;
    for (std::size_t i = 0; i < asked; ++i) albedos[i] = with_surface(rho[i], albedos[i]);
    const math::Quadrature rule = math::gauss_legendre(kNodesOfMean, 0.0, 1.0);
    double mean_rho = 0.0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i)
        mean_rho += 2.0 * rule.weights[i] * rule.nodes[i] * rho[asked + i];
    albedos.back() = with_surface(mean_rho, albedos.back());
}

}  // namespace miebrdf
