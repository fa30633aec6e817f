// Chunks that outlive their process: what is found again, and what is not trusted.
#include <miebrdf/error.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "pipeline/sweep/layout.h"
#include "pipeline/sweep/run.h"
#include "pipeline/sweep/slurm.h"
#include "pipeline/sweep/sweep_file.h"
#include "pipeline/sweep/sweep_plan.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using Catch::Contains;

namespace {

std::string text_of_sweep(const std::string& albedos = "[0.1, 0.5, 0.9]") {
    return R"(outputs = ["plane_albedo", "spherical_albedo"]
chunk = 2
[scene]
base = "hg:{a},{g}"
tolerance = 1e-2
[axes]
a = )" + albedos +
           R"(
g = [0, 0.4]
mu_in = [0.5, 1]
wavelength_nm = 550
)";
}

std::string content(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// A sweep with its parts and its table, in a folder.
struct Work {
    explicit Work(const support::TemporaryFolder& folder, const std::string& name,
                  const std::string& text = text_of_sweep())
        : sweep(sweep::read_sweep_file(folder.write(name + ".toml", text))),
          layout(sweep::layout_of(sweep)),
          table(folder / (name + ".csv")),
          parts(sweep, layout, sweep::Parts::folder_of(table)) {}

    sweep::RunReport run(sweep::Share share = {}) {
        return sweep::run_share(sweep, layout, parts, share, Control());
    }
    sweep::TableReport write() {
        const auto writer = sweep::make_csv_writer(sweep, layout, table);
        return sweep::write_table(parts, *writer, Control());
    }
    std::string part(int number) const {
        return (parts.folder() / ("chunk-000000" + std::to_string(number))).string();
    }

    sweep::Sweep sweep;
    sweep::Layout layout;
    std::string table;
    sweep::Parts parts;
};

}  // namespace

TEST_CASE("a run goes on where one ended, damaged chunks are computed again", "[sweep][parts]") {
    const support::TemporaryFolder folder;
    Work calm(folder, "calm"), work(folder, "work");
    CHECK(calm.run().computed_scenes == 6);
    CHECK(calm.write().scenes == 6);

    CHECK(work.run({2, 3}).computed_scenes == 2);
    auto report = work.run();
    CHECK(report.found == 1);
    CHECK(report.computed_scenes == 4);

    const std::string whole = content(work.part(1));
    for (const std::size_t length : {std::size_t{0}, whole.size() / 2, whole.size() - 1}) {
        std::ofstream(work.part(1), std::ios::binary) << whole.substr(0, length);
        CHECK_FALSE(work.parts.read(work.parts.chunks()[1]));
    }
    for (const std::size_t place : {std::size_t{3}, whole.size() / 2, whole.size() - 1}) {
        std::string bad = whole;
        bad[place] = char(bad[place] ^ 1);
        std::ofstream(work.part(1), std::ios::binary) << bad;
        CHECK_FALSE(work.parts.read(work.parts.chunks()[1]));
    }
    CHECK_THROWS_WITH(work.write(), Contains("1 of 3 chunks are missing"));
    CHECK_FALSE(std::filesystem::exists(work.table));
    report = work.run();
    CHECK(report.found == 2);
    CHECK(report.computed_scenes == 2);
    work.write();
    CHECK(content(work.table) == content(calm.table));
    work.parts.remove();
    CHECK_FALSE(std::filesystem::exists(work.parts.folder()));
}

TEST_CASE("chunks of another sweep are not taken for its own", "[sweep][parts]") {
    const support::TemporaryFolder folder;
    Work work(folder, "work");
    work.run();
    Work other(folder, "work", text_of_sweep("[0.1, 0.5, 0.8]"));
    CHECK(other.run().found == 0);
    // Comments and titles change nothing.
    Work same(folder, "work", "title = \"x\"\n" + text_of_sweep("[0.1, 0.5, 0.8]") + "# end\n");
    CHECK(same.run().found == 3);
}

TEST_CASE("shares of several processes make the table of one", "[sweep][parts]") {
    const support::TemporaryFolder folder;
    Work one(folder, "one"), shared(folder, "shared");
    one.run();
    one.write();
    std::size_t scenes = 0;
    for (std::size_t i = 1; i <= 4; ++i) scenes += shared.run({i, 4}).computed_scenes;
    CHECK(scenes == 6);
    shared.write();
    CHECK(content(shared.table) == content(one.table));

    CHECK(sweep::parse_share("3/8").number == 3);
    for (const char* bad : {"0/8", "9/8", "3", "1.5/8", "a/b", "1/2/3"}) {
        CAPTURE(bad);
        CHECK_THROWS_AS(sweep::parse_share(bad), UsageError);
    }
}

