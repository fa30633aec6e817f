#include <miebrdf/colour.h>
#include <miebrdf/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace miebrdf {
namespace {

constexpr double kLeastScale = 1e-4, kLargestScale = 1e4;
/// The precision of the depth that hides; the albedos themselves are not better known.
constexpr double kScaleTolerance = 1e-4;

double mean_albedo(const Substrate& ground) {
    if (ground.kind != Substrate::Kind::lambertian) return 0.0;
    return std::accumulate(ground.albedo.begin(), ground.albedo.end(), 0.0) /
           double(ground.albedo.size());
}

/// A film whose depth may be scaled.
class Film {
  public:
    Film(const Scene& scene, const std::vector<double>& wavelength_nm,
         const std::vector<double>& mu_in, const DrawdownOptions& options,
         const SolverOptions& solver, Control control)
        : scene_(scene),
          wavelength_nm_(wavelength_nm),
          mu_in_(mu_in),
          options_(options),
          solver_(solver),
          control_(std::move(control)),
          weights_(observer_weights(wavelength_nm, options.viewing, Between::cubic)) {
        if (control_.memo == nullptr) control_.memo = make_optics_memo();
    }

    AlbedoValues albedo(const Substrate& ground, double scale) const {
        Scene scene = scene_;
        scene.substrate = ground;
        for (Layer& layer : scene.layers) layer.depth.value *= scale;
        return solve(scene, wavelength_nm_, solver_, control_).albedo(mu_in_);
    }

    /// CIE Y of light incident at each mu_in, then of uniform light.
    std::vector<double> luminances(const AlbedoValues& values) const {
        std::vector<double> all;
        for (std::size_t i = 0; i <= mu_in_.size(); ++i) {
            std::vector<double> spectrum;
            for (std::size_t w = 0; w < wavelength_nm_.size(); ++w) {
                spectrum.push_back(i < mu_in_.size() ? values.plane_albedo[w][i]
                                                     : values.spherical_albedo[w]);
            }
            all.push_back(to_xyz(weights_, spectrum).y);
        }
        return all;
    }

    /// Contrast ratios at a depth, one for each light.
    const std::vector<double>& ratios(double scale) {
        const auto found = known_.find(scale);
        if (found != known_.end()) return found->second;
        return remember(scale, luminances(albedo(options_.dark, scale)),
                        luminances(albedo(options_.light, scale)));
    }

    const std::vector<double>& remember(double scale, const std::vector<double>& over_dark,
                                        const std::vector<double>& over_light) {
        std::vector<double>& all = known_[scale];
        // Less than this is rounding: nothing comes back from the light ground, so far.
        constexpr double kLeastLuminance = 1e-9;
        for (std::size_t i = 0; i < over_dark.size(); ++i) {
            all.push_back(over_light[i] > kLeastLuminance ? over_dark[i] / over_light[i] : 0.0);
        }
        return all;
    }

    /// The scale at which a light's contrast is the wanted one: bracketed from known depths on by
    /// factors of two, then by false position (Illinois) over ln(scale).
    std::optional<double> hiding_scale(std::size_t light) {
        double low = 0.0, high = 0.0;
        for (const auto& [scale, contrasts] : known_) {
            if (!(excess(contrasts[light]) > 0.0)) low = scale;
            if (high == 0.0 && excess(contrasts[light]) > 0.0) high = scale;
        }
        if (low == 0.0) low = high;
        while (excess(ratios(low)[light]) > 0.0) {
            low *= 0.5;
            if (low < kLeastScale) return std::nullopt;
        }
        if (high == 0.0) high = low;
        while (!(excess(ratios(high)[light]) > 0.0)) {
            high *= 2.0;
            if (high > kLargestScale) return std::nullopt;
        }
        double a = std::log(low), b = std::log(high);
        double at_a = excess(ratios(low)[light]), at_b = excess(ratios(high)[light]);
        constexpr int kMostSteps = 60;
        for (int step = 0; step < kMostSteps && b - a > kScaleTolerance; ++step) {
            const double next = (a * at_b - b * at_a) / (at_b - at_a);
            const double at_next = excess(ratios(std::exp(next))[light]);
            if (std::abs(at_next) <= 0.1 * kScaleTolerance) return std::exp(next);
            if (at_next > 0.0) {
                b = next;
                at_b = at_next;
                at_a *= 0.5;
            } else {
                a = next;
                at_a = at_next;
                at_b *= 0.5;
            }
        }
        return std::exp(0.5 * (a + b));
    }

