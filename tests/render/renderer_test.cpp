// The renderer against closed forms: what a sphere sends to a distant observer, and what must
// vanish in a uniform surrounding.
#include "pipeline/render/renderer.h"

#include <cmath>
#include <numbers>

#include "pipeline/render/mesh.h"
#include "tests/render/support.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using namespace miebrdf::render;

namespace {

constexpr double kPi = std::numbers::pi;

/// Lossless and not Lambertian: what one azimuth loses another gains, so every directional albedo
/// is 1. With |c| <= 1 it is nowhere negative, and it is reciprocal.
class LosslessBrdf : public RenderBrdf {
  public:
    std::size_t wavelengths() const override { return 1; }
    void evaluate(double mu_in, double mu_out, double cos_azimuth,
                  std::span<double> brdf) const override {
        const double sines = std::sqrt((1 - mu_in) * (1 + mu_in) * (1 - mu_out) * (1 + mu_out));
        brdf[0] = (1 + 0.9 * sines * cos_azimuth) / kPi;
    }
};

RenderScene knot_scene(std::shared_ptr<const RenderBrdf> material) {
    return {RayScene::mesh(make_knot(480), "knot"), {}, {std::move(material)}, {}};
}

double largest_deviation_from_one(const SpectralPicture& picture) {
    double largest = 0.0;
    for (const float value : picture.radiance.values) {
        // A comparison that fails for NaN keeps it visible.
        const double deviation = std::abs(double(value) - 1.0);
        if (!(deviation <= largest)) largest = deviation;
    }
    return largest;
}

/// Mean over the sphere's disc, of which the square picture shows pi/4.
double mean_over_disc(const SpectralPicture& picture) { return mean_radiance(picture) * 4 / kPi; }

}  // namespace

TEST_CASE("a white sphere disappears in a uniform environment", "[render][furnace]") {
    RenderScene scene = sphere_scene(lambertian({1.0}));
    scene.lighting.environment = Environment::uniform({1.0});
    RenderOptions options{.width = 64, .height = 64, .samples = 16, .bounces = 4};
    options.environment_visible = true;
    // Cosine sampling makes every path of a Lambertian surface worth exactly 1: rounding to the
    // picture's single precision is all that remains.
    CHECK(largest_deviation_from_one(render_picture(scene, parallel_camera(scene), options)) <=
          1e-6);
}

TEST_CASE("a lossless sphere that is not Lambertian disappears too", "[render][furnace]") {
    RenderScene scene = sphere_scene(std::make_shared<LosslessBrdf>());
    scene.lighting.environment = Environment::uniform({1.0});
    RenderOptions options{.width = 20, .height = 20, .samples = 16384, .bounces = 1};
    options.environment_visible = true;
    // The promise for every pixel. What is left is noise: 6e-4 with this many samples, falling
    // somewhat slower than their number grows.
    CHECK(largest_deviation_from_one(render_picture(scene, parallel_camera(scene), options)) <=
          1e-3);
}

TEST_CASE("a white knot, lit by its own reflections, disappears", "[render][furnace]") {
    RenderScene scene = knot_scene(lambertian({1.0}));
    scene.lighting.environment = Environment::uniform({1.0});
    RenderOptions options{.width = 48, .height = 48, .samples = 64, .bounces = 400};
    options.environment_visible = true;
    const SpectralPicture picture = render_picture(scene, parallel_camera(scene), options);
    // Paths end early only where the smoothed normal lets them into a facet; the mesh is fine
    // enough for that to cost less than the promised 1e-3 on average over the picture.
    CHECK(std::abs(mean_radiance(picture) - 1.0) <= 1e-3);
}

TEST_CASE("clamping takes away just what it says, and nothing of light reflected once",
          "[render][clamp]") {
    RenderScene scene = knot_scene(lambertian({0.9}));
    scene.lighting.directional = {{direction_from_angles(40.0, 50.0), {kPi}}};
    RenderOptions options{.width = 32, .height = 32, .samples = 64, .bounces = 4};
    const SpectralPicture all = render_picture(scene, parallel_camera(scene), options);
    REQUIRE(all.clamped == 0.0);
    options.clamp = 1e6;
    CHECK(mean_radiance(render_picture(scene, parallel_camera(scene), options)) ==
          mean_radiance(all));
    // The knot's folds light each other: a quarter of the light is reflected more than once.
    options.clamp = 0.2 * mean_radiance(all);
    const SpectralPicture less = render_picture(scene, parallel_camera(scene), options);
    CHECK(less.clamped > 0.05);
    // Pixels are stored in single precision.
    CHECK(std::abs(mean_radiance(less) / mean_radiance(all) - (1.0 - less.clamped)) <= 1e-6);
    options.bounces = 1;
    options.clamp = 0.0;
    const SpectralPicture once = render_picture(scene, parallel_camera(scene), options);
    options.clamp = 1e-9;
    CHECK(render_picture(scene, parallel_camera(scene), options).radiance.values ==
          once.radiance.values);
    options.clamp = -1.0;
    CHECK_THROWS_WITH(render_picture(scene, parallel_camera(scene), options),
                      Catch::Contains("clamp -1"));
}

