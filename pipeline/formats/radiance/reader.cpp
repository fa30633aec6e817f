// Radiance's BSDF XML, front reflection: Klems matrices and tensor trees.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <pugixml.hpp>

#include <miebrdf/brdf_source.h>
#include <miebrdf/formats.h>
#include "pipeline/solve/vector_pairs.h"

namespace miebrdf {
namespace {

using std::numbers::pi;

/// Numbers of a matrix or a full tree, whatever stands between them; seven digits, as Radiance has
/// them.
std::vector<float> parse_values(const char* text, std::size_t largest) {
    std::vector<float> values;
    const char* const end = text + std::char_traits<char>::length(text);
    values.reserve(std::min(largest, static_cast<std::size_t>(end - text) / 8));
    while (text < end) {
        if (std::string_view(" \t\r\n,{}").find(*text) != std::string_view::npos) {
            ++text;
            continue;
        }
        float value = 0.0F;
        const auto [after, error] = std::from_chars(text, end, value);
        if (error != std::errc() || !std::isfinite(value))
            throw InputError("radiance: ScatteringData has no number");
        values.push_back(value);
        if (values.size() > largest)
            throw InputError("radiance: ScatteringData has too many numbers");
        text = after;
    }
    return values;
}

/// The block of front reflection ("Reflection Back" in WINDOW's words), or of what passes from the
/// front, at a wavelength of that name; empty when there is none.
/// @throws InputError  for what is no number, or more than `largest` of them
std::vector<float> radiance_block(const pugi::xml_node& layer, std::string_view wavelength,
                                  std::size_t largest) {
    for (const pugi::xml_node data : layer.children("WavelengthData")) {
        const pugi::xml_node part = data.child("WavelengthDataBlock");
        if (data.child_value("Wavelength") != wavelength) continue;
        const std::string_view direction = part.child_value("WavelengthDataDirection");
        if (direction != "Reflection Back" && direction != "Transmission Back") continue;
        return parse_values(part.child_value("ScatteringData"), largest);
    }
    return {};
}

using Colour = std::array<double, 3>;
using Matrix = double[3][3];

Colour product(const Matrix& matrix, const Colour& colour) {
    Colour result{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < 3; ++c) result[i] += matrix[i][c] * colour[c];
    }
    return result;
}

/// Radiance's R, G, B of CIE XYZ: nominal CRT primaries, neutral at X = Y = Z (color.h).
Colour radiance_rgb(const Colour& xyz) {
    constexpr Matrix kRgb = {{2.5653128430, -1.1668496158, -0.3984632272},
                             {-1.0221081721, 1.9782866167, 0.0438215555},
                             {0.0747243773, -0.2519395672, 1.1772151899}};
    return product(kRgb, xyz);
}

/// The primaries in which Radiance adds up parts of a BSDF (ccolor.c).
constexpr Matrix kSharpOfXyz = {
    {1.2694, -0.0988, -0.1706}, {-0.8364, 1.8006, 0.0357}, {0.0297, -0.0315, 1.0018}};
constexpr Matrix kXyzOfSharp = {
    {0.8156, 0.0472, 0.1372}, {0.3791, 0.5769, 0.0440}, {-0.0123, 0.0167, 0.9955}};

Colour xyz_of_chromaticity(double Y, double u, double v) {
    return {Y * 9 * u / (4 * v), Y, Y * (12 - 3 * u - 20 * v) / (4 * v)};
}

/// Constant over cells of the directions, which each kind numbers its own way.
class RadianceFile : public BrdfFile {
  public:
    std::string format() const override { return "radiance"; }
    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return no_wavelengths_; }

    void look_up(const Direction& direction, std::span<double> values) const override {
        const std::size_t cell = cell_of(direction);
        const std::array<double, 3> rgb = colour_of(cell);
        std::copy(rgb.begin(), rgb.end(), values.begin());
    }

  protected:
    virtual std::size_t cell_of(const Direction& direction) const = 0;
    virtual std::array<double, 3> colour_of(std::size_t cell) const = 0;

  private:
    std::vector<std::string> channels_ = {"R", "G", "B"};
    std::vector<double> no_wavelengths_;
};

