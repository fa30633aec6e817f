// Each rule is asked here whether it holds, and the computation is asked whether it obeys.
#include "pipeline/plan/rules.h"

#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "pipeline/plan/plan.h"
#include "pipeline/solve/brdf.h"
#include "pipeline/solve/distinct_directions.h"
#include "pipeline/solve/visible_layers.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

Request request_of(const std::string& base, const std::vector<std::string>& coats = {}) {
    Request request;
    request.scene.base = parse_medium(base);
    for (const std::string& coat : coats) request.scene.coats.push_back(parse_coat(coat));
    request.wavelength_nm = {550};
    request.directions = {{0.3, 1.0}, {0.2, 0.9}, {0.0, 70.0, 180.0}};
    return request;
}

bool brdf_leaves_out(const Request& request, const std::string& rule) {
    return make_plan(request, LayerQuantity::reflection).leaves_out(rule);
}

/// Stages that a computation went through, with the number of jobs in each.
struct Stages {
    std::map<std::string, std::size_t> jobs;
    RunControl control() {
        RunControl control{.threads = 1};
        control.progress = [this](const std::string& stage, std::size_t, std::size_t total) {
            jobs[stage] = total;
        };
        return control;
    }
};

}  // namespace

TEST_CASE("no depth: such a coat is left out, but its surface stays", "[pipeline][rules]") {
    Request request = request_of("index:1.5,0.001", {"index:2.5,0.1@0"});
    request.scene.particles.sizes.effective_radius_um = 1;
    CHECK(has_no_depth(request.scene.coats[0]));
    CHECK_FALSE(has_no_depth({parse_medium("isotropic:1"), 1e-300}));
    CHECK(without_empty_coats(request.scene).coats.empty());
    CHECK(brdf_leaves_out(request, "no depth"));

    Stages stages;
    compute_brdf(request, stages.control());
    CHECK(stages.jobs["single scattering"] == 1);  // the base alone
    request.scene.surface = rte::SurfaceOptions{};
    CHECK(SceneMedia(request).surface_index_at(550) == std::complex<double>(2.5, 0.1));
}

TEST_CASE("hidden layers: their Mie theory is not computed, and the result is the same",
          "[pipeline][rules]") {
    const std::string coat = GENERATE("hg:0.3,0.1", "isotropic:0.9", "isotropic:1");
    Request hidden = request_of("index:1.5,0", {coat + "@60"});
    if (coat == "isotropic:1") {  // hides only what is infinitely far down
        hidden.scene.coats[0].optical_depth = std::numeric_limits<double>::infinity();
    }
    hidden.scene.particles.sizes.effective_radius_um = 1;
    CAPTURE(coat);
    CHECK(brdf_leaves_out(hidden, "hidden layers"));
    Stages stages;
    const auto result = compute_brdf(hidden, stages.control()).slices[0];
    CHECK(stages.jobs["single scattering"] == 1);  // the coat
    // Against the solver given the whole stack: white below.
    const SceneMedia media(hidden);
    const auto optics = media.optics({550}, demand_of(hidden, PhaseDemand::whole), {.threads = 1});
    const auto whole = rte::reflect(optics[0].stack, hidden.directions, hidden.solver).reflection;
    const std::size_t block = 6;  // 2 mu_out x 3 azimuths
    for (std::size_t i = 0; i < whole.size(); ++i) {
        double largest = 0;
        for (std::size_t k = 0; k < block; ++k) {
            largest = std::max(largest, whole[i / block * block + k]);
        }
        CHECK(std::abs(std::numbers::pi * result.subsurface[i] - whole[i]) <=
              2 * hidden.solver.tolerance * largest);
    }
}

TEST_CASE("hidden layers: a coat that lets light through hides nothing", "[pipeline][rules]") {
    const rte::Directions directions{{1.0}, {1.0}, {0.0}};
    CHECK_FALSE(may_hide(0.1, directions, 1e-3));
    CHECK(may_hide(10, directions, 1e-3));
    // Without absorption transmission falls like 1 / depth: 20 is not enough, 1e7 is.
    const rte::Optics white = rte::isotropic_optics(1.0);
    CHECK_FALSE(hides_what_is_below(white, 20, directions, 1e-3));
    CHECK(hides_what_is_below(white, 1e7, directions, 1e-3));
    CHECK(hides_what_is_below(rte::isotropic_optics(0.5), 20, directions, 1e-3));
    CHECK_FALSE(brdf_leaves_out(request_of("isotropic:0.5", {"isotropic:1@5"}), "hidden layers"));
}

