// pbsdf: the polarised BRDFs that Mitsuba 3 calls `measured_polarized`. docs/formats/pbsdf.md
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pipeline/formats/common/export_job.h"
#include "pipeline/formats/common/tensor_writer.h"
#include "pipeline/solve/parallel.h"
#include "pipeline/solve/vector_pairs.h"

namespace miebrdf {

FormatReader pbsdf_reader();  // reader.cpp

namespace {

/// The most that Mitsuba's reader keeps room for.
constexpr std::size_t kMostPbsdfWavelengths = 5;
/// Nodes at and beyond the horizon count in cells that it divides: they hold the matrix of this
/// height, in steps of the angles. A BRDF that grows as the inverse cosine is off by a quarter in
/// the middle of such a cell; with the value of the horizon itself it would be many times too
/// large.
constexpr double kLowestPbsdfHeight = 0.25;

/// Two rays by Rusinkiewicz's angles, and the axis that Stokes vectors of both refer to: across
/// their plane, also where they are the same ray.
struct PbsdfPlace {
    Eigen::Vector3d in, out, across;
};

PbsdfPlace place_of(double theta_h, double theta_d, double phi_d) {
    const Eigen::Vector3d half = spherical(theta_h, 0.0);
    const Eigen::Vector3d tangent(std::cos(theta_h), 0.0, -std::sin(theta_h));
    const Eigen::Vector3d bitangent(0.0, 1.0, 0.0);
    const Eigen::Vector3d along = std::cos(phi_d) * tangent + std::sin(phi_d) * bitangent;
    return {std::cos(theta_d) * half + std::sin(theta_d) * along,
            std::cos(theta_d) * half - std::sin(theta_d) * along,
            std::cos(phi_d) * bitangent - std::sin(phi_d) * tangent};
}

Eigen::Vector3d above_horizon(Eigen::Vector3d ray, double lowest_cosine) {
    if (ray.z() >= lowest_cosine) return ray;
    ray.z() = 0.0;
    const double sine = std::sqrt((1.0 - lowest_cosine) * (1.0 + lowest_cosine));
    ray *= sine / std::max(ray.norm(), 1e-300);
    ray.z() = lowest_cosine;
    return ray;
}

/// The meridian axes of a ray that travels along `ray`: parallel, and with it and the ray
/// right-handed. Of a vertical ray the plane of `horizontal`.
struct PbsdfAxes {
    Eigen::Vector3d parallel, second;

    PbsdfAxes(const Eigen::Vector3d& ray, const Eigen::Vector3d& horizontal) {
        const double sine = std::sqrt(std::max(0.0, (1.0 - ray.z()) * (1.0 + ray.z())));
        parallel = Eigen::Vector3d(0, 0, sine) - ray.z() * horizontal;
        if (ray.z() < 0.0) parallel = -Eigen::Vector3d(0, 0, sine) + ray.z() * horizontal;
        second = ray.cross(parallel);
    }

    /// Turns (Q, U) from these axes to others, of which `first` is the first.
    Eigen::Matrix4d turned_to(const Eigen::Vector3d& first) const {
        const double x = first.dot(parallel), y = first.dot(second), square = x * x + y * y;
        Eigen::Matrix4d turn = Eigen::Matrix4d::Identity();
        if (!(square > 0.0)) return turn;
        turn(1, 1) = turn(2, 2) = (x - y) * (x + y) / square;
        turn(1, 2) = 2.0 * x * y / square;
        turn(2, 1) = -turn(1, 2);
        return turn;
    }
};

/// A place as directions, and how its matrix turns from the meridian planes to the file's axes.
struct PbsdfNode {
    Direction direction;
    Eigen::Matrix4d from_in, to_out;

    PbsdfNode(const PbsdfPlace& place, double lowest_cosine) {
        const Eigen::Vector3d in = above_horizon(place.in, lowest_cosine),
                              out = above_horizon(place.out, lowest_cosine);
        Eigen::Vector3d forward(-in.x(), -in.y(), 0), away(out.x(), out.y(), 0);
        constexpr double vertical = 1e-9;
        const bool in_is_vertical = forward.norm() < vertical;
        if (away.norm() < vertical) away = in_is_vertical ? Eigen::Vector3d(1, 0, 0) : forward;
        if (in_is_vertical) forward = away;
        forward.normalize();
        away.normalize();
        // Counterclockwise from above: with it, U and V of docs/polarisation.md are those of
        // right-handed axes, V with the other sign.
        const double azimuth = std::atan2(forward.cross(away).z(), forward.dot(away));
        direction = {std::min(in.z(), 1.0), std::min(out.z(), 1.0), azimuth / kDegree};
        from_in = PbsdfAxes(-in, forward).turned_to(place.across).transpose();
        to_out = PbsdfAxes(out, away).turned_to(place.across);
    }

    /// @param values  components x components
    Eigen::Matrix4d matrix(const double* values, int components) const {
        Eigen::Matrix4d ours = Eigen::Matrix4d::Zero();
        for (int row = 0; row < components; ++row) {
            for (int column = 0; column < components; ++column)
                ours(row, column) = values[row * components + column];
        }
        Eigen::Matrix4d theirs = to_out * ours * from_in;
        theirs.row(3) = -theirs.row(3);
        theirs.col(3) = -theirs.col(3);
        return theirs;
    }
};

class PbsdfGrid {
  public:
    explicit PbsdfGrid(const ExportJob& job)
        : job_(job),
          n_(static_cast<std::size_t>(job.options.resolution)),
          wavelengths_(job.spectral.wavelength_nm().size()),
          lowest_cosine_(std::sin(kLowestPbsdfHeight * theta(1))) {}

