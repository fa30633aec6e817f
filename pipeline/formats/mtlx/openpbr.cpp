// The BRDF of an OpenPBR surface: "OpenPBR Surface, version 1.1.1" (Academy Software Foundation),
// by its equations of these names.
#include "pipeline/formats/mtlx/openpbr.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/solve/vector_pairs.h"

namespace miebrdf {
namespace {

using std::numbers::pi;

constexpr int kNodes = 32;            // of sqrt(mu), evenly from 0 to 1
constexpr double kLeastAlpha = 1e-4;  // of rte::SurfaceOptions
constexpr double kLeastIndex = 1e-4;  // above 1: nothing is reflected

double lerp(double a, double b, double share) { return a + (b - a) * share; }
double square(double x) { return x * x; }

/// Directional albedo of Fujii's form of the Oren-Nayar BRDF of reflectance 1, and its mean
/// (Portsmouth, Kutz & Hill, "EON: A practical energy-preserving rough diffuse BRDF", 2024).
struct FujiiAlbedo {
    double a, b, mean;

    explicit FujiiAlbedo(double sigma)
        : a(1.0 / (1.0 + (0.5 - 2.0 / (3.0 * pi)) * sigma)),
          b(sigma * a),
          mean(a + (2.0 / 3.0 - 28.0 / (15.0 * pi)) * b) {}

    double at(double mu) const {
        const double s = std::sqrt((1.0 - mu) * (1.0 + mu));
        const double g =
            s * (std::acos(mu) - s * mu) + 2.0 / 3.0 * (s / mu * (1.0 - s * s * s) - s);
        return a + b / pi * g;
    }
};

/// [EON_brdf] at one pair of directions, without base_weight.
class RoughDiffuse {
  public:
    RoughDiffuse(double sigma, const Direction& d) {
        const FujiiAlbedo albedo(sigma);
        const VectorPair v = vectors_of(d);
        const double s = v.in.x() * v.out.x() + v.in.y() * v.out.y();
        single_ = albedo.a + albedo.b * (s > 0.0 ? s / std::max(d.mu_in, d.mu_out) : s);
        lost_ = 1.0 - albedo.mean;
        if (lost_ > 0.0)
            multiple_ =
                albedo.mean / lost_ * (1.0 - albedo.at(d.mu_in)) * (1.0 - albedo.at(d.mu_out));
    }

    double of(double rho) const {
        return (rho * single_ + square(rho) * multiple_ / (1.0 - rho * lost_)) / pi;
    }

  private:
    double single_, lost_, multiple_ = 0.0;
};

double fresnel_at_normal(double index) { return square((index - 1.0) / (index + 1.0)); }

/// [modulated_ior]: the index of which specular_weight times the reflectance is left.
double weakened(double index, double weight) {
    const double epsilon = std::sqrt(std::min(weight * fresnel_at_normal(index), 0.999));
    return index < 1.0 ? (1.0 - epsilon) / (1.0 + epsilon) : (1.0 + epsilon) / (1.0 - epsilon);
}

std::shared_ptr<const DielectricBoundary> boundary_of(double index, double roughness,
                                                      KnownBoundaries* known,
                                                      rte::Shadowing shadowing) {
    const auto make = [&] {
        return std::make_shared<const DielectricBoundary>(index, roughness, shadowing);
    };
    if (known == nullptr) return make();
    auto& found = (*known)[{index, roughness}];
    if (!found) found = make();
    return found;
}

constexpr OpenPbrParameter kParameters[] = {
    {.name = "base_weight", .number = &OpenPbr::base_weight},
    {.name = "base_color", .colour = &OpenPbr::base_color},
    {.name = "base_diffuse_roughness", .number = &OpenPbr::base_diffuse_roughness},
    {.name = "specular_weight", .number = &OpenPbr::specular_weight},
    {.name = "specular_roughness", .number = &OpenPbr::specular_roughness},
    {.name = "specular_ior", .number = &OpenPbr::specular_ior},
    {.name = "subsurface_weight", .number = &OpenPbr::subsurface_weight},
    {.name = "subsurface_color", .colour = &OpenPbr::subsurface_color},
    {.name = "subsurface_radius", .number = &OpenPbr::subsurface_radius},
    {.name = "subsurface_radius_scale", .colour = &OpenPbr::subsurface_radius_scale},
    {.name = "subsurface_scatter_anisotropy", .number = &OpenPbr::subsurface_scatter_anisotropy},
    {.name = "coat_weight", .number = &OpenPbr::coat_weight},
    {.name = "coat_color", .colour = &OpenPbr::coat_color},
    {.name = "coat_roughness", .number = &OpenPbr::coat_roughness},
    {.name = "coat_ior", .number = &OpenPbr::coat_ior},
    {.name = "coat_darkening", .number = &OpenPbr::coat_darkening}};

/// Ranges of the specification; indices and lengths have no upper end, but for what is sensible.
void validate(const OpenPbr& surface) {
    for (const OpenPbrParameter& one : kParameters) {
        const std::string_view name = one.name;
        const bool index = name.ends_with("_ior");
        const double low = name.ends_with("anisotropy") ? -1.0 : index ? 0.1 : 0.0;
        const double high = index                                                      ? 10.0
                            : name == "specular_weight" || name == "subsurface_radius" ? 1e9
                                                                                       : 1.0;
        for (std::size_t c = 0; c < (one.number != nullptr ? 1 : 3); ++c) {
            const double value =
                one.number != nullptr ? surface.*one.number : (surface.*one.colour)[c];
            if (value >= low && value <= high) continue;
            throw UsageError(
                fmt::format("OpenPBR's {} is {}; allowed: {} to {}", name, value, low, high));
        }
    }
}

using ColourMatrix = std::array<Colour3, 3>;

Colour3 transformed(const ColourMatrix& matrix, const Colour3& colour) {
    Colour3 result{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < 3; ++c) result[i] += matrix[i][c] * colour[c];
    }
    return result;
}

class SurfaceAsFile : public BrdfFile {
  public:
    SurfaceAsFile(const OpenPbr& surface, bool acescg) : surface_(surface), acescg_(acescg) {}