TEST_CASE("hidden layers: what is called hidden changes by less than a tenth of the tolerance",
          "[pipeline][rules]") {
    const double albedo = GENERATE(0.2, 0.9, 0.99);
    const double asymmetry = GENERATE(0.0, 0.7);
    const rte::Optics coat = rte::henyey_greenstein_optics(albedo, asymmetry);
    const rte::Directions directions{{0.2, 1.0}, {0.1, 0.5, 1.0}, {0, 90, 180}};
    double depth = 1;
    while (!hides_what_is_below(coat, depth, directions, 1e-3)) depth *= 1.2;
    rte::SolverOptions options;
    options.streams = 24;
    rte::Stack over;  // the worst base: it returns everything, forward into the coat again
    over.base = rte::henyey_greenstein_optics(1.0, 0.5);
    over.coats = {{coat, depth}};
    rte::Stack black = over;
    black.base_kind = rte::BaseKind::none;
    const auto with = rte::reflect(over, directions, options).reflection;
    const auto without = rte::reflect(black, directions, options).reflection;
    CAPTURE(albedo, asymmetry, depth);
    for (std::size_t i = 0; i < 2; ++i) {
        double largest = 0, change = 0;
        for (std::size_t k = i * 9; k < i * 9 + 9; ++k) {
            largest = std::max(largest, with[k]);
            change = std::max(change, std::abs(with[k] - without[k]));
        }
        CHECK(change <= 1e-4 * largest);
    }
}

TEST_CASE("analytic medium: no Mie theory for it", "[pipeline][rules]") {
    CHECK(brdf_leaves_out(request_of("hg:0.9,0.5"), "analytic medium"));
    CHECK_FALSE(brdf_leaves_out(request_of("index:1.5,0"), "analytic medium"));
    // Mie options cannot matter where there is no Mie theory.
    Request other = request_of("hg:0.9,0.5");
    other.scene.particles.sizes.effective_radius_um = 7;
    CHECK(compute_brdf(other).slices[0].total ==
          compute_brdf(request_of("hg:0.9,0.5")).slices[0].total);
}

TEST_CASE("nothing scatters: a black ground takes the place of such layers", "[pipeline][rules]") {
    CHECK(scatters_nothing(parse_medium("hg:0,0.5")));
    CHECK_FALSE(scatters_nothing(parse_medium("isotropic:1e-9")));
    CHECK_FALSE(scatters_nothing(parse_medium("index:1.5,0")));
    CHECK(brdf_leaves_out(request_of("isotropic:0", {"hg:0.9,0.1@1"}), "nothing scatters"));

    rte::Stack stack;
    stack.base = rte::isotropic_optics(0);
    stack.coats = {{rte::isotropic_optics(0), 1.0}, {rte::isotropic_optics(0.5), 1.0}};
    const rte::Stack reduced = with_black_ground(stack);
    CHECK(reduced.base_kind == rte::BaseKind::none);
    REQUIRE(reduced.coats.size() == 1);
    const rte::Directions directions{{0.3}, {0.4}, {0, 90}};
    rte::SolverOptions options;
    options.streams = 16;
    const auto full = rte::reflect(stack, directions, options).reflection;
    const auto less = rte::reflect(reduced, directions, options).reflection;
    // The same equations, one matrix product fewer.
    for (std::size_t i = 0; i < full.size(); ++i) CHECK(std::abs(less[i] / full[i] - 1) <= 1e-10);
    const BrdfResult black = compute_brdf(request_of("isotropic:0"));
    CHECK(black.slices[0].total == std::vector<double>(12, 0.0));
    CHECK(black.converged);
}

TEST_CASE("nothing absorbs: every plane albedo is 1 and nothing is solved", "[pipeline][rules]") {
    Request request = request_of("index:1.5,0", {"hg:1,0.5@2"});
    CHECK(make_plan(request, LayerQuantity::albedo).leaves_out("nothing absorbs"));
    Stages stages;
    const AlbedoResult result = compute_albedo(request, stages.control());
    CHECK(stages.jobs.count("single scattering") == 0);
    CHECK(result.converged);
    for (const double albedo : result.slices[0].plane_albedo) CHECK(albedo == 1.0);
    CHECK(result.slices[0].spherical_albedo == 1.0);
    request.scene.particles.k_floor = 1e-6;  // now the base absorbs
    CHECK_FALSE(make_plan(request, LayerQuantity::albedo).leaves_out("nothing absorbs"));
}

