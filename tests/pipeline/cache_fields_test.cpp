// A key names a result in the cache, and a stored result comes back whole.
#include "pipeline/cache/fields.h"

#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "pipeline/cache/job_key.h"
#include "pipeline/cache/packed_numbers.h"
#include "pipeline/cache/result_cache.h"
#include "pipeline/solve/layers.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/single_scattering.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using support::few_directions;
using support::scene_of;
using support::under_surface;

namespace {

template <typename T>
std::string key_of(const T& value) {
    return JobKey("test").add(value).hash();
}

/// Every change gives a key of its own, and there is one for each field that is listed.
template <typename T>
void check_changes(const T& original, const std::vector<std::function<void(T&)>>& changes) {
    CHECK(changes.size() == std::tuple_size_v<decltype(fields(original))>);
    std::set<std::string> keys = {key_of(original)};
    CHECK(key_of(T(original)) == key_of(original));
    for (std::size_t i = 0; i < changes.size(); ++i) {
        T changed = original;
        changes[i](changed);
        CAPTURE(i);
        CHECK(keys.insert(key_of(changed)).second);
    }
}

/// Whether `is` holds for all the fields of two values and, in turn, for the fields of these.
template <typename T, typename Is>
bool for_all_fields(const T& a, const T& b, const Is& is) {
    if constexpr (HasFields<const T>) {
        return std::apply(
            [&](const auto&... in_a) {
                return std::apply(
                    [&](const auto&... in_b) { return (for_all_fields(in_a, in_b, is) && ...); },
                    fields(b));
            },
            fields(a));
    } else {
        return is(a, b);
    }
}

/// No field has its default.
WavelengthReport full_report() {
    WavelengthReport report;
    report.wavelength_nm = 550;
    report.solver = {.streams = 24,
                     .moments = 48,
                     .fourier_orders = 17,
                     .iterations = 5,
                     .error_estimate = 1e-4,
                     .share_within_tolerance = 0.75,
                     .worst_value = 42,
                     .worst_mu_in = 0.1,
                     .worst_mu_out = 0.2,
                     .worst_azimuth_deg = 30,
                     .converged = true,
                     .method = "doubling, \"exponential\" \xc3\xbc"};
    report.optical_depths = {0.1, 2.5};
    report.mie_error_estimate = 2e-4;
    report.phase_noise = {.largest = 0.01, .mu_in = 0.3, .mu_out = 0.4, .azimuth_deg = 170};
    report.stokes = 3;
    report.polarisation_left_out = 2e-3;
    report.error_estimate = std::nextafter(3e-4, 1.0);
    report.converged = true;
    return report;
}

}  // namespace

TEST_CASE("every field of the solver's options is in a key", "[pipeline][cache][key]") {
    check_changes<SolverOptions>(
        {},
        {[](auto& o) { o.tolerance = std::nextafter(o.tolerance, 1.0); },
         [](auto& o) { o.grid = rte::GridKind::paper; }, [](auto& o) { o.streams = 8; },
         [](auto& o) { o.half_space_method = rte::HalfSpaceMethod::doubling; },
         [](auto& o) { o.coat_method = rte::CoatMethod::exponential; },
         [](auto& o) { o.coat_substeps = 2; }, [](auto& o) { o.delta_m = false; },
         [](auto& o) { o.single_scattering_correction = false; }, [](auto& o) { o.stokes = 3; }});
}

TEST_CASE("every field of sizes is in a key", "[pipeline][cache][key]") {
    check_changes<mie::SizeDistribution>(
        {.radii_um = {1, 2}, .number_density = {0, 1}},
        {[](auto& s) { s.kind = mie::SizeDistributionKind::tabulated; },
         [](auto& s) { s.effective_radius_um = 51; }, [](auto& s) { s.effective_variance = 0.3; },
         [](auto& s) { s.radii_um[1] = 3; }, [](auto& s) { s.number_density[1] = 2; },
         [](auto& s) { s.exponent = 3; }});
}