    std::vector<TensorField> fields(const std::string& description) {
        const std::vector<float> theta = angles(0.0, n_), phi = angles(-std::numbers::pi, 2 * n_);
        std::vector<std::uint16_t> nm;
        for (const double wavelength : job_.spectral.wavelength_nm())
            nm.push_back(static_cast<std::uint16_t>(wavelength));
        std::vector<TensorField> fields;
        fields.push_back(byte_field("description", description));
        fields.push_back(float_field("phi_d", {1, phi.size()}, phi));
        fields.push_back(float_field("theta_d", {1, theta.size()}, theta));
        fields.push_back(float_field("theta_h", {1, theta.size()}, theta));
        fields.push_back(short_field("wvls", nm));
        fields.push_back(float_field(
            "M", {phi.size(), theta.size(), theta.size(), wavelengths_, 4, 4}, matrices()));
        return fields;
    }

  private:
    /// From `first` to 90 degrees, or 180 where it begins at -180; `intervals` of them.
    static std::vector<float> angles(double first, std::size_t intervals) {
        std::vector<float> list;
        const double width = first < 0.0 ? -2.0 * first : std::numbers::pi / 2.0;
        for (std::size_t k = 0; k <= intervals; ++k)
            list.push_back(static_cast<float>(first + width * double(k) / double(intervals)));
        return list;
    }

    double theta(std::size_t k) const { return std::numbers::pi / 2.0 * double(k) / double(n_); }

    /// [phi_d][theta_d][theta_h][wavelength][row][column]. phi_d and -phi_d are mirror images.
    std::vector<float> matrices() const {
        const std::size_t side = n_ + 1, plane = side * side * wavelengths_ * 16;
        std::vector<float> all((2 * n_ + 1) * plane);
        run_parallel("difference angles", n_ + 1, job_.control, [&](std::size_t p) {
            const double phi_d = std::numbers::pi * double(p) / double(n_);
            float* const here = all.data() + (n_ + p) * plane;
            for (std::size_t d = 0; d < side; ++d) {
                for (std::size_t h = 0; h < side; ++h) {
                    const PbsdfNode node(place_of(theta(h), theta(d), phi_d), lowest_cosine_);
                    fill(node, here + (d * side + h) * wavelengths_ * 16);
                }
            }
            float* const mirrored = all.data() + (n_ - p) * plane;
            for (std::size_t i = 0; i < plane; ++i) {
                const bool changes = (i % 16 / 4 < 2) != (i % 4 < 2);
                mirrored[i] = changes ? -here[i] : here[i];
            }
        });
        return all;
    }

    void fill(const PbsdfNode& node, float* target) const {
        const int components = job_.spectral.components();
        const auto elements = static_cast<std::size_t>(components * components);
        std::vector<double> values(wavelengths_ * elements);
        job_.spectral.evaluate_mueller({&node.direction, 1}, values);
        for (std::size_t w = 0; w < wavelengths_; ++w) {
            const Eigen::Matrix4d M = node.matrix(&values[w * elements], components);
            for (int e = 0; e < 16; ++e) *target++ = static_cast<float>(M(e / 4, e % 4));
        }
    }

    const ExportJob& job_;
    std::size_t n_, wavelengths_;
    double lowest_cosine_;
};

void require_pbsdf_wavelengths(const std::vector<double>& wavelength_nm) {
    if (wavelength_nm.size() > kMostPbsdfWavelengths) {
        throw UsageError("wavelengths", std::to_string(wavelength_nm.size()),
                         "at most 5 with pbsdf: its reader has room for no more");
    }
    for (const double nm : wavelength_nm) {
        if (nm == std::floor(nm) && nm <= 65535.0) continue;
        throw UsageError("wavelength_nm", nm, "whole nanometres up to 65535 with pbsdf");
    }
}

const char* what_pbsdf_holds(int components) {
    if (components == 4) return "4 x 4";
    return components == 3 ? "3 x 3; the row and column of V are 0"
                           : "unpolarised light alone: all elements but the first are 0";
}

void write_pbsdf(const ExportJob& job, std::ostream& out) {
    require_pbsdf_wavelengths(job.spectral.wavelength_nm());
    auto description = metadata(job.spectral, {.format = "pbsdf",
                                               .cosine_included = false,
                                               .azimuth_zero = "difference angle, Rusinkiewicz",
                                               .colour = ""});
    description["mueller"] = what_pbsdf_holds(job.spectral.components());
    description["stokes_axes"] =
        "x perpendicular to the plane of both rays, y in it, x, y and the direction of travel "
        "right-handed; Q along x, U along x + y, V right-handed (clockwise as seen by who looks "
        "towards the source)";
    PbsdfGrid grid(job);
    write_tensor_file(grid.fields(description.dump(1)), out);
}

std::uintmax_t pbsdf_bytes(const ExportOptions& options, std::size_t wavelengths) {
    const auto n = static_cast<std::uintmax_t>(options.resolution);
    return (2 * n + 1) * (n + 1) * (n + 1) * wavelengths * 16 * sizeof(float);
}

}  // namespace

Format pbsdf_format() {
    return {.name = "pbsdf",
            .readers = "Mitsuba 3 `measured_polarized`",
            .holds = "Mueller matrices of up to 5 wavelengths",
            .endings = {".pbsdf"},
            .content = FormatContent::sampled,
            .resolution = {"intervals of 90 degrees", 45, 4, 180, 90},
            .whole_matrix = true,
            .accepted = {.plain = 0.05},
            .needs_ascending_wavelengths = true,
            .expected_bytes = pbsdf_bytes,
            .files = {{.write = write_pbsdf}},
            .reader = pbsdf_reader()};
}

}  // namespace miebrdf