/// A matrix over the patches of rings about the normal, as Radiance's bsdf_m.c evaluates it.
class KlemsFile : public RadianceFile {
  public:
    explicit KlemsFile(const pugi::xml_node& layer) {
        for (const pugi::xml_node ring :
             layer.child("DataDefinition").child("AngleBasis").children("AngleBasisBlock")) {
            const int patches = ring.child("nPhis").text().as_int();
            const double upper = ring.child("ThetaBounds").child("UpperTheta").text().as_double();
            const double lower = rings_.empty() ? 0.0 : rings_.back().upper_deg;
            if (patches < 1 || patches > 10000 || !(upper > lower && upper <= 90.0) ||
                rings_.size() > 100) {
                throw InputError("radiance: the angle basis is damaged");
            }
            rings_.push_back({upper, static_cast<std::size_t>(patches), patches_});
            patches_ += static_cast<std::size_t>(patches);
        }
        if (rings_.empty()) throw InputError("radiance: no angle basis");
        const std::size_t size = patches_ * patches_;
        y_ = radiance_block(layer, "Visible", size);
        x_ = radiance_block(layer, "CIE-X", size);
        z_ = radiance_block(layer, "CIE-Z", size);
        if (y_.size() != size || (!x_.empty() && x_.size() != size) ||
            (!z_.empty() && z_.size() != size)) {
            throw InputError(fmt::format("radiance: {} values of a {} x {} matrix", y_.size(),
                                         patches_, patches_));
        }
    }
    std::string description() const override {
        return fmt::format("Klems matrix of {} patches", patches_);
    }

  private:
    struct Ring {
        double upper_deg;
        std::size_t patches, first;
    };

    std::size_t patch(double mu, double azimuth_deg) const {
        const double theta = std::acos(std::clamp(mu, -1.0, 1.0)) * 180 / pi;
        const auto ring = std::find_if(rings_.begin(), rings_.end() - 1,
                                       [&](const Ring& r) { return theta < r.upper_deg; });
        const double turns = azimuth_deg / 360.0 - std::floor(azimuth_deg / 360.0);
        const auto count = static_cast<double>(ring->patches);
        return ring->first + static_cast<std::size_t>(std::lround(turns * count)) % ring->patches;
    }

    /// Incident azimuth 0 is turned by half a turn in this basis: equal patches are mirror
    /// directions.
    std::size_t cell_of(const Direction& d) const override {
        return patch(d.mu_out, d.azimuth_deg) * patches_ + patch(d.mu_in, 0.0);
    }
    std::array<double, 3> colour_of(std::size_t cell) const override {
        if (x_.empty() || z_.empty()) return {y_[cell], y_[cell], y_[cell]};
        return radiance_rgb({x_[cell], y_[cell], z_[cell]});
    }

    std::vector<Ring> rings_;
    std::size_t patches_ = 0;
    std::vector<float> x_, y_, z_;
};

/// Shirley and Chiu's map from the unit disk to the unit square.
std::pair<double, double> disk_to_square(double dx, double dy) {
    const double r = std::hypot(dx, dy);
    double phi = std::atan2(dy, dx);
    if (phi < -pi / 4) phi += 2 * pi;
    double a = 0, b = 0;
    if (phi < pi / 4) {
        a = r, b = phi * r / (pi / 4);
    } else if (phi < 3 * pi / 4) {
        b = r, a = -(phi - pi / 2) * r / (pi / 4);
    } else if (phi < 5 * pi / 4) {
        a = -r, b = (phi - pi) * a / (pi / 4);
    } else {
        b = -r, a = -(phi - 3 * pi / 2) * b / (pi / 4);
    }
    return {(a + 1) / 2, (b + 1) / 2};
}