TEST_CASE("every field of a surface is in a key", "[pipeline][cache][key]") {
    check_changes<rte::SurfaceOptions>(
        {}, {[](auto& s) { s.beckmann_alpha = 0.2; },
             [](auto& s) { s.distribution = rte::MicrofacetDistribution::ggx; },
             [](auto& s) { s.shadowing = rte::Shadowing::v_cavity; },
             [](auto& s) { s.fresnel = rte::FresnelKind::schlick; },
             [](auto& s) { s.shadowing_distribution = rte::MicrofacetDistribution::beckmann; }});
    rte::SurfaceOptions beckmann, ggx;
    beckmann.shadowing_distribution = rte::MicrofacetDistribution::beckmann;
    ggx.shadowing_distribution = rte::MicrofacetDistribution::ggx;
    CHECK(key_of(beckmann) != key_of(ggx));
}

TEST_CASE("every field of particles and their shape is in a key", "[pipeline][cache][key]") {
    check_changes<Particles>({.coatings = {{1.3, 0.1, 0.2}}},
                             {[](auto& p) { p.wavelength_nm = 551; },
                              [](auto& p) {
                                  p.index = {1.5, 1e-9};
                              },
                              [](auto& p) { p.host_index = 1.33; },
                              [](auto& p) { p.coatings.push_back(p.coatings.front()); }});
    check_changes<mie::ParticleCoating>(
        {1.3, 0.1, 0.2},
        {[](auto& c) {
             c.refractive_index = {1.3, 1e-9};
         },
         [](auto& c) { c.thickness_um = 0.2; }, [](auto& c) { c.share_of_radius = 0.1; }});
    check_changes<GrainShape>(
        {}, {[](auto& s) { s.kind = GrainShape::Kind::koch; }, [](auto& s) { s.aspect = 0.0; },
             [](auto& s) { s.asymmetry = 0.0; }, [](auto& s) { s.absorption = 0.0; },
             [](auto& s) { s.by_t_matrix = true; }});
}

TEST_CASE("every field of a boundary and of reading an index is in a key",
          "[pipeline][cache][key]") {
    check_changes<rte::Boundary>(
        {}, {[](auto& b) { b.roughness = 0.1; },
             [](auto& b) { b.distribution = rte::MicrofacetDistribution::beckmann; },
             [](auto& b) { b.matrices = rte::BoundaryMatrices::interpolated; }});
    check_changes<materials::IndexOptions>(
        {}, {[](auto& o) { o.interpolation = materials::Interpolation::linear_in_energy; },
             [](auto& o) { o.extrapolation = materials::Extrapolation::clamp; },
             [](auto& o) { o.missing_k_is_zero = true; }});
}

TEST_CASE("every list of directions is in a key, and where one ends", "[pipeline][cache][key]") {
    check_changes<Directions>({{0.5}, {0.5}, {30}},
                              {[](auto& d) { d.mu_in = {0.4}; }, [](auto& d) { d.mu_out = {0.4}; },
                               [](auto& d) { d.azimuth_deg = {}; }});
    CHECK(key_of(Directions{{0.1, 0.2}, {0.3}, {}}) != key_of(Directions{{0.1}, {0.2, 0.3}, {}}));
}

TEST_CASE("the report of a wavelength comes back from the cache whole", "[pipeline][cache]") {
    const WavelengthReport report = full_report();
    const auto equal = [](const auto& a, const auto& b) { return a == b; };
    const auto different = [](const auto& a, const auto& b) { return a != b; };
    REQUIRE(for_all_fields(report, WavelengthReport{}, different));
    const auto numbers = NumberPacker().add(report).numbers();
    WavelengthReport copy;
    NumberUnpacker(numbers).read(copy);
    CHECK(for_all_fields(copy, report, equal));
    // Every shorter row is refused.
    for (std::size_t size = 0; size < numbers.size(); ++size) {
        const std::vector<double> cut(numbers.begin(),
                                      numbers.begin() + static_cast<std::ptrdiff_t>(size));
        WavelengthReport none;
        CHECK_THROWS(NumberUnpacker(cut).read(none));
    }
}

