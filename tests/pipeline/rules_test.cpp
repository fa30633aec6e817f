// Each rule is asked here whether it holds, and the computation is asked whether it obeys.
#include "pipeline/solve/rules.h"

#include <miebrdf/plan.h>
#include <miebrdf/surface.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/solve/distinct_directions.h"
#include "pipeline/solve/scene_optics.h"
#include "rte/stack/hidden_layers.h"
#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;
using support::few_directions;
using support::scene_of;
using support::under_surface;

namespace {

const BrdfParts kLobeAlone = {.subsurface = false, .surface = true, .total = false};
const BrdfParts kLayersAlone = {.subsurface = true, .surface = false, .total = false};

/// Whether the plan for values of a scene at 550 nm names a rule.
bool leaves_out(const Scene& scene, const std::string& rule,
                const Directions& directions = few_directions(), const BrdfParts& parts = {}) {
    return plan_evaluate(solve(scene, {550}), directions, parts).leaves_out(rule);
}

BrdfValues values_of(const Scene& scene, const Directions& directions = few_directions()) {
    return solve(scene, {550}).evaluate(directions);
}

int orders_of(const ResultReport& report) { return report.wavelengths[0].solver.fourier_orders; }

ResolvedScene resolved(const Scene& scene) { return resolve(scene, {550}); }

}  // namespace

TEST_CASE("no depth: such a layer is left out, but its surface stays", "[pipeline][rules]") {
    const Scene scene = scene_of("index:1.5,0.001,radius=1", {"index:2.5,0.1,radius=1@0"});
    CHECK(resolved(scene).layers() == 0);
    CHECK(resolved(scene).empty_layers.size() == 1);
    CHECK(resolved(scene_of("isotropic:1", {"isotropic:1@1e-300"})).layers() == 1);
    CHECK(leaves_out(scene, "no depth"));

    support::Stages stages;
    solve(scene, {550}, {}, stages.control()).evaluate(few_directions());
    CHECK(stages.jobs["single scattering"] == 1);  // the base alone
    CHECK(resolved(under_surface(scene)).surface_index[0] == std::complex<double>(2.5, 0.1));
}

TEST_CASE("no depth: below a boundary or on a mirror the host's surfaces stay",
          "[pipeline][rules]") {
    Scene varnished = scene_of("isotropic:1", {"index:2.5,0.1,radius=1 in index:1.5@0"});
    varnished.substrate = substrate("lambert:0.8");
    CHECK(resolved(varnished).layers() == 0);
    varnished.boundary = rte::Boundary{};
    CHECK(resolved(varnished).layers() == 1);
    CHECK(leaves_out(varnished, "no depth"));
    // Saunderson's closed form for n = 1.5: r_int .59635.
    const double albedo = solve(varnished, {550}).albedo({1.0}).plane_albedo[0][0];
    const double inside = 0.5963457597;
    CHECK(std::abs(albedo - (0.04 + 0.96 * 0.8 * (1 - inside) / (1 - 0.8 * inside))) <= 1e-5);
    Scene on_mirror = scene_of("isotropic:1", {"isotropic:0.5 in index:1.5@0"});
    on_mirror.substrate = substrate("mirror:index:0.5,5");
    CHECK(resolved(on_mirror).layers() == 1);
}

TEST_CASE("no depth: layers are listed under their own number, with nothing in them",
          "[pipeline][rules]") {
    Scene scene = scene_of("hg:0.8,0", {"hg:0.5,0.3@0", "hg:0.6,0.2@1"});
    const bool bounded = GENERATE(false, true);
    if (bounded) scene.boundary = rte::Boundary{};
    scene.particles.host = {"", 1.5};
    const auto layers = solve(scene, {550}).layers();
    REQUIRE(layers.size() == 3);
    CHECK(layers[0].layer == "base");
    CHECK(layers[1].layer == "coat 1");
    CHECK(layers[1].optical_depth == 0);
    CHECK(std::isnan(layers[1].single_scattering_albedo));
    CHECK(std::isnan(layers[1].asymmetry));
    CHECK(layers[2].layer == "coat 2");
    CHECK(layers[2].optical_depth == 1);
    CHECK(layers[2].single_scattering_albedo == 0.6);
}