TEST_CASE("few orders: isotropic media need one, Rayleigh three", "[pipeline][rules]") {
    CHECK(most_orders(parse_medium("isotropic:0.5")) == 1);
    CHECK(most_orders(parse_medium("rayleigh:0.5")) == 3);
    CHECK(most_orders(parse_medium("hg:0.5,0.5")) == 0);
    const Request isotropic = request_of("isotropic:0.9", {"isotropic:0.5@1"});
    const Request rayleigh = request_of("isotropic:0.9", {"rayleigh:0.5@1"});
    CHECK(most_orders(isotropic.scene) == 1);
    CHECK(most_orders(rayleigh.scene) == 3);
    CHECK(most_orders(request_of("isotropic:0.9", {"hg:0.5,0.2@1"}).scene) == 0);
    CHECK(brdf_leaves_out(isotropic, "few orders"));
    CHECK(compute_brdf(isotropic).slices[0].report.fourier_orders == 1);
    CHECK(compute_brdf(rayleigh).slices[0].report.fourier_orders <= 3);
}

TEST_CASE("albedo and zenith: order 0 alone", "[pipeline][rules]") {
    Request request = request_of("hg:0.9,0.7");
    CHECK_FALSE(only_zenith(request.directions));
    CHECK(compute_brdf(request).slices[0].report.fourier_orders > 5);
    CHECK(brdf_leaves_out(request, "listed directions"));
    CHECK(make_plan(request, LayerQuantity::albedo).leaves_out("albedo"));
    CHECK(compute_albedo(request).slices[0].report.fourier_orders == 1);
    for (std::vector<double>* cosines : {&request.directions.mu_in, &request.directions.mu_out}) {
        const auto before = *cosines;
        *cosines = {1.0, 1.0};
        CHECK(only_zenith(request.directions));
        CHECK(brdf_leaves_out(request, "zenith"));
        CHECK(compute_brdf(request).slices[0].report.fourier_orders == 1);
        *cosines = before;
    }
}

TEST_CASE("rule across: at 90 and 270 degrees odd orders are left out, and change nothing",
          "[pipeline][rules]") {
    Request request = request_of("hg:0.9,0.7");
    request.directions = {{0.4}, {0.3, 0.8}, {90, 270}};
    CHECK(only_across(request.directions));
    CHECK(brdf_leaves_out(request, "across"));
    const auto even = compute_brdf(request).slices[0].total;
    request.directions.azimuth_deg.push_back(89);
    CHECK_FALSE(only_across(request.directions));
    CHECK_FALSE(brdf_leaves_out(request, "across"));
    const auto all = compute_brdf(request).slices[0].total;
    for (std::size_t o = 0; o < 2; ++o) {
        // Both sums end within a quarter of the tolerance.
        CHECK(std::abs(even[2 * o] / all[3 * o] - 1) <= 0.5 * request.solver.tolerance);
    }
}

TEST_CASE("same spheres: one Mie run for layers and wavelengths that share them",
          "[pipeline][rules]") {
    Request request = request_of("index:1.5,0.01", {"index:1.5,0.01@0.1"});
    request.scene.particles.sizes.effective_radius_um = 1;
    CHECK(brdf_leaves_out(request, "same spheres"));
    CHECK(brdf_leaves_out(request, "one half-space") == false);
    Stages stages;
    compute_brdf(request, stages.control());
    CHECK(stages.jobs["single scattering"] == 1);
}

TEST_CASE("one half-space: several coats on one base solve it once", "[pipeline][rules]") {
    CHECK(brdf_leaves_out(request_of("hg:0.9,0.5", {"hg:0.5,0.1@0.1", "hg:0.7,0.2@0.1"}),
                          "one half-space"));
}

TEST_CASE("same wavelength: media that do not change with it are solved once",
          "[pipeline][rules]") {
    Request request = request_of("hg:0.9,0.5");
    request.wavelength_nm = {450, 550, 650};
    CHECK(brdf_leaves_out(request, "same wavelength"));
    Stages stages;
    const BrdfResult result = compute_brdf(request, stages.control());
    CHECK(stages.jobs["radiative transfer"] == 1);
    REQUIRE(result.slices.size() == 3);
    CHECK(result.slices[2].wavelength_nm == 650);
    CHECK(result.slices[2].total == result.slices[0].total);
    request.scene.base = parse_medium("index:1.5,0.01");
    request.scene.particles.sizes.effective_radius_um = 1;
    CHECK_FALSE(brdf_leaves_out(request, "same wavelength"));
}

