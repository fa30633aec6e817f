// miebrdf render as a person meets it: files, messages and exit codes.
#include <filesystem>

#include "pipeline/render/image.h"
#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

/// Each argument is quoted for the shell.
support::ProgramRun run_render(const std::vector<std::string>& arguments) {
    std::string line = "render --size=24,16 --samples=2 --wavelengths=rgb";
    for (const std::string& argument : arguments) line += " '" + argument + "'";
    return support::run_program(line);
}

}  // namespace

TEST_CASE("render writes a PNG and a spectral EXR that say how they were made",
          "[render][program]") {
    const support::TemporaryFolder folder;
    const auto outcome = run_render({"--material=base=isotropic:0.9 coat=hg:0.1/0.9/0.93,0.5@0.1",
                                     "-o", folder / "a.png", "--exr", folder / "a.exr"});
    CAPTURE(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    CHECK(support::read_file(folder / "a.png").find("coat=hg:0.1/0.9/0.93") != std::string::npos);
    CHECK(support::read_file(folder / "a.exr").find("S0.535,000000nm") != std::string::npos);
    const render::Image picture = render::read_exr(folder / "a.exr");
    CHECK(picture.width == 24);
    CHECK(picture.height == 16);
    // The red albedo of the paint is the lowest, so the middle of the sphere is bluish.
    CHECK(picture.pixel(12, 8)[2] > picture.pixel(12, 8)[0]);
}

TEST_CASE("materials of render take the sizes of their layers, and lists of them",
          "[render][program][sizes]") {
    const support::TemporaryFolder folder;
    const auto picture = [&](const std::string& material) {
        const auto outcome = run_render(
            {"--material=" + material, "-o", folder / "a.png", "--exr", folder / "a.exr"});
        CAPTURE(material, outcome.err);
        REQUIRE(outcome.exit_code == 0);
        return render::read_exr(folder / "a.exr").values;
    };
    const auto wanted = picture("base=index:1.5,0.01 effective-radius=0.2");
    CHECK(picture("base=index:1.5,0.01,radius=0.2") == wanted);
    CHECK(picture("base=index:1.5,0.01,radius=0.2/0.2/0.2") == wanted);
    CHECK(picture("base=index:1.5,0.01,radius=0.2/0.2/0.4") != wanted);
}

TEST_CASE("render takes a film on a ground, without a base", "[render][program]") {
    const support::TemporaryFolder folder;
    const auto outcome =
        run_render({"--substrate=lambert:0.2", "--coat=hg:0.9,0.5@1", "-o", folder / "a.png"});
    CAPTURE(outcome.err);
    CHECK(outcome.exit_code == 0);
    const auto both = run_render(
        {"--substrate=lambert:0.2", "--material=base=isotropic:0.9", "-o", folder / "b.png"});
    CHECK(both.exit_code == 2);
    CHECK(both.err.find("either --base, --substrate or --coat") != std::string::npos);
}

TEST_CASE("render refuses lights that cannot be, naming them", "[render][program][errors]") {
    const support::TemporaryFolder folder;
    struct Case {
        const char *light, *reason;
        int exit_code;
    };
    const auto wrong =
        GENERATE(Case{"moon:1", "allowed: directional:, area:", 2},
                 Case{"directional:10", "1 numbers; wanted: 2 to 3", 2},
                 Case{"directional:10,20,-1", "-1 is negative", 2},
                 Case{"area:10,20,2,-3", "-3 is negative", 2}, Case{"uniform:nan", "nan", 2},
                 Case{"sky:0,20", "the sun at 0 degrees; allowed: (0, 90]", 2},
                 Case{"map:a,1,2", "wanted: map:FILE[,SCALE]", 2},
                 Case{"map:missing.hdr", "missing.hdr: no such file", 3});
    const auto outcome = run_render(
        {"--base=isotropic:0.5", "-o", folder / "a.png", std::string("--light=") + wrong.light});
    CAPTURE(wrong.light, outcome.err);
    CHECK(outcome.exit_code == wrong.exit_code);
    CHECK_THAT(outcome.err, Catch::Contains(wrong.reason));
    CHECK(folder.count() == 0);
}

TEST_CASE("render lights by a sun, a sky and a map of light", "[render][program]") {
    const support::TemporaryFolder folder;
    std::string grey = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    grey.append(8, '\x80');
    const std::string map = folder.write("grey.hdr", grey);
    for (const std::string& light :
         {std::string("directional:30,20"), std::string("sky:30,20"), "map:" + map + ",2"}) {
        const auto outcome = run_render({"--base=isotropic:0.5", "-o", folder / "a.png", "--exr",
                                         folder / "a.exr", "--light=" + light});
        CAPTURE(light, outcome.err);
        REQUIRE(outcome.exit_code == 0);
        CHECK(render::read_exr(folder / "a.exr").pixel(12, 8)[1] > 0);
    }
}

TEST_CASE("one number is the side of a square picture, and sizes that cannot be are refused",
          "[render][program][errors]") {
    const support::TemporaryFolder folder;
    const auto run_with = [&](const std::string& size) {
        return support::run_program(
            "render --base=isotropic:0.5 --wavelengths=550 --samples=1 -o " + (folder / "a.png") +
            " --exr " + (folder / "a.exr") + " --size=" + size);
    };
    const auto square = run_with("20");
    CAPTURE(square.err);
    REQUIRE(square.exit_code == 0);
    const render::Image picture = render::read_exr(folder / "a.exr");
    CHECK(picture.width == 20);
    CHECK(picture.height == 20);

    const auto wrong = GENERATE(as<std::string>(), "0", "20,0", "20.5", "20,10,5", "20000");
    const auto refused = run_with(wrong);
    CAPTURE(wrong, refused.err);
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.err, Catch::Contains("size") && Catch::Contains(wrong));
}