TEST_CASE("a scene that fails is a line with its reason", "[sweep]") {
    const support::TemporaryFolder folder;
    Work work(folder, "work", text_of_sweep("[0.1, 0.5, 1.5]"));
    work.run();
    const auto report = work.write();
    CHECK(report.failed == 2);
    CHECK(report.error_estimate <= 1e-2);
    CHECK_THAT(report.first_remark, Contains("failed") && Contains("1.5"));
    const auto last = work.parts.read(work.parts.chunks()[2]);
    REQUIRE(last);
    CHECK(std::isnan((*last)[0].values[0]));
    CHECK(std::isnan((*last)[0].error_estimate));
    CHECK_FALSE((*last)[0].converged);
    CHECK(std::isfinite((*work.parts.read(work.parts.chunks()[1]))[1].values[0]));
}

TEST_CASE("a folder that cannot be written is named", "[sweep][errors]") {
    const support::TemporaryFolder folder;
    const auto sweep = sweep::read_sweep_file(folder.write("s.toml", text_of_sweep()));
    const auto layout = sweep::layout_of(sweep);
    const std::string file = folder.write("file", "");
    CHECK_THROWS_WITH(sweep::Parts(sweep, layout, file + "/parts"), Contains("file/parts"));
}

TEST_CASE("a plan counts everything, and names the scenes that cannot be computed", "[sweep]") {
    const support::TemporaryFolder folder;
    Work work(folder, "work", text_of_sweep("[0.1, 0.5, 1.5]"));
    const auto plan = sweep::plan_sweep(work.sweep, work.layout, 10.0, Control());
    CHECK(plan.scenes == 6);
    CHECK(plan.values == 18);
    CHECK(plan.chunks == 3);
    CHECK(plan.looked_at == 6);
    CHECK(plan.processor_seconds > 0.0);
    // Those that failed when they were computed (the test above), with their values and the reason.
    std::size_t failed = 0;
    work.run();
    for (std::size_t chunk = 0; chunk < plan.chunks; ++chunk) {
        const auto results = work.parts.read(work.parts.chunks()[chunk]);
        REQUIRE(results);
        for (const auto& scene : *results) failed += std::isnan(scene.error_estimate) ? 1 : 0;
    }
    CHECK(plan.refused == failed);
    REQUIRE(plan.refusals.size() == 2);
    CHECK_THAT(plan.refusals[0], Contains("scene 4 (a = 1.5, g = 0)") && Contains("[0, 1]"));
}

namespace {

/// Log-normal ice beyond what averages over sizes take (size parameters to 1e6) at short
/// wavelengths, or at all of them.
constexpr char kLargeIce[] = R"(outputs = ["plane_albedo"]
chunk = 3
[scene]
base = "H2O_ice,radius={radius_um},variance=0.2,distribution=log-normal"
tolerance = 1e-2
[axes]
radius_um = [3000, 10000, 30000]
mu_in = [0.5]
wavelength_nm = [350, 900]
)";

}  // namespace

TEST_CASE("a plan finds the scenes that sizes make impossible, and those that lack wavelengths",
          "[sweep]") {
    const support::TemporaryFolder folder;
    Work work(folder, "work", kLargeIce);
    const auto plan = sweep::plan_sweep(work.sweep, work.layout, 10.0, Control());
    CHECK(plan.looked_at == 3);
    CHECK(plan.refused == 1);
    CHECK(plan.incomplete == 1);
    REQUIRE(plan.refusals.size() == 2);
    CHECK_THAT(plan.refusals[0],
               Contains("scene 1 (radius_um = 10000) at 350 nm") && Contains("size parameters"));
    CHECK_THAT(plan.refusals[1], Contains("scene 2 (radius_um = 30000): medium"));
    work.run();
    const auto report = work.write();
    CHECK(report.failed == plan.refused);
    CHECK(report.incomplete == plan.incomplete);
    CHECK(report.not_converged == 0);
    CHECK_THAT(report.first_remark, Contains("failed at 350 nm"));
}

