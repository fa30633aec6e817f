#include "pipeline/fit/lost_light.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "pipeline/fit/model.h"
#include "pipeline/solve/resolved_scene.h"

namespace miebrdf::fitting {
namespace {

constexpr int kPhotons = 50'000;  // lit by a beam, and as many by diffuse light
/// Photons below the first weight live on in one of ten cases, with ten times of it.
constexpr double kLeastWeight = 1e-3, kSurvivors = 0.1;

/// splitmix64 (Steele, Lea and Flood 2014): a sequence for each photon.
struct Random {
    std::uint64_t state;

    double operator()() {  // in (0, 1)
        std::uint64_t z = state += 0x9E3779B97F4A7C15u;
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
        return (double((z ^ (z >> 31)) >> 12) + 0.5) * 0x1p-52;
    }
    Eigen::Vector3d direction(double cosine) {
        const double sine = std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine)));
        const double azimuth = 2.0 * std::numbers::pi * (*this)();
        return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
    }
};

struct Photon {
    Eigen::Vector3d at, towards;  // z: downwards, from the top of its plate
    double weight = 1.0;
    int plate = -1;

    /// Into the next plate, or back.
    void meet_surface(const LitSample& sample, Random& random) {
        const auto index_of = [&](int i) {
            if (i == int(sample.plates.size())) return sample.index_below;
            return i < 0 ? 1.0 : sample.plates[std::size_t(i)].index;
        };
        const int next = towards.z() > 0.0 ? plate + 1 : plate - 1;
        const double ratio = index_of(plate) / index_of(next), mu = std::abs(towards.z());
        const double refracted = std::sqrt(std::max(0.0, 1.0 - ratio * ratio * (1.0 - mu * mu)));
        const double s = (ratio * mu - refracted) / (ratio * mu + refracted),
                     p = (ratio * refracted - mu) / (ratio * refracted + mu);
        if (random() < 0.5 * (s * s + p * p)) {
            towards.z() = -towards.z();
            return;
        }
        towards = {ratio * towards.x(), ratio * towards.y(), std::copysign(refracted, towards.z())};
        plate = next;
        if (next < 0 || next == int(sample.plates.size())) return;
        at.z() = towards.z() > 0.0 ? 0.0 : sample.plates[std::size_t(next)].thickness_mm;
    }

    /// To a surface of the plate, unless it is absorbed.
    void fly(const Plate& in, Random& random) {
        const double extinction = in.scattering_per_mm + in.absorption_per_mm, g = in.asymmetry;
        while (weight > 0.0) {
            const double end = towards.z() > 0.0 ? in.thickness_mm : 0.0;
            const double rest = (end - at.z()) / towards.z();
            const double step = extinction > 0.0 ? -std::log(random()) / extinction : INFINITY;
            at += std::min(step, rest) * towards;
            if (step >= rest) return;
            weight *= in.scattering_per_mm / extinction;
            if (weight < kLeastWeight) weight = random() < kSurvivors ? weight / kSurvivors : 0.0;
            const double t = (1.0 - g * g) / (1.0 - g + 2.0 * g * random());
            const double cosine =
                std::abs(g) < 1e-6 ? 2.0 * random() - 1.0 : (1.0 + g * g - t * t) / (2.0 * g);
            towards = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), towards) *
                      random.direction(cosine);
        }
    }
};

/// Adds to both what leaves above and below, beside the ports.
void trace(const LitSample& sample, bool diffuse, Random random, double& above, double& below) {
    const double radius =
        0.5 * (diffuse ? sample.diffuse_mm : sample.beam_mm) * std::sqrt(random());
    Photon photon{.at = radius * random.direction(0.0),
                  .towards = random.direction(diffuse ? std::sqrt(random()) : sample.mu_in)};
    photon.meet_surface(sample, random);
    while (photon.plate >= 0 && photon.plate < int(sample.plates.size())) {
        photon.fly(sample.plates[std::size_t(photon.plate)], random);
        if (photon.weight == 0.0) return;
        photon.meet_surface(sample, random);
    }
    const bool is_above = photon.plate < 0;
    const double port = is_above ? sample.port_above_mm : sample.port_below_mm;
    if (photon.at.head<2>().norm() > 0.5 * port) (is_above ? above : below) += photon.weight;
}

