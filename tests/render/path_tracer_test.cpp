// The example of a path tracer beside the program's pictures.
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "pipeline/render/image.h"
#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

TEST_CASE("the example's path tracer sees the picture that render makes of its scene",
          "[render][program][example]") {
    const support::TemporaryFolder folder;
    const std::string told = folder / "told";
    REQUIRE(
        std::system(("cd '" + folder.path().string() + "' && '" MIEBRDF_PATH_TRACER "' 192 > told")
                        .c_str()) == 0);
    const std::string text = support::read_file(told);
    const std::size_t command = text.find("miebrdf render ");
    REQUIRE(command != std::string::npos);
    std::string arguments = text.substr(command + 8, text.find('\n', command) - command - 8);
    for (const char* file : {"ball_on_ground.obj", "render.exr"})
        arguments.replace(arguments.find(file), std::strlen(file), folder / file);
    const auto outcome = support::run_program(arguments + " --samples 192");
    CAPTURE(arguments, outcome.err);
    REQUIRE(outcome.exit_code == 0);
    const render::Image wanted = render::read_exr(folder / "render.exr");
    const std::string pfm = support::read_file(folder / "path_tracer.pfm");
    const std::size_t pixels = std::size_t(wanted.width) * std::size_t(wanted.height);
    REQUIRE(pfm.size() > 12 * pixels);
    const char* const floats = pfm.data() + (pfm.size() - 12 * pixels);

    // Squares of 24 pixels: 110,000 paths each, of which a single one errs by .3 to 1 of the mean.
    constexpr int kSide = 24;
    for (int y0 = 0; y0 < wanted.height; y0 += kSide) {
        for (int x0 = 0; x0 < wanted.width; x0 += kSide) {
            for (int c = 0; c < 3; ++c) {
                double ours = 0.0, theirs = 0.0;
                for (int y = y0; y < y0 + kSide; ++y) {
                    for (int x = x0; x < x0 + kSide; ++x) {
                        float value = 0;
                        const int line = wanted.height - 1 - y;  // from the bottom up
                        std::memcpy(&value, floats + 4 * (3 * (line * wanted.width + x) + c), 4);
                        ours += value;
                        theirs += wanted.pixel(x, y)[c];
                    }
                }
                INFO("square at " << x0 << ", " << y0 << ", channel " << c << ": " << ours << " "
                                  << theirs);
                if (theirs < 1.0) continue;  // next to nothing but background
                CHECK(std::abs(ours / theirs - 1) <= 0.01);
            }
        }
    }
}
