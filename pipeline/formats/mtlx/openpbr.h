// An OpenPBR surface as renderers evaluate it. docs/formats/mtlx.md
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <miebrdf/formats.h>
#include <miebrdf/surface.h>

namespace miebrdf {

using Colour3 = std::array<double, 3>;

/// A dielectric boundary of GGX microfacets: its lobe, and the share of light that it reflects.
class DielectricBoundary {
  public:
    /// @param roughness  alpha = roughness^2; 0: smooth, without a lobe
    DielectricBoundary(double index, double roughness,
                       rte::Shadowing shadowing = rte::Shadowing::smith_correlated);

    double lobe(const Direction& direction) const;
    double albedo(double mu) const;  ///< cubic between nodes of sqrt(mu)
    double mean_albedo() const { return mean_; }

  private:
    std::optional<rte::SurfaceLobe> lobe_;
    std::vector<double> albedo_;  ///< empty: no boundary
    double mean_ = 0.0;
};

/// Boundaries that a search meets again and again.
using KnownBoundaries =
    std::map<std::pair<double, double>, std::shared_ptr<const DielectricBoundary>>;

class OpenPbrSurface {
  public:
    /// @param shadowing  the specification leaves it to renderers
    /// @throws UsageError  for parameters out of range
    explicit OpenPbrSurface(const OpenPbr& surface, KnownBoundaries* known = nullptr,
                            rte::Shadowing shadowing = rte::Shadowing::smith_correlated);

    Colour3 evaluate(const Direction& direction) const;  ///< as openpbr_brdf

  private:
    Colour3 base(const Direction& direction) const;

    OpenPbr of_;
    std::shared_ptr<const DielectricBoundary> specular_, coat_;
    double base_index_ = 1.0, base_roughness_ = 0.0;  ///< as seen from the coat
};

/// A colour of linear sRGB in ACEScg, and back.
Colour3 to_acescg(const Colour3& srgb);
Colour3 from_acescg(const Colour3& acescg);

/// A surface whose colours are of `colour_space` as a file: values in linear sRGB.
std::unique_ptr<BrdfFile> openpbr_file(const OpenPbr& surface, const std::string& colour_space);

/// The search; `deviation` is left empty. @param truth  linear sRGB
OpenPbrFit search_openpbr(const BrdfSource& truth, bool acescg, const Control& control);

}  // namespace miebrdf