TEST_CASE("what is packed is read in its order", "[pipeline][cache]") {
    const std::vector<double> list = {1, 2, 3}, nothing;
    const std::optional<double> none, some = -0.0;
    const std::string text("a\0b", 3);
    const auto numbers = NumberPacker()
                             .add(true)
                             .add(list)
                             .add(nothing)
                             .add(none)
                             .add(some)
                             .add(std::complex(1.5, -0.25))
                             .add(text)
                             .add(rte::GridKind::paper)
                             .numbers();
    bool flag = false;
    std::vector<double> read_list, empty = {7};
    std::optional<double> read_none = 3.0, read_some;
    std::complex<double> index;
    std::string read_text;
    rte::GridKind grid = rte::GridKind::automatic;
    NumberUnpacker unpacker(numbers);
    const auto read = [&](auto&... values) { (unpacker.read(values), ...); };
    read(flag, read_list, empty, read_none, read_some, index, read_text, grid);
    CHECK(flag);
    CHECK(read_list == list);
    CHECK(empty.empty());
    CHECK_FALSE(read_none);
    REQUIRE(read_some);
    CHECK(std::signbit(*read_some));
    CHECK(index == std::complex(1.5, -0.25));
    CHECK(read_text == text);
    CHECK(grid == rte::GridKind::paper);
}

TEST_CASE("the name of a layer's result has all that it depends on, and nothing else",
          "[pipeline][cache][key]") {
    struct Request {
        Scene scene = scene_of("index:1.5,0.01", {"hg:0.5,0.2@0.3"});
        double wavelength_nm = 550;
        SolverOptions options = {};
        Directions directions = few_directions();
        LayerQuantity quantity = LayerQuantity::reflection;
    };
    const auto hash = [](const std::function<void(Request&)>& change) {
        Request r;
        change(r);
        return list_layer_jobs(
                   {resolve(r.scene, {r.wavelength_nm}), r.directions, r.options, r.quantity})
            .jobs[0]
            .hash;
    };
    const std::string original = hash([](Request&) {});
    std::set<std::string> hashes = {original};
    const std::vector<std::function<void(Request&)>> matters = {
        [](auto& r) { r.wavelength_nm = 551; },
        [](auto& r) { r.options.streams = 8; },
        [](auto& r) { r.directions.mu_in = {0.7}; },
        [](auto& r) { r.quantity = LayerQuantity::albedo; },
        [](auto& r) { r.scene.base = medium("index:1.5,0.02"); },
        [](auto& r) { r.scene.layers[0].medium = medium("hg:0.5,0.3"); },
        [](auto& r) { r.scene.layers[0].medium = medium("rayleigh:0.5"); },
        [](auto& r) { r.scene.layers[0].depth = 0.4; },
        [](auto& r) { r.scene.layers.clear(); },
        [](auto& r) { r.scene.layers.push_back(r.scene.layers[0]); },
        [](auto& r) { r.scene.particles.sizes.effective_variance = 0.1; },
        [](auto& r) { r.scene.particles.host.index = 1.33; },
        [](auto& r) { r.scene.particles.k_floor = 0.03; },
        [](auto& r) { r.scene.particles.tolerance = 1e-5; },
    };
    for (std::size_t i = 0; i < matters.size(); ++i) {
        CAPTURE(i);
        CHECK(hashes.insert(hash(matters[i])).second);
    }
    const std::vector<std::function<void(Request&)>> same = {
        [](auto& r) { r.scene = under_surface(r.scene, 0.3, 1.5); },  // not below the surface
        [](auto& r) {
            r.scene.layers.push_back({medium("TiO2"), 0.0});
        },
        [](auto& r) { r.scene.base = medium("index:1.5,0.01,radius=50"); },
        [](auto& r) { r.scene.particles.k_floor = 0.01; },
    };
    for (std::size_t i = 0; i < same.size(); ++i) {
        CAPTURE(i);
        CHECK(hash(same[i]) == original);
    }
    // The light that a surface lets in depends on the surface.
    const auto let_in = [&](double alpha, double index, rte::SurfaceCoupling coupling) {
        return hash([=](Request& r) {
            r.quantity = LayerQuantity::albedo_through_surface;
            r.scene = under_surface(r.scene, alpha, index);
            r.scene.coupling = coupling;
        });
    };
    using rte::SurfaceCoupling;
    for (const auto& other :
         {let_in(0.3, 1.5, SurfaceCoupling::paper), let_in(0.2, 1.5, SurfaceCoupling::paper),
          let_in(0.3, 1.6, SurfaceCoupling::paper),
          let_in(0.3, 1.5, SurfaceCoupling::reciprocal)}) {
        CHECK(hashes.insert(other).second);
    }
}

