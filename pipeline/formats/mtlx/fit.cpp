// The OpenPBR surface nearest to a BRDF.
#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "pipeline/formats/check/check.h"
#include "pipeline/formats/common/export_job.h"
#include "pipeline/formats/common/finite_source.h"
#include "pipeline/formats/common/least_squares.h"
#include "pipeline/formats/mtlx/openpbr.h"

namespace miebrdf {
namespace {

/// Directions of one kind, and how much they count.
struct FittedRegion {
    double weight;
    std::vector<Direction> directions;
};

/// Seeds differ from those of the comparison that is printed (measure_deviation).
std::vector<FittedRegion> fitted_regions() {
    constexpr std::size_t kCount = 80;
    std::vector<Direction> steep, grazing, any = random_directions(4 * kCount, 11);
    for (const Direction& d : any) {
        const double least = std::min(d.mu_in, d.mu_out);
        if (least > 0.2) steep.push_back(d);
        if (least <= 0.2 && least > 0.05) grazing.push_back(d);
    }
    return {{1.0, std::move(steep)},
            {1.0, lobe_directions(kCount, 12)},
            {1.0, zenith_directions(kCount, 13)},
            {0.25, std::move(grazing)},
            {0.25, retro_directions(kCount, 14)}};
}

constexpr double kFloor = 0.1;         // of a region's mean: smaller values count as that
constexpr double kWorthALobe = 0.5;    // of the sum of squares: a lobe is up to six more numbers
constexpr double kNearEnough = 0.005;  // rms: renderers differ by more

/// Those of fitted_regions, in words.
constexpr char kWeights[] =
    "squares of errors, each over the value plus a tenth of its region's mean; weights: mu > 0.2 "
    "1, near mirror 1, zenith 1, mu 0.05-0.2 0.25, retro-reflection 0.25";

/// One number of the surface that is sought, and its bounds.
struct Unknown {
    std::function<double&(OpenPbr&)> of;
    double low = 0.0, high = 1.0;
};

Unknown unknown_number(double OpenPbr::*member, double low = 0.0, double high = 1.0) {
    return {[member](OpenPbr& s) -> double& { return s.*member; }, low, high};
}

std::vector<Unknown> unknown_colour(Colour3 OpenPbr::*member) {
    std::vector<Unknown> unknowns;
    unknowns.reserve(3);
    for (std::size_t c = 0; c < 3; ++c)
        unknowns.push_back({[member, c](OpenPbr& s) -> double& { return (s.*member)[c]; }});
    return unknowns;
}

/// Tries surfaces against the BRDF.
class Search {
  public:
    Search(const BrdfSource& truth, bool acescg, const Control& control)
        : regions_(fitted_regions()), control_(control) {
        for (const FittedRegion& region : regions_) {
            std::vector<double> values(3 * region.directions.size());
            truth.evaluate(region.directions, values);
            for (std::size_t d = 0; acescg && d < values.size(); d += 3) {
                const Colour3 own = to_acescg({values[d], values[d + 1], values[d + 2]});
                std::copy(own.begin(), own.end(), values.begin() + std::ptrdiff_t(d));
            }
            double mean = 0.0;
            for (const double value : values) mean += std::abs(value) / double(values.size());
            const double least = std::max(kFloor * mean, 1e-9);  // of a black ground
            for (const double value : values)
                scale_.push_back(std::sqrt(region.weight / double(values.size())) /
                                 (std::abs(value) + least));
            truth_.insert(truth_.end(), values.begin(), values.end());
        }
    }

    Eigen::VectorXd residuals(const OpenPbr& surface) {
        const OpenPbrSurface evaluated(surface, &known_);
        Eigen::VectorXd result(Eigen::Index(truth_.size()));
        Eigen::Index i = 0;
        for (const FittedRegion& region : regions_) {
            for (const Direction& direction : region.directions) {
                for (const double value : evaluated.evaluate(direction)) {
                    result[i] = scale_[std::size_t(i)] * (value - truth_[std::size_t(i)]);
                    ++i;
                }
            }
        }
        return result;
    }

    /// Improves a surface by what may change of it; the sum of squares that is left.
    double improve(OpenPbr& surface, const std::vector<Unknown>& unknowns, int steps) {
        const auto with = [&](const std::vector<double>& numbers) {
            OpenPbr moved = surface;
            for (std::size_t u = 0; u < unknowns.size(); ++u) unknowns[u].of(moved) = numbers[u];
            return moved;
        };
        // The difference is large against the error of tabulated albedos (1e-5).
        BoundedSearch search{
            {},
            {},
            [&](const std::vector<double>& numbers) { return residuals(with(numbers)); },
            3e-3,
            1e-5};
        std::vector<double> numbers;
        for (const Unknown& unknown : unknowns) {
            search.low.push_back(unknown.low);
            search.high.push_back(unknown.high);
            numbers.push_back(unknown.of(surface));
        }
        const double left = miebrdf::improve(search, numbers, steps, control_);
        surface = with(numbers);
        return left;
    }