    std::string format() const override { return "mtlx"; }
    std::string description() const override {
        return fmt::format("OpenPBR surface, colours in {}", acescg_ ? "ACEScg" : "linear sRGB");
    }
    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return no_wavelengths_; }

  protected:
    void look_up(const Direction& direction, std::span<double> values) const override {
        const Colour3 own = surface_.evaluate(direction);
        const Colour3 colour = acescg_ ? from_acescg(own) : own;
        std::copy(colour.begin(), colour.end(), values.begin());
    }

  private:
    OpenPbrSurface surface_;
    bool acescg_;
    std::vector<std::string> channels_ = {"R", "G", "B"};
    std::vector<double> no_wavelengths_;
};

}  // namespace

std::span<const OpenPbrParameter> openpbr_parameters() { return kParameters; }

DielectricBoundary::DielectricBoundary(double index, double roughness, rte::Shadowing shadowing) {
    if (std::abs(index - 1.0) < kLeastIndex) return;
    const rte::SurfaceOptions options{.beckmann_alpha = std::max(square(roughness), kLeastAlpha),
                                      .distribution = rte::MicrofacetDistribution::ggx,
                                      .shadowing = shadowing};
    if (roughness > 0.0) lobe_.emplace(index, options);
    constexpr double kTolerance = 1e-3;  // 16 x 16 nodes, which err by 2e-5 (1e-4 for index < 1)
    albedo_.reserve(kNodes + 1);
    albedo_.push_back(1.0);  // at the horizon; rough surfaces come to it within the first node
    for (int i = 1; i <= kNodes; ++i) {
        const double mu = square(double(i) / kNodes);
        albedo_.push_back(rte::directional_reflectance(index, options, mu, kTolerance).value);
    }
    if (roughness > 0.0) albedo_[0] = std::clamp(2.0 * albedo_[1] - albedo_[2], 0.0, 1.0);
    for (int i = 0; i <= kNodes; ++i) {  // Simpson's rule for 2 E mu dmu = 4 E t^3 dt
        const double t = double(i) / kNodes;
        const double weight = i == 0 || i == kNodes ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        mean_ += weight / (3.0 * kNodes) * 4.0 * t * t * t * albedo_[std::size_t(i)];
    }
}

double DielectricBoundary::lobe(const Direction& d) const {
    return lobe_ ? lobe_->brdf(d.mu_in, d.mu_out, d.azimuth_deg) : 0.0;
}

double DielectricBoundary::albedo(double mu) const {
    if (albedo_.empty()) return 0.0;
    const double t = std::sqrt(mu) * kNodes;
    const int first = std::clamp(int(t) - 1, 0, kNodes - 3);
    double sum = 0.0;
    for (int i = first; i < first + 4; ++i) {  // Lagrange through the four nearest nodes
        double term = albedo_[std::size_t(i)];
        for (int j = first; j < first + 4; ++j) term *= j == i ? 1.0 : (t - j) / double(i - j);
        sum += term;
    }
    return std::clamp(sum, 0.0, 1.0);
}