TEST_CASE("a Lambertian sphere shows Lambert's phase curve", "[render][sphere]") {
    // Mean radiance over the disc under unit irradiance: (2/3) (albedo/pi) (sin a + (pi-a) cos
    // a)/pi (Lambert 1760), phase angle a between light and observer.
    const double phase_deg = GENERATE(0.0, 30.0, 90.0, 140.0);
    RenderScene scene = sphere_scene(lambertian({0.7}));
    scene.lighting.directional = {{direction_from_angles(0.0, phase_deg), {1.0}}};
    const auto picture = render_picture(scene, parallel_camera(scene),
                                        {.width = 128, .height = 128, .samples = 64, .bounces = 1});
    const double a = phase_deg * kPi / 180;
    const double expected = 2.0 / 3.0 * 0.7 / kPi * (std::sin(a) + (kPi - a) * std::cos(a)) / kPi;
    CAPTURE(phase_deg);
    // A million samples at the disc's edge and terminator: area errors near 1e-5 of the disc.
    CHECK(std::abs(mean_over_disc(picture) - expected) <= 1e-4 * 0.7 / kPi);
}

TEST_CASE("a Lommel-Seeliger sphere shows Seeliger's phase curve", "[render][sphere]") {
    // Mean radiance w/(8 pi) [1 - sin(a/2) tan(a/2) ln cot(a/4)] under unit irradiance
    // (Seeliger 1887; Hapke 2012, ch. 6); w/(8 pi) all over the disc in opposition.
    const double phase_deg = GENERATE(0.0, 30.0, 90.0, 140.0);
    RenderScene scene = sphere_scene(std::make_shared<LommelSeeligerBrdf>(std::vector{0.6}));
    scene.lighting.directional = {{direction_from_angles(0.0, phase_deg), {1.0}}};
    const auto picture = render_picture(scene, parallel_camera(scene),
                                        {.width = 128, .height = 128, .samples = 64, .bounces = 1});
    const double a = phase_deg * kPi / 180;
    const double fall =
        a > 0 ? std::sin(a / 2) * std::tan(a / 2) * std::log(1 / std::tan(a / 4)) : 0.0;
    CAPTURE(phase_deg);
    CHECK(std::abs(mean_over_disc(picture) - 0.6 / (8 * kPi) * (1 - fall)) <= 1e-4 * 0.6 / kPi);
}

TEST_CASE("under a uniform sky a sphere's mean radiance is its spherical albedo",
          "[render][sphere]") {
    // Lommel-Seeliger: plane albedo A(m) = w/2 [1 - m ln((1 + m)/m)], spherical albedo
    // 2 int A m dm = 2/3 (1 - ln 2) w.
    RenderScene scene = sphere_scene(std::make_shared<LommelSeeligerBrdf>(std::vector{0.8}));
    scene.lighting.environment = Environment::uniform({1.0});
    const auto picture = render_picture(scene, parallel_camera(scene),
                                        {.width = 64, .height = 64, .samples = 256, .bounces = 1});
    // Noise of 2^20 samples, each within a few times the mean.
    CHECK(std::abs(mean_over_disc(picture) - 2.0 / 3.0 * (1 - std::log(2.0)) * 0.8) <= 2e-4);
}