std::vector<Plate> plates_of(const Scene& scene, double wavelength_nm) {
    const ResolvedScene resolved = resolve(scene, {wavelength_nm});
    std::map<std::string, LayerOptics> optics;
    for (const LayerOptics& layer : solve(scene, {wavelength_nm}).layers())
        optics[layer.layer] = layer;
    std::vector<Plate> plates;
    for (std::size_t i = scene.layers.size(); i-- > 0;) {
        const Layer& layer = scene.layers[i];
        const LayerOptics& at = optics[fmt::format("coat {}", i + 1)];
        if (layer.depth.kind != Depth::Kind::thickness_um || !at.scattering_per_um)
            throw UsageError(fmt::format(
                "lost_light: the coat '{}@{}' has no thickness in mm; give it one, with amounts or "
                "as turbid:MU_A,MU_S_REDUCED,G",
                describe(layer.medium), describe(layer.depth)));
        const auto& medium = resolved.media[resolved.first_medium() + i];
        plates.push_back({.index = scene.boundary ? medium.host_index[0] : 1.0,
                          .thickness_mm = 1e-3 * layer.depth.value,
                          .scattering_per_mm = 1e3 * *at.scattering_per_um,
                          .absorption_per_mm = 1e3 * *at.absorption_per_um,
                          .asymmetry = std::isnan(at.asymmetry) ? 0.0 : at.asymmetry});
    }
    return plates;
}

}  // namespace

LostLight trace_lost_light(const LitSample& sample) {
    LostLight lost;
    for (std::uint64_t i = 0; i < 2 * kPhotons; ++i) {
        const bool diffuse = i % 2 == 1;
        trace(sample, diffuse, {i * 0xD1B54A32D192ED03u}, diffuse ? lost.r_diffuse : lost.r_direct,
              diffuse ? lost.t_diffuse : lost.t_direct);
    }
    for (double* share : {&lost.r_direct, &lost.t_direct, &lost.r_diffuse, &lost.t_diffuse})
        *share /= kPhotons;
    lost.r_diffuse_below = lost.r_diffuse;
    return lost;
}

double update_lost_light(FitProblem& problem, const Model& model, std::span<const double> numbers) {
    double change = 0.0;
    for (const Job& job : model.jobs()) {
        for (const Job::Use& use : job.uses) {
            if (use.of_spheres == nullptr || !use.of_spheres->lost_light) continue;
            const double nm = job.wavelength_nm[use.wavelength];
            const Scene scene = model.scene(job, numbers);
            const SphereMeasurement& m = *use.of_spheres->spheres;
            LitSample sample{.plates = plates_of(scene, nm),
                             .mu_in = job.directions.mu_in[use.in],
                             .beam_mm = m.beam_mm,
                             .diffuse_mm = m.above.sample_port_mm,
                             .port_above_mm = m.above.sample_port_mm,
                             .port_below_mm = m.below.sample_port_mm};
            if (scene.substrate && scene.substrate->kind != Substrate::Kind::none)
                sample.index_below = sample.plates.back().index;
            const LostLight now = trace_lost_light(sample);
            FitData& data = problem.data[std::size_t(use.of_spheres - problem.data.data())];
            LostLight& before = data.lost[nm];
            change = std::max({change, std::abs(now.r_direct - before.r_direct),
                               std::abs(now.t_direct - before.t_direct),
                               std::abs(now.r_diffuse - before.r_diffuse)});
            before = now;
        }
    }
    return change;
}

}  // namespace miebrdf::fitting