TEST_CASE("a little soot in snow does not have a plan count the scattering matrices of the grains",
          "[sweep]") {
    const support::TemporaryFolder folder;
    const auto seconds = [&](const std::string& name, const std::string& soot) {
        const std::string text =
            "outputs = [\"plane_albedo\"]\n[scene]\n"
            "base = \"H2O_ice,radius={radius_um}" +
            soot +
            "\"\n[axes]\nradius_um = [100, 300]\nmu_in = [0.5]\n"
            "wavelength_nm = \"400:1300:100\"\n";
        Work work(folder, name, text);
        return sweep::plan_sweep(work.sweep, work.layout, 10.0, Control()).processor_seconds;
    };
    // By formulas alone: soot of 0.1 um takes a hundredth of what the grains take.
    const double clean = seconds("clean", ""),
                 sooty = seconds("sooty", " + soot_diesel,radius=0.1,density=1.3,mass=1e-7");
    CHECK(sooty >= clean);
    CHECK(sooty <= 1.5 * clean);
}

TEST_CASE("a wavelength that cannot be computed leaves the others of its scene", "[sweep]") {
    const support::TemporaryFolder folder;
    Work work(folder, "work", kLargeIce);
    work.run();
    const auto results = work.parts.read(work.parts.chunks()[0]);
    REQUIRE(results);
    const auto& partial = (*results)[1];
    CHECK(std::isnan(partial.values[0]));
    CHECK(partial.missing_wavelengths == 1);
    CHECK_FALSE(partial.converged);
    CHECK(partial.error_estimate <= 1e-2);
    // The same bits as of a scene of this wavelength alone.
    const auto alone = solve({.base = medium("H2O_ice,radius=10000,variance=0.2,"
                                             "distribution=log-normal")},
                             {900}, {.tolerance = 1e-2})
                           .albedo({0.5});
    CHECK(partial.values[1] == alone.plane_albedo[0][0]);
}

TEST_CASE("a derivative without a bound leaves the values of its scene", "[sweep][derivatives]") {
    // A half-space that absorbs nothing returns everything; its derivative by the albedo is
    // infinite.
    const support::TemporaryFolder folder;
    Work work(folder, "work", R"(outputs = ["spherical_albedo"]
derivatives = ["a"]
[scene]
base = "isotropic:{a}"
tolerance = 1e-2
[axes]
a = [0.5, 1]
wavelength_nm = [500, 600]
)");
    work.run();
    const auto results = work.parts.read(work.parts.chunks()[0]);
    REQUIRE(results);
    const auto& all = (*results)[1];
    CHECK(std::abs(all.values[0] - 1.0) <= 1e-12);
    CHECK(std::isnan(all.values[2]));
    CHECK_THAT(all.remark, Contains("no derivatives at 500, 600 nm"));
    CHECK(std::isfinite((*results)[0].values[2]));
}

TEST_CASE("derivatives by sizes that scenes share are those of each scene alone",
          "[sweep][derivatives]") {
    // The second scene finds the differences of spheres that the first one computed.
    const support::TemporaryFolder folder;
    Work work(folder, "work", R"(outputs = ["plane_albedo"]
derivatives = ["radius_um"]
[scene]
base = "SiO2,radius={radius_um},variance=0.1,volume=10% + soot_diesel,radius=0.1,volume={share}"
tolerance = 1e-2
[axes]
radius_um = [0.5]
share = [0.001, 0.002]
mu_in = [0.5]
wavelength_nm = [500]
)");
    CHECK(work.sweep.scenes_per_group() == 2);
    work.run();
    const auto results = work.parts.read(work.parts.chunks()[0]);
    REQUIRE(results);
    for (const std::size_t scene : {0, 1}) {
        const auto request = sweep::request_of(work.sweep, scene);
        const auto alone =
            solve(request.scene, {500}, request.solver).derivatives({"radius_um"}).albedo({0.5});
        CHECK((*results)[scene].values[0] == alone.values.plane_albedo[0][0]);
        CHECK((*results)[scene].values[1] == alone.derivatives[0].plane_albedo[0][0]);
    }
}

TEST_CASE("the script for Slurm computes shares and merges them", "[sweep]") {
    const std::string script = sweep::slurm_script("my sweep.toml", "it's.nc", 16);
    CHECK_THAT(script, Contains("#SBATCH --array=1-16") && Contains("--part") &&
                           Contains("$SLURM_ARRAY_TASK_ID/16") && Contains("--merge"));
    CHECK_THAT(script, Contains("sweep='my sweep.toml'") && Contains("table='it'\\''s.nc'"));
}
