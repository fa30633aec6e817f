// The words of a scene: one list for options, scene files and materials of pictures.
#include "pipeline/scene/scene_words.h"

#include <set>

#include <miebrdf/error.h>
#include "pipeline/scene/scene_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/one_line.h"

using namespace miebrdf;

namespace {

std::string described(const Request& request) {
    const auto& [scene, wavelength_nm, solver] = request;
    const mie::SizeDistribution& sizes = scene.particles.sizes;
    std::string text = describe(scene) + " " + scene.database + " " + name_of(sizes.kind);
    for (const double value :
         {sizes.effective_radius_um, sizes.effective_variance, scene.particles.host.index.real(),
          scene.particles.k_floor, scene.particles.tolerance,
          double(int(scene.coupling.value_or(rte::SurfaceCoupling::paper))), solver.tolerance,
          double(solver.streams), double(int(solver.grid)), double(int(solver.half_space_method)),
          double(int(solver.coat_method)), double(solver.coat_substeps), double(solver.delta_m),
          double(solver.single_scattering_correction), double(solver.stokes)}) {
        text += " " + std::to_string(value);
    }
    return text;
}

Request empty_request() {
    Request request;
    request.scene.base = medium("hg:0.9,0.5");
    return request;
}

}  // namespace

TEST_CASE("every word has a name of its own, a help text, and defaults that are the scene's",
          "[program][words]") {
    std::set<std::string> names, fields;
    for (const SceneWord& word : scene_words()) {
        CAPTURE(word.name);
        CHECK(names.insert(word.name).second);
        CHECK(fields.insert(word.field).second);
        CHECK_FALSE(word.help.empty());
        CHECK(find_scene_word(word.name) == &word);
        CHECK((word.kind == WordKind::flag) == word.placeholder.empty());
        if (word.default_text.empty() || word.name == "wavelengths") continue;
        Request request = empty_request();
        apply(word, std::vector<WordValue>{word.default_text}, request);
        CHECK(described(request) == described(empty_request()));
    }
    CHECK(find_scene_word("bsae") == nullptr);
}

TEST_CASE("help of every command with a scene shows every word", "[program][words]") {
    for (const char* command : {"brdf", "albedo", "export", "check", "plot lobe", "plan brdf"}) {
        const std::string help = support::run_program(std::string(command) + " --help").out;
        for (const SceneWord& word : scene_words()) {
            CAPTURE(command, word.name);
            CHECK_THAT(help, Catch::Contains("--" + word.name));
        }
    }
}

TEST_CASE("numbers of a scene file stay the numbers that they are", "[program][words][scene]") {
    const support::TemporaryFolder folder;
    const std::string file = folder.write(
        "scene.toml",
        "[[result]]\ncommand = \"albedo\"\nbase = \"hg:0.9,0.5\"\n"
        "wavelengths = [450, 550.1, \"2eV\", \"600:700:50\"]\n"
        "surface-index = [1.3333333333333333, 1e-300]\nroughness = 0.30000000000000004\n"
        "tolerance = 1e-4\nstreams = 16\nno-delta-m = true\nmu-in = [0.1, 1]\n"
        "no-single-scattering-correction = false\n");
    const std::vector<SceneFileCommand> commands = {
        {"albedo",
         {"base", "wavelengths", "surface-index", "roughness", "tolerance", "streams", "no-delta-m",
          "no-single-scattering-correction"},
         {{"mu-in"}}}};
    const auto results = read_scene_file(file, commands);
    REQUIRE(results.size() == 1);
    const Request& request = results[0].request;
    REQUIRE(request.wavelength_nm.size() == 6);
    CHECK(request.wavelength_nm[1] == 550.1);
    CHECK(request.wavelength_nm[5] == 700.0);
    CHECK(request.scene.surface_index == std::complex<double>(1.3333333333333333, 1e-300));
    CHECK(request.scene.surface->beckmann_alpha == 0.30000000000000004);
    CHECK(request.solver.tolerance == 1e-4);
    CHECK(request.solver.streams == 16);
    CHECK_FALSE(request.solver.delta_m);
    CHECK(request.solver.single_scattering_correction);
    // A switch that is off is not said.
    CHECK(results[0].words.size() == 7);
    REQUIRE(results[0].keys.size() == 1);
    CHECK(results[0].keys[0].name == "mu-in");
    CHECK(results[0].keys[0].values == std::vector<WordValue>{0.1, 1.0});
    CHECK(results[0].keys[0].line == 10);
}