TEST_CASE("light and observer may change places, reflections between parts included",
          "[render][reciprocity]") {
    // Helmholtz: the power that a body turns from one direction into another is symmetric. The
    // lobe makes both kinds of sampling take part.
    const auto material = std::make_shared<RoughLobeBrdf>(std::vector{0.9}, 0.5);
    const Eigen::Vector3d a = direction_from_angles(10.0, -25.0);
    const Eigen::Vector3d b = direction_from_angles(35.0, 50.0);
    const auto power = [&](const Eigen::Vector3d& light, const Eigen::Vector3d& view) {
        RenderScene scene = knot_scene(material);
        scene.lighting.directional = {{light, {1.0}}};
        return mean_radiance(
            render_picture(scene, parallel_camera(scene, view),
                           {.width = 128, .height = 128, .samples = 64, .bounces = 3}));
    };
    const double forth = power(a, b), back = power(b, a);
    CAPTURE(forth, back);
    REQUIRE(forth > 0.01);
    // Noise of a million paths; smoothed normals break the symmetry by less.
    CHECK(std::abs(forth / back - 1) <= 3e-3);
}

TEST_CASE("a small area light is a directional light", "[render][lights]") {
    RenderScene scene = sphere_scene(lambertian({1.0}));
    const Eigen::Vector3d towards = direction_from_angles(30.0, 40.0);
    const RenderOptions options{.width = 48, .height = 48, .samples = 64, .bounces = 1};
    scene.lighting.directional = {{towards, {1.0}}};
    const double directional =
        mean_radiance(render_picture(scene, parallel_camera(scene), options));
    scene.lighting.directional.clear();
    const double distance = 1e4;
    scene.lighting.area = {square_light(Eigen::Vector3d::Zero(), towards, distance, 1.0, {1.0})};
    const double area = mean_radiance(render_picture(scene, parallel_camera(scene), options));
    // Half a degree of penumbra and a distance of 1e4 radii change the mean in second order.
    CHECK(std::abs(area / directional - 1) <= 5e-4);
}

TEST_CASE("aiming at bright parts of a map changes the noise, not the picture",
          "[render][lights]") {
    // One sky is a map that is sampled, and, constant, one that is not.
    Image flat(128, 64, 3);
    for (std::size_t i = 0; i < flat.values.size(); i += 3) flat.values[i] = 1.0F;
    RenderScene scene = sphere_scene(std::make_shared<RoughLobeBrdf>(std::vector{0.5}, 0.3));
    const RenderOptions options{.width = 32, .height = 32, .samples = 256, .bounces = 1};
    scene.lighting.environment = Environment::uniform({1.0});
    const double plain = mean_radiance(render_picture(scene, parallel_camera(scene), options));
    scene.lighting.environment = Environment::from_map(flat, {Spectrum{1.0}, {0.0}, {0.0}}, "flat");
    const double aimed = mean_radiance(render_picture(scene, parallel_camera(scene), options));
    CAPTURE(plain, aimed);
    CHECK(std::abs(aimed / plain - 1) <= 2e-3);  // noise of 2^18 samples
}

TEST_CASE("pictures do not depend on the number of threads", "[render][threads]") {
    RenderScene scene = knot_scene(std::make_shared<RoughLobeBrdf>(std::vector{0.9, 0.5}, 0.3));
    scene.lighting.environment =
        Environment::from_map(clear_sky_map(direction_from_angles(40, 60), 1, 0.1),
                              {Spectrum{1, 2}, {1, 1}, {0, 0}}, "sky");
    scene.lighting.directional = {{direction_from_angles(40, 60), {3.0, 2.0}}};
    const auto at = [&](int threads) {
        Control control;
        control.threads = threads;
        return render_picture(scene, parallel_camera(scene),
                              {.width = 70, .height = 50, .samples = 8, .bounces = 3}, control);
    };
    const SpectralPicture one = at(1);
    for (const int threads : {2, 7}) {
        const SpectralPicture many = at(threads);
        CHECK(many.radiance.values == one.radiance.values);
        CHECK(many.coverage.values == one.coverage.values);
        CHECK(many.noise == one.noise);
    }
}

TEST_CASE("the renderer refuses what it cannot render", "[render][errors]") {
    RenderScene scene = sphere_scene(lambertian({0.5}));
    const Camera camera = parallel_camera(scene);
    CHECK_THROWS_WITH(render_picture(scene, camera, {.samples = 0}),
                      Catch::Contains("samples 0") && Catch::Contains("1 to"));
    scene.lighting.directional = {{kFront, {1.0, 1.0}}};
    CHECK_THROWS_WITH(render_picture(scene, camera, {}), Catch::Contains("2 wavelengths"));
    scene.materials.clear();
    CHECK_THROWS_WITH(render_picture(scene, camera, {}), Catch::Contains("no material"));
}