  private:
    /// Above 0 where the film hides, in decades of what is missing: nearly straight over
    /// ln(depth).
    double excess(double contrast_ratio) const {
        constexpr double kLeast = 1e-12;  // rounding
        return std::log((1.0 - options_.hiding_contrast_ratio) /
                        std::max(kLeast, 1.0 - contrast_ratio));
    }

    const Scene& scene_;
    const std::vector<double>& wavelength_nm_;
    const std::vector<double>& mu_in_;
    const DrawdownOptions& options_;
    SolverOptions solver_;
    Control control_;
    ObserverWeights weights_;
    std::map<double, std::vector<double>> known_;  ///< contrast ratios by scale
};

/// The thickness of all layers together, where each says one.
std::optional<double> thickness_um(const Scene& scene) {
    double sum = 0.0;
    for (const Layer& layer : scene.layers) {
        if (layer.depth.kind != Depth::Kind::thickness_um) return std::nullopt;
        sum += layer.depth.value;
    }
    return sum;
}

void check(const Scene& scene, const std::vector<double>& wavelength_nm,
           const DrawdownOptions& options) {
    if (!covers_the_visible(wavelength_nm)) {
        throw UsageError(
            "a contrast ratio needs at least eight wavelengths, from 430 nm or less to 650 nm or "
            "more, e.g. every 10 nm from 400 to 700");
    }
    const double ratio = options.hiding_contrast_ratio;
    if (!(ratio >= 0.0 && ratio < 1.0)) throw UsageError("hiding_contrast_ratio", ratio, "[0, 1)");
    if (!(mean_albedo(options.light) > mean_albedo(options.dark))) {
        throw UsageError(fmt::format(
            "grounds of a drawdown: {} is not lighter than {}; the dark one comes first, e.g. "
            "black and lambert:{}",
            describe(options.light), describe(options.dark), kWhiteChartAlbedo));
    }
    double depth = 0.0;
    for (const Layer& layer : scene.layers) depth += layer.depth.value;
    if (!(depth > 0.0)) throw UsageError("a drawdown needs a layer of some depth");
}

}  // namespace

Drawdown draw_down(const Scene& scene, const std::vector<double>& wavelength_nm,
                   const std::vector<double>& mu_in, const DrawdownOptions& options,
                   const SolverOptions& solver, const Control& control) {
    check(scene, wavelength_nm, options);
    Film film(scene, wavelength_nm, mu_in, options, solver, control);
    Drawdown result{film.albedo(options.dark, 1.0), film.albedo(options.light, 1.0), {}};
    const std::vector<double> dark = film.luminances(result.over_dark);
    const std::vector<double> light = film.luminances(result.over_light);
    film.remember(1.0, dark, light);
    const std::optional<double> thickness = thickness_um(scene);
    for (std::size_t i = 0; i < dark.size(); ++i) {
        Hiding& hiding = result.hiding.emplace_back();
        hiding.y_over_dark = dark[i];
        hiding.y_over_light = light[i];
        hiding.contrast_ratio = dark[i] / light[i];
        if (options.hiding_contrast_ratio > 0.0) hiding.relative_depth = film.hiding_scale(i);
        if (!thickness || !hiding.relative_depth) continue;
        hiding.thickness_um = *thickness * *hiding.relative_depth;
        hiding.spreading_rate_m2_per_l = 1000.0 / *hiding.thickness_um;
    }
    return result;
}

}  // namespace miebrdf
