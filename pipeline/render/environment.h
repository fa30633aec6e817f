// Light from all directions at infinity.
#pragma once

#include <Eigen/Core>

#include <array>
#include <span>
#include <string>
#include <vector>

#include "pipeline/render/image.h"

namespace miebrdf::render {

/// One value for each wavelength of the picture.
using Spectrum = std::vector<double>;

/// A sphere of radiance around the object, as a latitude-longitude map of up to three basis
/// spectra. y points up; the middle of the map lies towards -z and its right edge is approached
/// through +x (seen from inside, as a panorama).
class Environment {
  public:
    struct Sample {
        Eigen::Vector3d direction;
        double density = 0.0;  ///< per solid angle
    };

    /// Sends the same radiance from everywhere.
    static Environment uniform(Spectrum radiance);

    /// @param map    width = 2 height, three channels: weights of the basis spectra
    /// @param name   of the map, for messages
    /// @throws InputError  for another shape, or a pixel that is negative or not finite
    static Environment from_map(const Image& map, const std::array<Spectrum, 3>& basis,
                                const std::string& name);

    std::size_t wavelengths() const { return basis_[0].size(); }
    /// Radiance from a unit direction, interpolated bilinearly in the map.
    void radiance(const Eigen::Vector3d& direction, std::span<double> values) const;

    /// Whether bright parts deserve rays of their own; if not, sample() must not be called.
    bool has_density() const { return !row_end_.empty(); }
    /// A direction, more often where the map is bright.
    Sample sample(const std::array<double, 2>& u) const;
    /// Density of sample() at a direction.
    double density(const Eigen::Vector3d& direction) const;

  private:
    Environment() = default;
    void build_distribution();
    double pixel_probability(int x, int y) const;

    Image map_;
    std::array<Spectrum, 3> basis_;
    std::vector<double> row_end_;     ///< cumulated probability of rows
    std::vector<double> column_end_;  ///< cumulated within each row, height x width
};

/// Latitude-longitude map of a clear sky over flat ground, channels (sky, ground, 0): the
/// luminance distribution of the CIE standard clear sky (ISO 15469:2004, type 12), scaled to an
/// irradiance of `sky_irradiance` on level ground; below the horizon the ground reflects
/// ground_radiance evenly. The sun itself is not in the map.
/// @param sun  unit vector towards the sun, above the horizon (y > 0)
Image clear_sky_map(const Eigen::Vector3d& sun, double sky_irradiance, double ground_radiance);

/// Direction from elevation above the horizon and azimuth from the front (+z) towards the right
/// (+x), in degrees.
Eigen::Vector3d direction_from_angles(double elevation_deg, double azimuth_deg);

}  // namespace miebrdf::render
