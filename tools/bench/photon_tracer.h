// Monte Carlo transport of photons through coats on a half-space: the check from outside.
// It shares no code and no equation with rte/: photons move, scatter and leave.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace miebrdf::bench {

using PhiloxCounter = std::array<std::uint32_t, 4>;
using PhiloxKey = std::array<std::uint32_t, 2>;

/// Philox4x32-10 (Salmon, Moraes, Dror & Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3";
/// constants of its table 2 and section 4.3): random numbers as a function of seed, stream and
/// position, the same for any order of evaluation.
inline PhiloxCounter philox(PhiloxCounter c, PhiloxKey k) {
    const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
    const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); };
    for (int round = 0; round < 10; ++round) {
        const std::uint64_t a = std::uint64_t{0xD2511F53} * c[0];
        const std::uint64_t b = std::uint64_t{0xCD9E8D57} * c[2];
        c = {high(b) ^ c[1] ^ k[0], low(b), high(a) ^ c[3] ^ k[1], low(a)};
        k = {k[0] + 0x9E3779B9, k[1] + 0xBB67AE85};
    }
    return c;
}

/// Uniform numbers of one stream, for instance of one photon.
class RandomStream {
  public:
    RandomStream(std::uint64_t seed, std::uint64_t stream)
        : key_{std::uint32_t(seed), std::uint32_t(seed >> 32)},
          counter_{0, 0, std::uint32_t(stream), std::uint32_t(stream >> 32)} {}

    /// In (0, 1), both ends excluded: 53 random bits, shifted by half a unit, so that logarithms
    /// are finite.
    double uniform() {
        if (used_ == 4) {
            block_ = philox(counter_, key_);
            if (++counter_[0] == 0) ++counter_[1];
            used_ = 0;
        }
        const std::uint64_t bits = (std::uint64_t{block_[used_]} << 32 | block_[used_ + 1]) >> 11;
        used_ += 2;
        // The largest sum would round up to 1 in the last place.
        const double u = (static_cast<double>(bits) + 0.5) * 0x1p-53;
        return u < 1.0 ? u : 1.0 - 0x1p-53;
    }

  private:
    PhiloxKey key_;
    PhiloxCounter counter_, block_ = {};
    std::size_t used_ = 4;
};

/// z points down, from air into the medium.
struct RayDirection {
    double x = 0.0, y = 0.0, z = 1.0;
};

/// Fresnel's reflectance of unpolarised light, and the cosine behind the boundary.
/// @param index  n + i 0 of what lies behind over what lies before
struct FresnelRay {
    double reflectance = 1.0;
    double cosine_behind = 0.0;  ///< 0 where all is reflected
};
FresnelRay fresnel(double index, double cosine);

/// The boundary between air and a medium.
struct TracedBoundary {
    double index = 1.0;      ///< of the medium, at least 1
    double roughness = 0.0;  ///< slope parameter alpha of GGX facets; 0: smooth

    bool is_there() const { return index != 1.0; }
};

struct BoundaryExit {
    bool into_medium = false;
    RayDirection direction;
};

/// Follows one ray that meets the boundary. A smooth one reflects or refracts it once. A rough
/// one is the random walk of Heitz, Hanika, d'Eon & Dachsbacher 2016 (ACM Trans. Graph. 35, 58):
/// free paths between facets by Smith's Lambda, facets by their visible area, until it leaves.
BoundaryExit meet_boundary(const TracedBoundary& boundary, bool from_air, const RayDirection& ray,
                           RandomStream& random);

/// A phase function to draw scattering angles from, normalised so that its mean over the sphere
/// is 1.
class ScatteringLaw {
  public:
    static ScatteringLaw isotropic();
    static ScatteringLaw rayleigh();
    /// @param asymmetry  g in (-1, 1)
    static ScatteringLaw henyey_greenstein(double asymmetry);
    /// Linear in cos Theta between the given points, normalised to mean 1.
    /// @param cos_theta  strictly ascending from -1 to 1
    /// @param value      P >= 0, not all 0
    /// @throws std::invalid_argument  for anything else
    static ScatteringLaw tabulated(std::vector<double> cos_theta, std::vector<double> value);

    double value(double cos_theta) const;

    /// cos Theta below which the fraction `u` in (0, 1) of the light is scattered.
    double sample(double u) const;

  private:
    enum class Kind { isotropic, rayleigh, henyey_greenstein, tabulated };
    explicit ScatteringLaw(Kind kind) : kind_(kind) {}

    Kind kind_;
    double g_ = 0.0;
    std::vector<double> cos_theta_, value_, cumulative_;
};

/// One homogeneous layer for the tracer.
struct TracedLayer {
    double single_scattering_albedo = 0.0;
    ScatteringLaw law = ScatteringLaw::isotropic();
    double optical_depth = 0.0;  ///< ignored for the base, which has no end
};

struct TracedStack {
    TracedLayer base;
    std::vector<TracedLayer> coats;  ///< in painting order: the last one is on top
    TracedBoundary boundary = {};    ///< on top; all layers have its index
    /// Albedo of a Lambertian ground in place of the base; 0: black.
    std::optional<double> ground_albedo = {};
};

/// A direction in which reflected light is looked at; conventions of docs/conventions.md.
struct Detector {
    double mu_out = 1.0;
    double azimuth_deg = 0.0;
};

struct TracerOptions {
    int photons = 100000;
    std::uint64_t seed = 1;
    /// Photons that are still inside after so many collisions are given up and counted in
    /// `Estimate::unfinished`: without absorption some of them never come back.
    int most_collisions = 20000;
};

/// Mean of what the photons say, and how sure it is.
struct Estimate {
    double value = 0.0;
    double standard_error = 0.0;  ///< of the mean, from the spread over photons
    /// Largest amount by which photons given up may have made `value` too small.
    double unfinished = 0.0;

    /// Whether a truth is inside `sigmas` standard errors (and what was given up).
    bool agrees_with(double truth, double sigmas, double allowance = 0.0) const;
};

struct TracedReflection {
    Estimate plane_albedo;
    std::vector<Estimate> reflection;  ///< R = pi * BRDF at each detector
};

/// Traces photons that arrive at mu_in.
///
/// Free paths are exponential in optical depth; absorption is a weight, ended by Russian roulette.
/// The plane albedo is the weight that leaves. R at a detector is the sum over collisions of
/// w P(Theta) exp(-t / mu_out) / (4 mu_out), t the optical depth below the top (next-event or local
/// estimate; Marchuk et al. 1980, "The Monte Carlo Methods in Atmospheric Optics", ch. 2); behind a
/// smooth boundary, with the cosine inside and times its transmittance / n^2. What a smooth
/// boundary reflects of the incident light is in the plane albedo and in no detector. Photon i uses
/// random stream i of the seed, so results are reproducible bit by bit.
///
/// @param mu_in  in (0, 1]
/// @throws std::invalid_argument  for a cosine, albedo, optical depth or count out of range, and
/// for
///         detectors behind a rough boundary, which hides where light goes
TracedReflection trace_photons(const TracedStack& stack, double mu_in,
                               const std::vector<Detector>& detectors,
                               const TracerOptions& options = {});

}  // namespace miebrdf::bench