OpenPbrSurface::OpenPbrSurface(const OpenPbr& surface, KnownBoundaries* known,
                               rte::Shadowing shadowing)
    : of_(surface) {
    validate(surface);
    const double below = of_.specular_ior / of_.coat_ior;
    const double seen = below > 1.0 ? below : 1.0 / below;  // [specular_ior_ratio_with_tir_fix]
    base_index_ = weakened(lerp(of_.specular_ior, seen, of_.coat_weight), of_.specular_weight);
    const double rough = square(square(of_.specular_roughness));
    const double roughened =
        std::pow(std::min(1.0, rough + 2.0 * square(square(of_.coat_roughness))), 0.25);
    base_roughness_ = lerp(of_.specular_roughness, roughened, of_.coat_weight);
    specular_ = boundary_of(base_index_, base_roughness_, known, shadowing);
    if (of_.coat_weight > 0.0)
        coat_ = boundary_of(of_.coat_ior, of_.coat_roughness, known, shadowing);
}

/// The glossy-diffuse slab, reciprocal form, and the diffuse limit of subsurface scattering.
Colour3 OpenPbrSurface::base(const Direction& d) const {
    const double through = (1.0 - specular_->albedo(d.mu_in)) *
                           (1.0 - specular_->albedo(d.mu_out)) / (1.0 - specular_->mean_albedo());
    const double lobe = specular_->lobe(d);
    const RoughDiffuse rough(of_.base_diffuse_roughness, d);
    Colour3 sum{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double diffuse = of_.base_weight * rough.of(of_.base_color[c]);
        sum[c] =
            lobe + through * lerp(diffuse, of_.subsurface_color[c] / pi, of_.subsurface_weight);
    }
    return sum;
}

Colour3 OpenPbrSurface::evaluate(const Direction& d) const {
    Colour3 sum = base(d);
    if (!coat_) return sum;
    const double presence = of_.coat_weight, n = of_.coat_ior;
    const auto path = [n](double mu) { return 1.0 / std::sqrt(1.0 - (1.0 - mu * mu) / (n * n)); };
    // [general_darkening_formula] with K by [internal_diffuse_reflection_coefficient_...].
    const double specular = fresnel_at_normal(base_index_);
    const double rough = lerp(1.0, base_roughness_, specular);
    const DielectricBoundary& smooth =
        *coat_;  // its mean albedo stands for that of Fresnel's factor
    const double internal =
        lerp(smooth.albedo(d.mu_out), 1.0 - (1.0 - smooth.mean_albedo()) / (n * n), rough);
    for (std::size_t c = 0; c < 3; ++c) {
        const double diffuse = lerp(of_.base_weight * of_.base_color[c], of_.subsurface_color[c],
                                    of_.subsurface_weight);
        const double albedo = lerp(diffuse, 1.0, specular);
        const double darkening =
            lerp(1.0, (1.0 - internal) / (1.0 - albedo * internal), presence * of_.coat_darkening);
        const auto passage = [&](double mu) {
            return lerp(1.0, std::pow(of_.coat_color[c], 0.5 * path(mu)), presence);
        };
        sum[c] = presence * coat_->lobe(d) + (1.0 - presence * coat_->albedo(d.mu_out)) *
                                                 passage(d.mu_in) * passage(d.mu_out) * darkening *
                                                 sum[c];
    }
    return sum;
}

std::vector<Colour3> openpbr_brdf(const OpenPbr& surface, std::span<const Direction> directions) {
    const OpenPbrSurface evaluated(surface);
    std::vector<Direction> storage;
    std::vector<Colour3> result;
    result.reserve(directions.size());
    for (const Direction& direction : require_valid(directions, 3 * directions.size(), 3, storage))
        result.push_back(evaluated.evaluate(direction));
    return result;
}

// Primaries AP1 and the white of ACES (SMPTE ST 2065-1; Academy S-2014-004), Bradford's adaptation
// from D65: the matrices of MaterialX 1.39 (cmlib) to their twelve digits.
Colour3 from_acescg(const Colour3& acescg) {
    return transformed({{{1.705050992658, -0.621792120657, -0.083258872001},
                         {-0.130256417507, 1.140804736575, -0.010548319068},
                         {-0.024003356805, -0.128968976065, 1.15297233287}}},
                       acescg);
}

Colour3 to_acescg(const Colour3& srgb) {
    return transformed({{{0.613097402, 0.339523146, 0.047379451},
                         {0.070193722, 0.916353879, 0.013452399},
                         {0.020615593, 0.109569773, 0.869814634}}},
                       srgb);
}

std::unique_ptr<BrdfFile> openpbr_file(const OpenPbr& surface, const std::string& colour_space) {
    return std::make_unique<SurfaceAsFile>(surface, colour_space == "acescg");
}

}  // namespace miebrdf
