// A BRDF file as a renderer or tool sees it: what `miebrdf check` asks. Readers are written from
// the layouts alone and share no code with the writers; they evaluate (interpolate, clamp, divide
// by the cosine) as the real program does. docs/formats has a page for each.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/solve/brdf_source.h"

namespace miebrdf::exports {

/// The directions of a table: it has a value at each combination.
struct ListedDirections {
    std::vector<double> mu_in, mu_out;  ///< ascending
    std::vector<double> azimuth_deg;    ///< ascending, 0 = mirror side
    /// Programs that read the format interpolate: what lies between is as much the file's.
    bool interpolated = false;
};

class BrdfFile {
  public:
    virtual ~BrdfFile() = default;

    /// Name of the format on the command line, and what is special about this file.
    virtual std::string format() const = 0;
    virtual std::string description() const = 0;

    /// "550 nm" or "R", "G", "B" or whatever the file calls them.
    virtual const std::vector<std::string>& channels() const = 0;
    /// Of each channel; empty when the channels are colours.
    virtual const std::vector<double>& wavelength_nm() const = 0;

    /// BRDF in 1/sr without the cosine, one value for each channel; not a number where the file
    /// holds none.
    virtual void evaluate(const Direction& direction, std::span<double> values) const = 0;

    /// Of tables over lists of directions.
    virtual std::optional<ListedDirections> listed() const { return {}; }

    /// Which cosine the format's importance sampling starts from; it draws the other one.
    enum class Sampling { none, from_mu_in, from_mu_out };
    virtual Sampling sampling() const { return Sampling::none; }
    /// Draws a direction with two uniform numbers in [0, 1), as the real program does. Empty when
    /// it fell below the horizon.
    virtual std::optional<Direction> sample(double mu_fixed, double u, double v) const;
    /// Of `sample`, per unit of solid angle, at any direction.
    virtual double density(const Direction& direction) const;
};

/// Reads whatever `content` is, recognised by its first bytes and structure, not by a name. Binary
/// formats are read where they are, others into no more than their text takes; memory stays in
/// proportion to the size of the content, whatever its header claims.
/// @param name  for messages
/// @throws InputError  for an unknown, damaged, truncated or inconsistent file
std::unique_ptr<BrdfFile> read_brdf_file(std::string content, const std::string& name);

/// The same from disk. @throws InputError
std::unique_ptr<BrdfFile> open_brdf_file(const std::string& path);

// One for each format, with the test that recognises it.
bool looks_like_pbrt(std::string_view content);
bool looks_like_rgl(std::string_view content);
bool looks_like_merl(std::string_view content);
bool looks_like_npz(std::string_view content);
bool looks_like_exr(std::string_view content);
bool looks_like_json(std::string_view content);
bool looks_like_csv(std::string_view content);
bool looks_like_ssdd(std::string_view content);
bool looks_like_astm(std::string_view content);
bool looks_like_radiance(std::string_view content);

std::unique_ptr<BrdfFile> read_pbrt(std::string content);
std::unique_ptr<BrdfFile> read_rgl(std::string content);
std::unique_ptr<BrdfFile> read_merl(std::string content);
std::unique_ptr<BrdfFile> read_npz(std::string content);
std::unique_ptr<BrdfFile> read_exr(std::string content);
std::unique_ptr<BrdfFile> read_json(std::string content);
std::unique_ptr<BrdfFile> read_csv(std::string content);
std::unique_ptr<BrdfFile> read_ssdd(std::string content);
std::unique_ptr<BrdfFile> read_astm(std::string content);
std::unique_ptr<BrdfFile> read_radiance(std::string content);

}  // namespace miebrdf::exports