  private:
    std::vector<FittedRegion> regions_;
    const Control& control_;
    std::vector<double> truth_, scale_;
    KnownBoundaries known_;
};

std::vector<Unknown> operator+(std::vector<Unknown> a, const std::vector<Unknown>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

}  // namespace

OpenPbrFit search_openpbr(const BrdfSource& truth, bool acescg, const Control& control) {
    constexpr double kLeastRoughness = 0.05, kLeastIndex = 1.02, kLargestIndex = 3.0;
    Search search(truth, acescg, control);
    OpenPbrFit fit;
    fit.colour_space = acescg ? "acescg" : "lin_rec709";
    fit.weights = kWeights;
    const std::vector<Unknown> diffuse =
        unknown_colour(&OpenPbr::base_color) +
        std::vector<Unknown>{unknown_number(&OpenPbr::base_diffuse_roughness)};
    OpenPbr& best = fit.surface;
    const double mirror = truth.provenance().mirror_index;
    best.specular_weight = mirror > 0.0 ? 1.0 : 0.0;
    best.specular_roughness = 0.0;
    if (mirror > 0.0) best.specular_ior = mirror;
    best.base_color = {0.5, 0.5, 0.5};
    best.base_diffuse_roughness = 0.3;
    constexpr int kSteps = 60, kStepsOfStarts = 5;
    double least = search.improve(best, diffuse, kSteps);
    const auto try_lobe = [&](const OpenPbr& start, const std::vector<Unknown>& unknowns,
                              double OpenPbr::*roughness) {
        if (least <= kNearEnough * kNearEnough) return;
        std::vector<std::pair<double, OpenPbr>> tried;  // what is left after some steps
        constexpr double kStarts[] = {0.1, 0.2, 0.35, 0.5, 0.7, 0.95};
        tried.reserve(std::size(kStarts));
        for (const double rough : kStarts) {
            tried.emplace_back(0.0, start);
            tried.back().second.*roughness = rough;
            tried.back().first = search.improve(tried.back().second, unknowns, kStepsOfStarts);
        }
        const auto is_nearer = [](const auto& a, const auto& b) { return a.first < b.first; };
        std::sort(tried.begin(), tried.end(), is_nearer);
        tried.resize(2);
        for (auto& [left, surface] : tried) left = search.improve(surface, unknowns, kSteps);
        const auto& [reached, found] = *std::min_element(tried.begin(), tried.end(), is_nearer);
        if (!(reached < kWorthALobe * least)) return;
        best = found;
        least = reached;
    };
    if (mirror > 0.0) return fit;  // below a rough coat it would be blurred
    std::vector<Unknown> specular = {
        unknown_number(&OpenPbr::specular_roughness, kLeastRoughness),
        unknown_number(&OpenPbr::specular_ior, kLeastIndex, kLargestIndex)};
    OpenPbr start = best;
    start.specular_weight = 1.0;
    try_lobe(start, diffuse + specular, &OpenPbr::specular_roughness);
    OpenPbr coated = best;
    coated.coat_weight = 0.5;
    coated.coat_ior = 1.5;
    if (best.specular_weight == 0.0) specular.clear();
    const std::vector<Unknown> coat = {
        unknown_number(&OpenPbr::coat_weight),
        unknown_number(&OpenPbr::coat_roughness, kLeastRoughness),
        unknown_number(&OpenPbr::coat_ior, kLeastIndex, kLargestIndex)};
    try_lobe(coated, diffuse + specular + coat + unknown_colour(&OpenPbr::coat_color),
             &OpenPbr::coat_roughness);
    if (best.specular_weight == 0.0) best.specular_roughness = OpenPbr{}.specular_roughness;
    return fit;
}

OpenPbrFit fit_openpbr(const BrdfSource& given, const ExportOptions& options,
                       const Control& control) {
    const ExportOptions ready = ready_options(find_format("mtlx"), options);
    const bool wanted = ready.extra.at("subsurface") != 0;
    if (wanted && !ready.subsurface)
        throw UsageError(
            "subsurface scattering needs a medium whose mean free path is known: give amounts "
            "(volume=15%, number=...), or layers with a thickness");
    const FiniteSource source(given);
    const RgbSource rgb(source, colours_of(find_format("mtlx"), ready, source));
    const bool acescg = ready.extra.at("acescg") != 0;
    OpenPbrFit fit = search_openpbr(rgb, acescg, control);
    fit.colour = rgb.weights().description;
    OpenPbr& surface = fit.surface;
    surface.subsurface_color = surface.base_color;
    if (ready.subsurface) {
        const std::vector<double>& path = ready.subsurface->mean_free_path_um;
        if (path.size() != source.wavelength_nm().size())
            throw UsageError(fmt::format("{} mean free paths for {} wavelengths", path.size(),
                                         source.wavelength_nm().size()));
        Colour3 mm{};
        for (std::size_t w = 0; w < path.size(); ++w) {
            for (std::size_t c = 0; c < 3; ++c)
                mm[c] += 1e-3 * path[w] * rgb.weights().weight[w][c];
        }
        const double largest = std::max({mm[0], mm[1], mm[2], 1e-9});
        surface.subsurface_radius = largest;
        for (std::size_t c = 0; c < 3; ++c)
            surface.subsurface_radius_scale[c] = std::clamp(mm[c] / largest, 0.0, 1.0);
        surface.subsurface_scatter_anisotropy = ready.subsurface->asymmetry;
        if (wanted) surface.subsurface_weight = 1.0;
    }
    fit.deviation = measure_deviation(*openpbr_file(surface, fit.colour_space), rgb,
                                      random_directions(1500, 99));
    return fit;
}

}  // namespace miebrdf
