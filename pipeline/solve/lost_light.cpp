#include "pipeline/solve/lost_light.h"

#include <miebrdf/error.h>

#include <cmath>
#include <numbers>
#include <random>

#include "pipeline/solve/parallel.h"
#include "pipeline/solve/resolved_scene.h"
#include "rte/surface/fresnel.h"

namespace miebrdf {
namespace {

constexpr int kPhotons = 50'000;
/// Photons of less weight go on with a chance of one in ten.
constexpr double kLeastWeight = 1e-4, kChance = 0.1;

/// A layer at a wavelength; lengths in mm.
struct Slab {
    double index = 1.0, thickness = 0.0, extinction = 0.0, albedo = 1.0, g = 0.0;
};

struct Photon {
    double x, y, u, v, w;  ///< place beside the axis; direction, w > 0 is down
    double weight = 1.0;
};

class Tracer {
  public:
    explicit Tracer(const std::vector<Slab>& from_top) : slabs_(from_top) {}

    /// Adds what leaves beyond these radii.
    void trace(double launch_radius, bool diffuse, double mu_in, double r_above, double r_below,
               double& r_lost, double& t_lost) {
        for (int i = 0; i < kPhotons; ++i) {
            const double r = launch_radius * std::sqrt(random()), at = turn(),
                         mu = diffuse ? std::sqrt(random()) : mu_in,
                         sine = std::sqrt(1.0 - mu * mu), to = diffuse ? turn() : 0.0;
            Photon photon{r * std::cos(at), r * std::sin(at), sine * std::cos(to),
                          sine * std::sin(to), mu};
            follow(photon);
            const bool above = photon.w < 0.0;
            if (std::hypot(photon.x, photon.y) > (above ? r_above : r_below))
                (above ? r_lost : t_lost) += photon.weight / kPhotons;
        }
    }

  private:
    double random() { return std::uniform_real_distribution<double>()(engine_); }
    double turn() { return 2.0 * std::numbers::pi * random(); }
    double index(int slab) const {
        return slab < 0 || slab == int(slabs_.size()) ? 1.0 : slabs_[std::size_t(slab)].index;
    }

    /// From air into air, or to the end of its weight.
    void follow(Photon& p) {
        for (int slab = -1;;) {
            const int next = slab + (p.w > 0.0 ? 1 : -1);
            const double ratio = index(slab) / index(next);
            if (random() < rte::fresnel_reflectance(1.0 / ratio, std::abs(p.w))) {
                p.w = -p.w;
            } else {
                p.u *= ratio;
                p.v *= ratio;
                p.w = std::copysign(std::sqrt(std::max(0.0, 1.0 - p.u * p.u - p.v * p.v)), p.w);
                slab = next;
            }
            if (slab < 0 || slab == int(slabs_.size())) return;
            cross(slabs_[std::size_t(slab)], p);
            if (p.weight == 0.0) return;
        }
    }

    /// To the next boundary of the slab.
    void cross(const Slab& slab, Photon& p) {
        for (double z = p.w > 0.0 ? 0.0 : slab.thickness;;) {
            const double way = (p.w > 0.0 ? slab.thickness - z : z) / std::abs(p.w);
            const double free =
                slab.extinction > 0.0 ? -std::log1p(-random()) / slab.extinction : way;
            const double step = std::min(way, free);
            p.x += step * p.u;
            p.y += step * p.v;
            if (free >= way) return;
            z += step * p.w;
            p.weight *= slab.albedo;
            if (p.weight < kLeastWeight) p.weight *= random() < kChance ? 1.0 / kChance : 0.0;
            if (p.weight == 0.0) return;
            scatter(slab.g, p);
        }
    }

    void scatter(double g, Photon& p) {
        const double s = 2.0 * random() - 1.0, k = (1.0 - g * g) / (1.0 + g * s);
        const double cosine = std::abs(g) < 1e-6 ? s : (1.0 + g * g - k * k) / (2.0 * g);
        const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), angle = turn();
        // Two directions across the photon's; the first is horizontal.
        const double h = std::hypot(p.u, p.v), ex = h > 1e-9 ? -p.v / h : 1.0,
                     ey = h > 1e-9 ? p.u / h : 0.0;
        const double a = sine * std::cos(angle), b = sine * std::sin(angle);
        const double u = p.u * cosine + a * ex - b * p.w * ey,
                     v = p.v * cosine + a * ey + b * p.w * ex,
                     w = p.w * cosine + b * (p.u * ey - p.v * ex);
        p.u = u;
        p.v = v;
        p.w = w;
    }

    const std::vector<Slab>& slabs_;
    std::mt19937_64 engine_{1};
};

/// The layers at each wavelength, the top one first.
std::vector<std::vector<Slab>> slabs_of(const Brdf& brdf) {
    const Scene& scene = brdf.scene();
    const ResolvedScene resolved = resolve(scene, brdf.wavelength_nm());
    if (!scene.substrate || scene.substrate->kind != Substrate::Kind::none ||
        resolved.layers() != scene.layers.size())
        throw UsageError(
            "lost light: the sample is layers of some thickness on substrate = \"none\"");
    const std::vector<LayerOptics> optics = brdf.layers();
    const std::size_t layers = scene.layers.size();
    std::vector<std::vector<Slab>> all(brdf.wavelength_nm().size());
    for (std::size_t w = 0; w < all.size(); ++w) {
        for (std::size_t l = layers; l-- > 0;) {
            const Depth& depth = scene.layers[l].depth;
            if (depth.kind != Depth::Kind::thickness_um)
                throw UsageError("lost light: a layer without a thickness; write MEDIUM@2mm");
            const double mm = depth.value / 1000.0;
            const LayerOptics& at = optics[w * layers + l];
            const bool empty = !(at.optical_depth > 0.0);
            all[w].push_back({scene.boundary ? resolved.media[l + 1].host_index[w] : 1.0, mm,
                              empty ? 0.0 : at.optical_depth / mm,
                              empty ? 1.0 : at.single_scattering_albedo,
                              empty ? 0.0 : at.asymmetry});
        }
    }
    return all;
}

}  // namespace

std::vector<LostLight> lost_light(const Brdf& brdf, double mu_in, const Ports& ports,
                                  const Control& control) {
    const auto slabs = slabs_of(brdf);
    std::vector<LostLight> all(slabs.size());
    const double above = ports.above_mm / 2, below = ports.below_mm / 2;
    run_parallel("lost light", all.size(), control, [&](std::size_t w) {
        LostLight& lost = all[w];
        Tracer(slabs[w]).trace(ports.beam_mm / 2, false, mu_in, above, below, lost.r_direct,
                               lost.t_direct);
        if (ports.flooded_mm > 0.0)
            Tracer(slabs[w]).trace(ports.flooded_mm / 2, true, mu_in, ports.flooded_mm / 2, below,
                                   lost.r_diffuse, lost.t_diffuse);
    });
    return all;
}

}  // namespace miebrdf