TEST_CASE("hidden layers: their Mie theory is not computed, and the result is the same",
          "[pipeline][rules]") {
    const std::string coat = GENERATE("hg:0.3,0.1", "isotropic:0.9", "isotropic:1");
    // A white coat hides only what is infinitely far down.
    const std::string depth = coat == "isotropic:1" ? "@inf" : "@60";
    const Scene hidden = scene_of("index:1.5,0,radius=1", {coat + depth});
    CAPTURE(coat);
    CHECK(leaves_out(hidden, "hidden layers"));
    support::Stages stages;
    const BrdfValues values = solve(hidden, {550}, {}, stages.control()).evaluate(few_directions());
    CHECK(stages.jobs["single scattering"] == 1);  // the coat
    // Against the solver given the whole stack: white below.
    const ResolvedScene scene = resolved(hidden);
    const auto optics =
        optics_of(scene, {0, 1}, {0}, demand_of({}, 0.0, PhaseDemand::whole), {.threads = 1})[0];
    rte::Stack stack;
    stack.base = optics[0].optics;
    stack.coats = {{optics[1].optics, scene.depths[0].optical_depth}};
    const auto whole = rte::reflect(stack, few_directions(), {}).reflection;
    const std::size_t block = 6;  // 2 mu_out x 3 azimuths
    for (std::size_t i = 0; i < whole.size(); ++i) {
        double largest = 0;
        for (std::size_t k = 0; k < block; ++k) {
            largest = std::max(largest, whole[i / block * block + k]);
        }
        CHECK(std::abs(std::numbers::pi * values.slices[0].subsurface[i] - whole[i]) <=
              2 * values.tolerance * largest);
    }
}

TEST_CASE("hidden layers: a coat that lets light through hides nothing", "[pipeline][rules]") {
    const Directions directions{{1.0}, {1.0}, {0.0}};
    CHECK_FALSE(rte::may_hide(0.1, directions, 1e-3));
    CHECK(rte::may_hide(10, directions, 1e-3));
    // Without absorption transmission falls like 1 / depth: 20 is not enough, 1e7 is.
    const rte::Optics white = rte::isotropic_optics(1.0);
    CHECK_FALSE(rte::hides_what_is_below(white, 20, directions, 1e-3));
    CHECK(rte::hides_what_is_below(white, 1e7, directions, 1e-3));
    CHECK(rte::hides_what_is_below(rte::isotropic_optics(0.5), 20, directions, 1e-3));
    CHECK_FALSE(leaves_out(scene_of("isotropic:0.5", {"isotropic:1@5"}), "hidden layers"));
    // A dark coat hides only what is darker: these let 2e-6 through and send back 8e-6 and nothing.
    CHECK_FALSE(
        rte::hides_what_is_below(rte::henyey_greenstein_optics(0.001, 0.8), 6.5, directions, 1e-3));
    CHECK_FALSE(rte::hides_what_is_below(rte::isotropic_optics(0.0), 6.5, directions, 1e-3));
}

