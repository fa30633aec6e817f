#include "pipeline/report/report_data.h"

#include <fmt/format.h>
#include <miebrdf/plan.h>
#include <miebrdf/version.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string_view>

#include "pipeline/report/packed.h"
#include "pipeline/scene/labels.h"
#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/compact_table.h"
#include "pipeline/solve/rules.h"
#include "pipeline/solve/single_scattering.h"

namespace miebrdf::report {
namespace {

using nlohmann::json;

/// A preview: solved once with 12 nodes, tables as coarse as 3e-2 allows.
constexpr int kPreviewNodes = 12;
constexpr CompactOptions kPreviewTable{.tolerance = 1e-2,
                                       .cosines = 13,
                                       .orders = 0,
                                       .angles = 129,
                                       .slants = 9,
                                       .is_measured = false};

/// Nodes of what a uniform sky makes of a scene, and what stands for the horizon there.
constexpr int kSkyCosines = 17;
constexpr double kLeastCosine = 1e-3;

json table_json(const CompactTable& table, PageBytes& bytes) {
    json all = {{"cosines", table.pair_cosines()},
                {"orders", bytes.add(std::span<const int>(table.orders()))},
                {"multiple", bytes.add(table.multiple())},
                {"angles", table.angles()},
                {"slants", table.slants()},
                {"first_q", CompactTable::kFirstQ},
                {"last_q", CompactTable::kLastQ}};
    if (table.angles() > 0) all["once"] = bytes.add(table.single_scattering());
    if (table.in().size() > 0) {
        all["in"] = bytes.add(table.in());
        all["out"] = bytes.add(table.out());
    }
    if (const auto& lobe = table.lobe()) {
        static constexpr const char* kShadowing[] = {"correlated", "separable", "v-cavity"};
        all["lobe"] = {{"ggx", lobe->ggx},
                       {"alpha", lobe->alpha},
                       {"shadowing", kShadowing[int(lobe->shadowing)]},
                       {"masking", bytes.add(std::span<const double>(lobe->masking))},
                       {"fresnel", bytes.add(lobe->fresnel)},
                       {"only_in_pictures", lobe->only_in_pictures}};
        if (lobe->scale.size() > 0) all["lobe"]["scale"] = bytes.add(lobe->scale);
    }
    return all;
}

/// Share of uniform light from the whole sky that leaves towards mu_out, over that of a white
/// Lambertian surface, [wavelength] at the nodes of cosines.
///
/// By reciprocity it is the plane albedo at mu_out. The paper's coupling to a surface is not
/// reciprocal: there the layers' part is integrated over all incidences, and the lobe's, which is
/// reciprocal, is what the surface does not let in.
std::vector<std::vector<double>> sky_reflection(const CompactTable& table, const Brdf& brdf,
                                                const AlbedoValues& albedo) {
    const std::size_t count = table.wavelengths();
    std::vector<double> nodes = half_sine_nodes(std::size_t(kSkyCosines));
    nodes.front() = kLeastCosine;
    const Scene& scene = brdf.scene();
    std::vector<std::vector<double>> sky(count);
    if (!scene.surface || scene.coupling == rte::SurfaceCoupling::reciprocal) {
        // Linear in the cosine, which it is at the horizon, beyond the last of the angles too.
        const std::vector<double>& mu = albedo.mu_in;  // descending
        for (const double at : nodes) {
            const auto after = std::partition_point(mu.begin() + 1, mu.end() - 1,
                                                    [&](double known) { return known >= at; });
            const auto k = std::size_t(after - mu.begin());
            const double share = (mu[k - 1] - at) / (mu[k - 1] - mu[k]);
            for (std::size_t w = 0; w < count; ++w) {
                const std::vector<double>& plane = albedo.plane_albedo[w];
                sky[w].push_back((1.0 - share) * plane[k - 1] + share * plane[k]);
            }
        }
        return sky;
    }
    // Midpoint rules in angles: smooth, and 0 at both ends by the cosine and the sine.
    constexpr int kZeniths = 24, kAzimuths = 16;
    std::vector<double> values(count);
    for (const double mu_out : nodes) {
        std::vector<double> row(count, 0.0);
        for (int z = 0; z < kZeniths; ++z) {
            const double theta = 0.5 * std::numbers::pi * (z + 0.5) / kZeniths;
            const double weight = 0.5 * std::numbers::pi / kZeniths * std::sin(theta) *
                                  std::cos(theta) * 2.0 * std::numbers::pi / kAzimuths;
            for (int a = 0; a < kAzimuths; ++a) {
                const double azimuth = std::numbers::pi * (a + 0.5) / kAzimuths;
                table.evaluate_layers(std::cos(theta), mu_out, std::cos(azimuth), values);
                for (std::size_t w = 0; w < count; ++w) row[w] += weight * values[w];
            }
        }
        for (std::size_t w = 0; w < count; ++w)
            sky[w].push_back(row[w] + 1.0 - table.let_in(w, mu_out));
    }
    return sky;
}

json albedo_json(const AlbedoValues& albedo, PageBytes& bytes) {
    json all = {{"plane", bytes.add(albedo.plane_albedo)},
                {"spherical", bytes.add(std::span<const double>(albedo.spherical_albedo))}};
    if (!albedo.mirror_reflectance.empty()) all["mirror"] = bytes.add(albedo.mirror_reflectance);
    if (!albedo.plane_transmittance.empty()) {
        all["plane_through"] = bytes.add(albedo.plane_transmittance);
        all["spherical_through"] =
            bytes.add(std::span<const double>(albedo.spherical_transmittance));
    }
    return all;
}

/// Finer where the forward peak and the glory are.
std::vector<double> phase_angles_deg() {
    std::vector<double> angles;
    for (int i = 0; i <= 20; ++i) angles.push_back(0.1 * i);
    for (int i = 1; i <= 16; ++i) angles.push_back(2.0 + 0.5 * i);
    for (int i = 11; i <= 170; ++i) angles.push_back(i);
    for (int i = 1; i <= 20; ++i) angles.push_back(170.0 + 0.5 * i);
    return angles;
}

/// The name that LayerOptics has for the medium.
std::string place_of(const Scene& scene, std::size_t medium) {
    if (medium == 0) return "base";
    std::size_t place = 0;
    for (std::size_t c = 0; c < scene.layers.size(); ++c) {
        if (is_left_out(scene, scene.layers[c])) continue;
        if (++place == medium) return "coat " + std::to_string(c + 1);
    }
    return "layer";
}

json media_json(const Brdf& brdf, const std::vector<double>& angles_deg, const Control& control,
                ReportData& data) {
    PageBytes& bytes = data.bytes;
    const ResolvedScene& scene = BrdfState::of(brdf).resolved;
    std::vector<std::size_t> media;  // that scatter or absorb
    for (std::size_t m = scene.first_medium(); m < scene.media.size(); ++m) {
        if (m == 0 || !scene.depths[m - 1].is_empty()) media.push_back(m);
    }
    // As the table has asked for them: nothing is averaged again.
    OpticsDemand demand = demand_of(brdf.options(), scene.particles.tolerance, PhaseDemand::whole);
    demand.whole_phase_function = true;
    const auto optics = optics_of(scene, media, all_wavelengths(scene), demand, control);
    const std::vector<LayerOptics> layers = brdf.layers();
    json all = json::array();
    for (std::size_t m = 0; m < media.size(); ++m) {
        const ResolvedMedium& medium = scene.media[media[m]];
        std::vector<double> albedo, asymmetry;
        std::vector<int> log_phase;  // thousandths
        for (std::size_t w = 0; w < scene.wavelength_nm.size(); ++w) {
            const MediumOptics& at = optics[w][m];
            if (!at.converged) {
                data.shortfalls.push_back(fmt::format(
                    "{} nm: single scattering that is shown of {} misses {}",
                    scene.wavelength_nm[w], place_of(brdf.scene(), media[m]), demand.tolerance));
            }
            albedo.push_back(at.optics.single_scattering_albedo);
            asymmetry.push_back(at.asymmetry);
            for (const double p : phase_at(at.optics, angles_deg))
                log_phase.push_back(int(std::lround(1e3 * std::log10(std::max(p, 1e-30)))));
        }
        const std::string place = place_of(brdf.scene(), media[m]);
        json one = {{"place", place},
                    {"name", miebrdf::label_of(medium.medium)},
                    {"albedo", bytes.add(std::span<const double>(albedo))},
                    {"asymmetry", bytes.add(std::span<const double>(asymmetry))},
                    {"log_phase", bytes.add(std::span<const int>(log_phase))},
                    {"species", json::array()}};
        for (const ResolvedSpecies& species : medium.species) {
            if (!species.needs_mie()) continue;
            std::vector<double> n, k;
            for (const Particles& particles : species.particles) {
                n.push_back(particles.index.real());
                k.push_back(particles.index.imag());
            }
            one["species"].push_back({{"name", miebrdf::label_of(Medium(species.species))},
                                      {"n", bytes.add(std::span<const double>(n))},
                                      {"k", bytes.add(std::span<const double>(k))}});
        }
        std::vector<double> depth;
        for (const LayerOptics& layer : layers) {
            if (layer.layer == place) depth.push_back(layer.optical_depth);
        }
        if (std::all_of(depth.begin(), depth.end(), [](double d) { return std::isfinite(d); }))
            one["depth"] = bytes.add(std::span<const double>(depth));
        all.push_back(std::move(one));
    }
    return all;
}

/// The work that is left out of a scene; a table of some directions leaves out more, and results of
/// earlier runs do not count.
json omissions_json(const Plan& plan) {
    static constexpr std::string_view kOfRequests[] = {"listed directions", "same direction",
                                                       "reciprocity", "no colour", "in the cache"};
    json all = json::array();
    for (const Omission& omission : plan.omissions) {
        if (std::find(std::begin(kOfRequests), std::end(kOfRequests), omission.rule) ==
            std::end(kOfRequests))
            all.push_back({{"rule", omission.rule}, {"reason", omission.reason}});
    }
    return all;
}

}  // namespace

const std::vector<double>& albedo_angles_deg() {
    static const std::vector<double> angles = [] {
        std::vector<double> list(90);
        std::iota(list.begin(), list.end(), 0.0);
        return list;
    }();
    return angles;
}

ReportData collect(const std::vector<ReportScene>& scenes, const Control& control,
                   PageDetail detail) {
    const bool is_preview = detail == PageDetail::preview;
    ReportData data;
    std::vector<double> mu;
    for (const double angle : albedo_angles_deg())
        mu.push_back(std::cos(angle * std::numbers::pi / 180.0));
    const std::vector<double> phase_angles = phase_angles_deg();
    json all = json::array();
    for (const ReportScene& scene : scenes) {
        json variants = json::array();
        for (const Variant& variant : scene.variants) {
            BrdfState state = BrdfState::of(variant.brdf);
            if (is_preview) state.unchecked_nodes = kPreviewNodes;
            const Brdf brdf = BrdfState::brdf_with(std::move(state));
            // A page shows what `brdf` gives: the paper's coupling where the scene says nothing.
            const BrdfTable solved = brdf.table(
                {.coupling = brdf.scene().coupling.value_or(rte::SurfaceCoupling::paper)});
            const CompactTable table(
                {&solved, 1},
                is_preview ? kPreviewTable : CompactOptions{.tolerance = kPageTolerance}, control);
            const AlbedoValues albedo = brdf.albedo(mu);
            const bool converged = solved.report().converged() && albedo.converged();
            for (const auto& lines : {solved.report().shortfalls(), albedo.shortfalls()})
                data.shortfalls.insert(data.shortfalls.end(), lines.begin(), lines.end());
            data.interpolation_error =
                std::max(data.interpolation_error, table.interpolation_error());
            json one = {{"label", variant.label},
                        {"value", variant.value},
                        {"converged", converged},
                        {"error_estimate", solved.report().error_estimate()},
                        {"interpolation_error", table.interpolation_error()},
                        {"table", table_json(table, data.bytes)},
                        {"albedo", albedo_json(albedo, data.bytes)},
                        {"sky", data.bytes.add(sky_reflection(table, brdf, albedo))}};
            if (!is_preview) {
                one["facts"] = variant.facts ? variant.facts(solved.report()) : Facts{};
                one["omissions"] =
                    omissions_json(plan_evaluate(brdf, {{0.2, 0.5, 1.0}, {0.1, 0.6}, {0.0, 90.0}}));
                one["media"] = media_json(brdf, phase_angles, control, data);
            }
            variants.push_back(std::move(one));
        }
        const std::vector<double>& wavelength_nm = scene.variants.front().brdf.wavelength_nm();
        all.push_back({{"name", scene.name},
                       {"description", scene.description},
                       {"varied", scene.varied},
                       {"wavelength_nm", wavelength_nm},
                       {"illuminants", colour_weights(wavelength_nm)},
                       {"variants", std::move(variants)}});
    }
    data.root = {{"version", std::string("miebrdf ") + kVersion},
                 {"scenes", std::move(all)},
                 {"albedo_angles_deg", albedo_angles_deg()},
                 {"phase_angles_deg", phase_angles}};
    return data;
}

}  // namespace miebrdf::report
