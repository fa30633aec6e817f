#include "pipeline/scene/moments_file.h"

#include <miebrdf/error.h>
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

TEST_CASE("a moments file gives albedo and moments in order", "[pipeline][moments_file]") {
    const support::TemporaryFolder folder;
    const auto path = folder.write("m.csv",
                                   "# made by hand\n# single_scattering_albedo: 0.9\n"
                                   "l,chi\n0,1\n1,0.5\n2,0.25\r\n");
    const MomentsFile file = read_moments_file(path);
    CHECK(file.single_scattering_albedo == 0.9);
    CHECK(file.chi == std::vector<double>{1, 0.5, 0.25});
}

TEST_CASE("a wrong moments file is refused with its name and line",
          "[pipeline][moments_file][errors]") {
    struct Case {
        const char* content;
        const char* complaint;
    };
    const Case wrong =
        GENERATE(Case{"# single_scattering_albedo: 0.9\nl,chi\n0,0.5\n", "chi_0 = 0.5"},
                 Case{"# single_scattering_albedo: 1.5\nl,chi\n0,1\n", "1.5 is out of range"},
                 Case{"# single_scattering_albedo: nan\nl,chi\n0,1\n", "nan"},
                 Case{"l,chi\n0,1\n", "single_scattering_albedo"},
                 Case{"# single_scattering_albedo: 0.9\n0,1\n", "header 'l,chi'"},
                 Case{"# single_scattering_albedo: 0.9\nl,chi\n0,1\n2,0.1\n", "expected l = 1"},
                 Case{"# single_scattering_albedo: 0.9\nl,chi\n0,1\n1,-1.5\n", "chi_1 = -1.5"},
                 Case{"# single_scattering_albedo: 0.9\nl,chi\n0,1\n1,abc\n", "'abc'"},
                 Case{"# single_scattering_albedo: 0.9\nl,chi\n", "no rows"}, Case{"", "no rows"});
    const support::TemporaryFolder folder;
    const auto path = folder.write("wrong.csv", wrong.content);
    CAPTURE(wrong.content);
    CHECK_THROWS_AS(read_moments_file(path), InputError);
    CHECK_THROWS_WITH(read_moments_file(path), Catch::Contains("wrong.csv") &&
                                                   Catch::Contains("line ") &&
                                                   Catch::Contains(wrong.complaint));
}

TEST_CASE("a moments file that does not exist is named", "[pipeline][moments_file][errors]") {
    CHECK_THROWS_WITH(read_moments_file("/no/such/file.csv"), Catch::Contains("/no/such/file.csv"));
}