TEST_CASE("same direction: repeated and mirrored directions are computed once",
          "[pipeline][rules]") {
    const rte::Directions all{{0.9, 0.3, 0.9}, {0.5, 0.5}, {30, -30, 330, 400, 180, -180}};
    const DistinctDirections distinct(all);
    CHECK(distinct.directions().mu_in == std::vector<double>{0.3, 0.9});
    CHECK(distinct.directions().mu_out == std::vector<double>{0.5});
    CHECK(distinct.directions().azimuth_deg == std::vector<double>{30, 40, 180});
    CHECK(distinct.requested() == 36);
    CHECK(distinct.computed() == 6);
    const auto spread = distinct.spread({1, 2, 3, 4, 5, 6});
    CHECK(std::vector<double>(spread.begin(), spread.begin() + 12) ==
          std::vector<double>{4, 4, 4, 5, 6, 6, 4, 4, 4, 5, 6, 6});
    CHECK(distinct.spread_incident({7, 8}) == std::vector<double>{8, 7, 8});

    Request request = request_of("hg:0.9,0.5");
    const BrdfResult single = compute_brdf(request);
    request.directions.azimuth_deg = {180, 70, -70, 0, 290};
    CHECK(brdf_leaves_out(request, "same direction"));
    const BrdfResult repeated = compute_brdf(request);
    for (std::size_t pair = 0; pair < 4; ++pair) {
        const double* few = &single.slices[0].total[pair * 3];
        const double* many = &repeated.slices[0].total[pair * 5];
        CHECK(std::vector<double>(many, many + 5) ==
              std::vector<double>{few[2], few[1], few[1], few[0], few[1]});
    }
}

TEST_CASE("surface alone: no layers; no surface: no lobe", "[pipeline][rules]") {
    Request request = request_of("index:1.5,0.01");
    request.scene.particles.sizes.effective_radius_um = 1;
    CHECK(brdf_leaves_out(request, "no surface"));
    request.scene.surface = rte::SurfaceOptions{};
    CHECK_FALSE(brdf_leaves_out(request, "no surface"));
    const BrdfResult all = compute_brdf(request);

    request.parts = {.subsurface = false, .surface = true, .total = false};
    CHECK_FALSE(wants_layers(request.parts));
    CHECK(brdf_leaves_out(request, "surface alone"));
    Stages stages;
    const BrdfResult lobe = compute_brdf(request, stages.control());
    CHECK(stages.jobs.size() == 1);  // "surface"
    CHECK(lobe.converged);
    CHECK(lobe.slices[0].surface == all.slices[0].surface);

    request.parts = {.subsurface = true, .surface = false, .total = false};
    CHECK_FALSE(wants_lobe(request.scene, request.parts));
    CHECK(brdf_leaves_out(request, "no surface"));
    const BrdfResult layers = compute_brdf(request);
    CHECK(layers.slices[0].surface.empty());
    CHECK(layers.slices[0].subsurface == all.slices[0].subsurface);
}

TEST_CASE("reciprocity: half of the lobe's table is a mirror of the other", "[pipeline][rules]") {
    Request request = request_of("index:1.5,0.01");
    request.scene.particles.sizes.effective_radius_um = 1;
    request.scene.surface = rte::SurfaceOptions{};
    request.parts = {.subsurface = false, .surface = true, .total = false};
    CHECK_FALSE(is_symmetric(request.directions));
    request.directions = {{0.2, 0.6, 0.9}, {0.9, 0.2, 0.6}, {0, 120}};
    CHECK(brdf_leaves_out(request, "reciprocity"));
    const auto mirrored = compute_brdf(request).slices[0].surface;
    const rte::SurfaceLobe lobe({1.5, 0.01}, *request.scene.surface);
    std::size_t index = 0;
    for (const double mu_in : request.directions.mu_in) {
        for (const double mu_out : request.directions.mu_out) {
            for (const double azimuth : request.directions.azimuth_deg) {
                // Rounding of the lobe's own formula, which is not written symmetrically.
                CHECK(std::abs(mirrored[index++] / lobe.brdf(mu_in, mu_out, azimuth) - 1) <= 1e-12);
            }
        }
    }
}

TEST_CASE("few moments: an albedo asks Mie theory for no phase function", "[pipeline][rules]") {
    const Request request = request_of("index:1.5,0.01");
    CHECK(make_plan(request, LayerQuantity::albedo).leaves_out("few moments"));
    const OpticsDemand demand = demand_of(request, PhaseDemand::moments_only);
    CHECK_FALSE(demand.whole_phase_function);
    CHECK(demand.highest_moment < 200);
    CHECK(demand_of(request, PhaseDemand::whole).whole_phase_function);
}