/// A tensor tree of three dimensions that is a full grid, as Radiance's bsdf_t.c evaluates it.
class TreeFile : public RadianceFile {
  public:
    /// @param largest  no more numbers than this can be in the file
    TreeFile(const pugi::xml_node& layer, std::size_t largest) {
        y_ = radiance_block(layer, "Visible", largest);
        u_ = radiance_block(layer, "CIE-u", largest);
        v_ = radiance_block(layer, "CIE-v", largest);
        while (side_ * side_ * side_ < y_.size()) side_ *= 2;
        if (y_.empty() || side_ * side_ * side_ != y_.size()) {
            throw InputError(fmt::format(
                "radiance: a tree of {} values is no full grid; nested trees are not read",
                y_.size()));
        }
        if ((!u_.empty() && u_.size() != y_.size()) || (!v_.empty() && v_.size() != y_.size())) {
            throw InputError("radiance: the trees of colour and luminance differ");
        }
        subtract_diffuse();
    }
    std::string description() const override {
        return fmt::format("tensor tree, {} cells a side", side_);
    }

  private:
    std::size_t index(double x) const {
        return std::min(side_ - 1,
                        static_cast<std::size_t>(std::max(x, 0.0) * static_cast<double>(side_)));
    }
    std::size_t cell_of(const Direction& d) const override {
        const auto [in, out] = vectors_of(d);
        const auto [x, y] = disk_to_square(-out.x(), out.y());
        // Normal incidence belongs to the last cell in use, as in Radiance.
        return (index(0.5 - 1e-6 - 0.5 * in.x()) * side_ + index(x)) * side_ + index(y);
    }
    /// When it loads a coloured tree, Radiance takes its least colour for a diffuse part. What is
    /// left of an isotropic tree then has no chromaticity any more (bsdf_t.c, subtract_min_RGB).
    void subtract_diffuse() {
        constexpr double kLeast = 0.01 / pi;
        if (u_.empty() || v_.empty()) return;
        Colour least = {1e10, 1e10, 1e10};
        for (std::size_t cell = 0; cell < y_.size() / 2; ++cell) {
            const Colour sharp =
                product(kSharpOfXyz, xyz_of_chromaticity(y_[cell], u_[cell], v_[cell]));
            for (std::size_t c = 0; c < 3; ++c) least[c] = std::min(least[c], sharp[c]);
        }
        const Colour xyz = product(kXyzOfSharp, least);
        if (!(xyz[1] > kLeast)) return;
        diffuse_ = xyz;
        u_.clear();
        v_.clear();
        left_over_red_ = true;
    }

    Colour colour_of(std::size_t cell) const override {
        const double Y = y_[cell];
        if (left_over_red_) {  // the first of its primaries
            const double rest = std::max(Y - diffuse_[1], 0.0) / kXyzOfSharp[1][0];
            Colour xyz = diffuse_;
            for (std::size_t i = 0; i < 3; ++i) xyz[i] += rest * kXyzOfSharp[i][0];
            return radiance_rgb(xyz);
        }
        if (u_.empty() || v_.empty() || !(v_[cell] > 0)) return {Y, Y, Y};
        return radiance_rgb(xyz_of_chromaticity(Y, u_[cell], v_[cell]));
    }

    std::size_t side_ = 1;
    std::vector<float> y_, u_, v_;
    Colour diffuse_ = {0.0, 0.0, 0.0};
    bool left_over_red_ = false;
};

Recognised recognise_radiance(std::string_view content) {
    const bool found = content.substr(0, 1 << 16).find("<WindowElement") != content.npos;
    return found ? Recognised::by_structure : Recognised::no;
}

std::unique_ptr<BrdfFile> read_radiance(std::string content) {
    pugi::xml_document document;
    const std::size_t size = content.size();  // parsing in place writes into the content
    const auto result = document.load_buffer_inplace(content.data(), size);
    if (!result)
        throw InputError(
            fmt::format("radiance: {} at byte {}", result.description(), result.offset));
    const pugi::xml_node layer = document.child("WindowElement").child("Optical").child("Layer");
    const std::string_view structure =
        layer.child("DataDefinition").child_value("IncidentDataStructure");
    if (structure == "Columns") return std::make_unique<KlemsFile>(layer);
    if (structure == "TensorTree3") return std::make_unique<TreeFile>(layer, size);
    throw InputError(fmt::format(
        "radiance: incident data structure '{}'; known: Columns, TensorTree3", structure));
}

}  // namespace

FormatReader radiance_reader() { return {recognise_radiance, read_radiance}; }

}  // namespace miebrdf