TEST_CASE("render refuses bad input with file, reason and exit code", "[render][program][errors]") {
    const support::TemporaryFolder folder;
    const std::string base = "--base=isotropic:0.5", png = folder / "a.png";
    const std::string empty = folder.write("empty.obj", "v 0 0 0\n");

    const auto missing = run_render({base, "--object", folder / "no.obj", "-o", png});
    CHECK(missing.exit_code == 3);
    CHECK_THAT(missing.err, Catch::Contains("no.obj: no such file"));
    const auto no_faces = run_render({base, "--object", empty, "-o", png});
    CHECK(no_faces.exit_code == 3);
    CHECK_THAT(no_faces.err, Catch::Contains("empty.obj") && Catch::Contains("no triangles"));

    render::write_png(render::Image(10, 4, 3), {}, folder / "mask.png");
    const auto shape = run_render({"--material=base=isotropic:0.5", "--material=base=isotropic:0.6",
                                   "--mask", folder / "mask.png", "-o", png});
    CHECK(shape.exit_code == 3);
    CHECK_THAT(shape.err, Catch::Contains("10 x 4"));

    CHECK(run_render({base}).exit_code == 2);       // nowhere to write
    CHECK(run_render({"-o", png}).exit_code == 2);  // no material
    CHECK(run_render({base, "--light=lamp:1", "-o", png}).exit_code == 2);
    for (const auto& [option, wanted] : {std::pair("-o", ".png"), {"--exr", ".exr"}}) {
        const auto ending = run_render({base, option, folder / "a.jpg"});
        CHECK(ending.exit_code == 2);
        CHECK_THAT(ending.err, Catch::Contains("'.jpg'") && Catch::Contains(wanted));
    }
    const auto list = run_render({"--material=base=hg:0.1/0.2,0.5", "-o", png});
    CHECK(list.exit_code == 2);
    CHECK_THAT(list.err, Catch::Contains("2 values for 3 wavelengths"));
    CHECK_FALSE(std::filesystem::exists(png));
}

TEST_CASE("render's help states the wavelengths that it uses", "[render][program]") {
    const auto help = support::run_program("render --help");
    CHECK_THAT(help.out, Catch::Contains("400:700:20") && !Catch::Contains("LIST=rgb"));
}
