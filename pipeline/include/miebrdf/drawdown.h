// Drawdowns: a film over a dark and a light ground, as paint is judged.
#pragma once

#include <miebrdf/brdf.h>
#include <miebrdf/colour.h>

#include <optional>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf {

/// The charts of ASTM D2805 have at most .01 on black and at least .78 on white; its calculations
/// take .80.
inline constexpr double kWhiteChartAlbedo = 0.8;

struct DrawdownOptions {
    Substrate dark = {.kind = Substrate::Kind::black};
    Substrate light = {.kind = Substrate::Kind::lambertian, .albedo = {kWhiteChartAlbedo}};
    double hiding_contrast_ratio =
        0.98;              ///< that counts as complete hiding (ASTM D2805), in (0, 1)
    Viewing viewing = {};  ///< Y is of this illuminant and observer
};

/// How well the film hides the grounds, in one light.
struct Hiding {
    double y_over_dark = 0.0, y_over_light = 0.0;  ///< CIE Y, 1 of a white
    double contrast_ratio = 0.0;  ///< Y over the dark ground / Y over the light one
    /// Depth of all layers, as a multiple of the scene's, that hides completely; empty: none
    /// between 1e-4 and 1e4.
    std::optional<double> relative_depth;
    /// The same in um where the scene's layers are thicknesses, and what one litre of dry film
    /// covers at it, m2.
    std::optional<double> thickness_um, spreading_rate_m2_per_l;
};

struct Drawdown {
    AlbedoValues over_dark, over_light;
    std::vector<Hiding> hiding;  ///< of light incident at each mu_in, then of uniform light
};

/// Solves a film over both grounds and finds the depth at which it hides them. Single scattering is
/// computed once for all of it; each depth that the search tries costs two albedos of radiative
/// transfer (about ten depths).
///
/// @param scene  its base and substrate do not matter; layers of finite depth
/// @param wavelength_nm  ascending, fit for colours (covers_the_visible)
/// @throws UsageError  as solve() and Brdf::albedo(); for wavelengths that no Y can be told from, a
///         light ground that is not lighter than the dark one, layers that are all of depth 0
Drawdown draw_down(const Scene& scene, const std::vector<double>& wavelength_nm,
                   const std::vector<double>& mu_in, const DrawdownOptions& options = {},
                   const SolverOptions& solver = {}, const Control& control = {});

}  // namespace miebrdf
#pragma GCC visibility pop