TEST_CASE("hidden layers: what is called hidden changes by less than a tenth of the tolerance",
          "[pipeline][rules]") {
    const double albedo = GENERATE(0.2, 0.9, 0.99);
    const double asymmetry = GENERATE(0.0, 0.7);
    const rte::Optics coat = rte::henyey_greenstein_optics(albedo, asymmetry);
    const Directions directions{{0.2, 1.0}, {0.1, 0.5, 1.0}, {0, 90, 180}};
    double depth = 1;
    while (!rte::hides_what_is_below(coat, depth, directions, 1e-3)) depth *= 1.2;
    SolverOptions options;
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

TEST_CASE("hidden layers: of several coats the topmost that hides ends the stack",
          "[pipeline][rules]") {
    const Scene scene =
        scene_of("index:1.5,0,radius=1", {"hg:0.3,0.1@60", "hg:0.4,0.1@60", "hg:0.9,0.5@0.2"});
    support::Stages stages;
    const auto optics = visible_optics(resolved(scene), few_directions(), 1e-3, {0},
                                       demand_of({}, 0.0, PhaseDemand::whole), stages.control());
    CHECK(stages.jobs["single scattering"] == 2);
    CHECK(optics[0].stack.base.single_scattering_albedo == 0.4);
    CHECK(optics[0].stack.coats.size() == 1);
    // One that may hide and does not: everything is there, in its order.
    const auto white = visible_optics(
        resolved(scene_of("hg:0.3,0.1", {"hg:0.5,0@0.1", "isotropic:1@20", "hg:0.9,0.5@0.2"})),
        few_directions(), 1e-3, {0}, demand_of({}, 0.0, PhaseDemand::whole), {});
    CHECK(white[0].stack.base.single_scattering_albedo == 0.3);
    REQUIRE(white[0].stack.coats.size() == 3);
    CHECK(white[0].stack.coats[0].optical_depth == 0.1);
    CHECK(white[0].stack.coats[1].optical_depth == 20);
    CHECK(white[0].stack.coats[2].optics.single_scattering_albedo == 0.9);
}

TEST_CASE("analytic medium: no Mie theory for it", "[pipeline][rules]") {
    const Scene scene = scene_of("hg:0.9,0.5");
    CHECK(leaves_out(scene, "analytic medium"));
    CHECK_FALSE(leaves_out(scene_of("index:1.5,0"), "analytic medium"));
    // Mie options cannot matter where there is no Mie theory.
    Scene other = scene;
    other.particles.sizes.effective_radius_um = 7;
    CHECK(values_of(other).slices[0].total == values_of(scene).slices[0].total);
}

TEST_CASE("nothing scatters: a black ground takes the place of such layers", "[pipeline][rules]") {
    const auto base_scatters_nothing = [](const char* words) {
        return scatters_nothing(resolve(scene_of(words), {550}).media.front());
    };
    CHECK(base_scatters_nothing("hg:0,0.5"));
    CHECK(base_scatters_nothing("turbid:2,0"));
    CHECK_FALSE(base_scatters_nothing("isotropic:1e-9"));
    CHECK_FALSE(base_scatters_nothing("index:1.5,0"));
    CHECK(leaves_out(scene_of("isotropic:0", {"hg:0.9,0.1@1"}), "nothing scatters"));

    rte::Stack stack;
    stack.base = rte::isotropic_optics(0);
    stack.coats = {{rte::isotropic_optics(0), 1.0}, {rte::isotropic_optics(0.5), 1.0}};
    const rte::Stack reduced =
        visible_optics(resolved(scene_of("isotropic:0", {"isotropic:0@1", "isotropic:0.5@1"})),
                       few_directions(), 1e-3, {0}, {}, {})[0]
            .stack;
    CHECK(reduced.base_kind == rte::BaseKind::none);
    REQUIRE(reduced.coats.size() == 1);
    const Directions directions{{0.3}, {0.4}, {0, 90}};
    SolverOptions options;
    options.streams = 16;
    const auto full = rte::reflect(stack, directions, options).reflection;
    const auto less = rte::reflect(reduced, directions, options).reflection;
    // The equations are the same, with one matrix product fewer.
    for (std::size_t i = 0; i < full.size(); ++i) CHECK(std::abs(less[i] / full[i] - 1) <= 1e-10);
    const BrdfValues black = values_of(scene_of("isotropic:0"));
    CHECK(black.slices[0].total == std::vector<double>(12, 0.0));
    CHECK(black.converged());
    const AlbedoValues none = solve(scene_of("isotropic:0"), {550}).albedo({0.2, 1.0});
    CHECK(none.plane_albedo[0] == std::vector{0.0, 0.0});
    CHECK(none.spherical_albedo[0] == 0.0);
    CHECK(none.converged());
}

TEST_CASE("nothing absorbs: every plane albedo is 1 and nothing is solved", "[pipeline][rules]") {
    Scene scene = scene_of("index:1.5,0", {"hg:1,0.5@2"});
    CHECK(absorbs_nothing(resolved(scene), 0));
    support::Stages stages;
    const Brdf brdf = solve(scene, {550}, {}, stages.control());
    CHECK(plan_albedo(brdf, {0.3, 1.0}).leaves_out("nothing absorbs"));
    const AlbedoValues albedo = brdf.albedo({0.3, 1.0});
    CHECK(stages.jobs.count("single scattering") == 0);
    CHECK(albedo.converged());
    CHECK(albedo.plane_albedo[0] == std::vector{1.0, 1.0});
    CHECK(albedo.spherical_albedo[0] == 1.0);
    scene.particles.k_floor = 1e-6;  // now the base absorbs
    CHECK_FALSE(absorbs_nothing(resolved(scene), 0));
    CHECK_FALSE(plan_albedo(solve(scene, {550}), {0.3, 1.0}).leaves_out("nothing absorbs"));
}

TEST_CASE("few orders: isotropic media need one, Rayleigh three", "[pipeline][rules]") {
    const auto most = [](const Scene& scene) { return most_fourier_orders(resolved(scene)); };
    CHECK(most(scene_of("isotropic:0.5")) == 1);
    CHECK(most(scene_of("rayleigh:0.5")) == 3);
    CHECK(most(scene_of("hg:0.5,0.5")) == 0);
    const Scene isotropic = scene_of("isotropic:0.9", {"isotropic:0.5@1"});
    const Scene rayleigh = scene_of("isotropic:0.9", {"rayleigh:0.5@1"});
    CHECK(most(isotropic) == 1);
    CHECK(most(rayleigh) == 3);
    CHECK(most(scene_of("isotropic:0.9", {"hg:0.5,0.2@1"})) == 0);
    CHECK(leaves_out(isotropic, "few orders"));
    CHECK(orders_of(values_of(isotropic)) == 1);
    CHECK(orders_of(values_of(rayleigh)) <= 3);
}

TEST_CASE("albedo and zenith: order 0 alone", "[pipeline][rules]") {
    const Scene scene = scene_of("hg:0.9,0.7");
    CHECK_FALSE(only_zenith(few_directions()));
    CHECK(orders_of(values_of(scene)) > 5);
    CHECK(leaves_out(scene, "listed directions"));
    CHECK(plan_albedo(solve(scene, {550}), {0.3}).leaves_out("albedo"));
    CHECK(orders_of(solve(scene, {550}).albedo({0.3})) == 1);
    for (const bool in : {true, false}) {
        Directions directions = few_directions();
        (in ? directions.mu_in : directions.mu_out) = {1.0, 1.0};
        CHECK(only_zenith(directions));
        CHECK(leaves_out(scene, "zenith", directions));
        CHECK(orders_of(values_of(scene, directions)) == 1);
    }
}

TEST_CASE("rule across: at 90 and 270 degrees odd orders are left out, and change nothing",
          "[pipeline][rules]") {
    const Scene scene = scene_of("hg:0.9,0.7");
    Directions directions = {{0.4}, {0.3, 0.8}, {90, 270}};
    CHECK(only_across(directions));
    CHECK(leaves_out(scene, "across", directions));
    const BrdfValues even = values_of(scene, directions);
    directions.azimuth_deg.push_back(89);
    CHECK_FALSE(only_across(directions));
    CHECK_FALSE(leaves_out(scene, "across", directions));
    const BrdfValues all = values_of(scene, directions);
    for (std::size_t o = 0; o < 2; ++o) {
        // Both sums end within a quarter of the tolerance.
        CHECK(std::abs(even.at(0, 0, o, 0) / all.at(0, 0, o, 0) - 1) <= 0.5 * all.tolerance);
    }
}

TEST_CASE("same spheres: one Mie run for layers and wavelengths that share them",
          "[pipeline][rules]") {
    const Scene scene = scene_of("index:1.5,0.01,radius=1", {"index:1.5,0.01,radius=1@0.1"});
    CHECK(leaves_out(scene, "same spheres"));
    CHECK_FALSE(leaves_out(scene, "one half-space"));
    support::Stages stages;
    solve(scene, {550}, {}, stages.control()).evaluate(few_directions());
    CHECK(stages.jobs["single scattering"] == 1);
}

TEST_CASE("one half-space: several coats on one base solve it once", "[pipeline][rules]") {
    CHECK(
        leaves_out(scene_of("hg:0.9,0.5", {"hg:0.5,0.1@0.1", "hg:0.7,0.2@0.1"}), "one half-space"));
}

TEST_CASE("same wavelength: media that do not change with it are solved once",
          "[pipeline][rules]") {
    support::Stages stages;
    const Brdf brdf = solve(scene_of("hg:0.9,0.5"), {450, 550, 650}, {}, stages.control());
    CHECK(plan_evaluate(brdf, few_directions()).leaves_out("same wavelength"));
    const BrdfValues values = brdf.evaluate(few_directions());
    CHECK(stages.jobs["radiative transfer"] == 1);
    REQUIRE(values.slices.size() == 3);
    CHECK(values.wavelengths[2].wavelength_nm == 650);
    CHECK(values.slices[2].total == values.slices[0].total);
    const Brdf spheres = solve(scene_of("index:1.5,0.01,radius=1"), {450, 550, 650});
    CHECK_FALSE(plan_evaluate(spheres, few_directions()).leaves_out("same wavelength"));
}

TEST_CASE("same direction: repeated and mirrored directions are computed once",
          "[pipeline][rules]") {
    const Directions all{{0.9, 0.3, 0.9}, {0.5, 0.5}, {30, -30, 330, 400, 180, -180}};
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

    const Scene scene = scene_of("hg:0.9,0.5");
    const BrdfValues single = values_of(scene);
    Directions directions = few_directions();
    directions.azimuth_deg = {180, 70, -70, 0, 290};
    CHECK(leaves_out(scene, "same direction", directions));
    const BrdfValues repeated = values_of(scene, directions);
    const std::size_t same[] = {2, 1, 1, 0, 1};
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t o = 0; o < 2; ++o) {
            for (std::size_t a = 0; a < 5; ++a)
                CHECK(repeated.at(0, i, o, a) == single.at(0, i, o, same[a]));
        }
    }
}

