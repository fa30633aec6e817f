#include "pipeline/solve/surface_part.h"

#include <optional>

#include <miebrdf/surface.h>
#include "pipeline/cache/packed_numbers.h"
#include "pipeline/cache/result_cache.h"
#include "pipeline/plan/rules.h"

namespace miebrdf {
namespace {

std::string hash_of(std::complex<double> index, const Scene& scene, const rte::Directions& d,
                    SurfaceDemand demand) {
    JobKey key("surface");
    add_surface(key, index, scene);
    key.add(static_cast<int>(demand));
    key.add(std::span<const double>(d.mu_in)).add(std::span<const double>(d.mu_out));
    key.add(std::span<const double>(d.azimuth_deg));
    return key.hash();
}

std::vector<double> lobe_values(const rte::SurfaceLobe& lobe, const rte::Directions& d) {
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

SurfacePart compute(std::complex<double> index, const Scene& scene, const rte::Directions& d,
                    SurfaceDemand demand) {
    const rte::SurfaceLobe lobe(index, *scene.surface);
    SurfacePart part;
    part.lobe = lobe_values(lobe, d);
    if (demand == SurfaceDemand::lobe) return part;
    const rte::SurfaceTransmission transmission(lobe, scene.coupling);
    for (const double mu : d.mu_in) part.in.push_back(transmission.in(mu));
    for (const double mu : d.mu_out) part.out.push_back(transmission.out(mu));
    return part;
}

}  // namespace

void add_surface(JobKey& key, std::complex<double> index, const Scene& scene) {
    const rte::SurfaceOptions& surface = *scene.surface;
    key.add(index.real()).add(index.imag()).add(surface.beckmann_alpha);
    key.add(static_cast<int>(surface.distribution)).add(static_cast<int>(surface.shadowing));
    key.add(surface.shadowing_distribution ? static_cast<int>(*surface.shadowing_distribution)
                                           : -1);
    key.add(static_cast<int>(surface.fresnel)).add(static_cast<int>(scene.coupling));
}

SurfacePart surface_part(std::complex<double> index, const Scene& scene,
                         const rte::Directions& directions, SurfaceDemand demand,
                         const RunControl& control) {
    if (control.cache == nullptr) return compute(index, scene, directions, demand);
    const std::string hash = hash_of(index, scene, directions, demand);
    if (const auto known = control.cache->find(hash)) {
        NumberUnpacker unpacker(*known);
        SurfacePart part;
        part.lobe = unpacker.list();
        part.in = unpacker.list();
        part.out = unpacker.list();
        return part;
    }
    SurfacePart part = compute(index, scene, directions, demand);
    control.cache->store(hash, NumberPacker().add(part.lobe).add(part.in).add(part.out).numbers());
    return part;
}

}  // namespace miebrdf