TEST_CASE("packed optics come back to the last bit, phase function included", "[pipeline][cache]") {
    const ResolvedScene scene = resolve(scene_of("index:1.6,0.01,radius=1"), {500});
    const bool whole = GENERATE(true, false);
    const OpticsDemand demand =
        demand_of({}, 0.0, whole ? PhaseDemand::whole : PhaseDemand::moments_only);
    const MediumOptics optics = compute_optics(scene, 0, 0, demand);
    const MediumOptics copy = unpacked_optics(packed(optics));
    CHECK(copy.optics.single_scattering_albedo == optics.optics.single_scattering_albedo);
    CHECK(copy.optics.one_minus_albedo == optics.optics.one_minus_albedo);
    CHECK(copy.optics.chi == optics.optics.chi);
    CHECK(copy.optics.has_more_moments == optics.optics.has_more_moments);
    CHECK(copy.q_ext == optics.q_ext);
    CHECK(copy.asymmetry == optics.asymmetry);
    CHECK(copy.error_estimate == optics.error_estimate);
    CHECK(copy.converged == optics.converged);
    REQUIRE(bool(copy.optics.phase) == whole);
    for (double x = -1.0; whole && x <= 1.0; x += 0.01) {
        CHECK(copy.optics.phase(x) == optics.optics.phase(x));
    }
}

TEST_CASE("what is no packed optics is refused, not read beyond its end", "[pipeline][cache]") {
    CHECK_THROWS(unpacked_optics({}));
    CHECK_THROWS(unpacked_optics({1.0, 1.5}));
    CHECK_THROWS(unpacked_optics(std::vector<double>(40, 1e18)));
}

TEST_CASE("scenes that share a medium share its Mie results", "[pipeline][cache]") {
    const support::TemporaryFolder folder;
    const auto cache = std::make_shared<ResultCache>(folder / "results.sqlite");
    const auto values = [](const char* coat, const Control& control) {
        return solve(scene_of("index:1.5,0,radius=1", {coat}), {500, 600}, {}, control)
            .evaluate(few_directions());
    };
    values("index:1.6,0.01,radius=1@0.1", {.cache = cache});
    const auto entries = cache->info().entries;
    const auto shared = values("index:1.6,0.01,radius=1@0.2", {.cache = cache});
    // Two wavelengths of new layers; the two media were known.
    CHECK(cache->info().entries == entries + 2);
    const auto alone = values("index:1.6,0.01,radius=1@0.2", {});
    REQUIRE(shared.slices.size() == alone.slices.size());
    for (std::size_t w = 0; w < alone.slices.size(); ++w)
        CHECK(shared.slices[w].subsurface == alone.slices[w].subsurface);
}