TEST_CASE("surface alone: no layers, no surface: no lobe", "[pipeline][rules]") {
    const Scene bare = scene_of("index:1.5,0.01,radius=1"), scene = under_surface(bare);
    CHECK(leaves_out(bare, "no surface"));
    CHECK_FALSE(leaves_out(scene, "no surface"));
    const BrdfValues all = values_of(scene);

    CHECK_FALSE(wants_layers(kLobeAlone));
    CHECK(leaves_out(scene, "surface alone", few_directions(), kLobeAlone));
    support::Stages stages;
    const BrdfValues lobe =
        solve(scene, {550}, {}, stages.control()).evaluate(few_directions(), kLobeAlone);
    CHECK(stages.jobs.size() == 1);  // "surface"
    CHECK(lobe.converged());
    CHECK(lobe.slices[0].surface == all.slices[0].surface);

    CHECK_FALSE(wants_lobe(resolved(scene), kLayersAlone));
    CHECK(leaves_out(scene, "no surface", few_directions(), kLayersAlone));
    const BrdfValues layers = solve(scene, {550}).evaluate(few_directions(), kLayersAlone);
    CHECK(layers.slices[0].surface.empty());
    CHECK(layers.slices[0].subsurface == all.slices[0].subsurface);
}

TEST_CASE("reciprocity: half of the lobe's table is a mirror of the other", "[pipeline][rules]") {
    const Scene scene = under_surface(scene_of("index:1.5,0.01,radius=1"));
    CHECK_FALSE(is_symmetric(few_directions()));
    const Directions directions = {{0.2, 0.6, 0.9}, {0.9, 0.2, 0.6}, {0, 120}};
    CHECK(leaves_out(scene, "reciprocity", directions, kLobeAlone));
    const auto mirrored = solve(scene, {550}).evaluate(directions, kLobeAlone).slices[0].surface;
    const rte::SurfaceLobe lobe({1.5, 0.01}, *scene.surface);
    std::size_t index = 0;
    for (const double mu_in : directions.mu_in) {
        for (const double mu_out : directions.mu_out) {
            for (const double azimuth : directions.azimuth_deg) {
                // Rounding of the lobe's own formula, which is not written symmetrically.
                CHECK(std::abs(mirrored[index++] / lobe.brdf(mu_in, mu_out, azimuth) - 1) <= 1e-12);
            }
        }
    }
}

TEST_CASE("few moments: an albedo asks Mie theory for no phase function", "[pipeline][rules]") {
    CHECK(plan_albedo(solve(scene_of("index:1.5,0.01"), {550}), {0.5}).leaves_out("few moments"));
    const OpticsDemand demand = demand_of({}, 0.0, PhaseDemand::moments_only);
    CHECK_FALSE(demand.whole_phase_function);
    CHECK(demand.highest_moment < 200);
    CHECK(demand_of({}, 0.0, PhaseDemand::whole).whole_phase_function);
}
