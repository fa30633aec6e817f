// Processes that share a sweep: who takes what, and what becomes of those that die.
#include <filesystem>
#include <map>

#include <miebrdf/error.h>
#include "pipeline/sweep/crew.h"
#include "pipeline/sweep/layout.h"
#include "pipeline/sweep/run.h"
#include "pipeline/sweep/sweep_file.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

constexpr char kCrewSweep[] = R"(outputs = ["spherical_albedo"]
chunk = 2
[scene]
base = "hg:{a},{g}"
tolerance = 1e-2
[axes]
a = [0.1, 0.5, 0.9]
g = [0, 0.4]
wavelength_nm = 550
)";

struct CrewWork {
    explicit CrewWork(const support::TemporaryFolder& folder)
        : sweep(sweep::read_sweep_file(folder.write("s.toml", kCrewSweep))),
          layout(sweep::layout_of(sweep)),
          parts(sweep, layout, folder / "t.csv.parts") {}

    sweep::RunReport run(const sweep::Crew& crew) const {
        return sweep::run_crew(
            sweep, layout, parts, crew, [] { return false; }, Control());
    }

    sweep::Sweep sweep;
    sweep::Layout layout;
    sweep::Parts parts;
};

std::optional<sweep::Crew> crew_of(const std::map<std::string, std::string>& environment) {
    return sweep::crew_of_environment([&](const char* name) -> const char* {
        const auto found = environment.find(name);
        return found == environment.end() ? nullptr : found->second.c_str();
    });
}

}  // namespace

TEST_CASE("mpirun and srun say who is in a crew", "[sweep]") {
    const auto mpi = crew_of(
        {{"OMPI_COMM_WORLD_RANK", "2"}, {"OMPI_COMM_WORLD_SIZE", "4"}, {"PMIX_NAMESPACE", "17"}});
    REQUIRE(mpi);
    CHECK(mpi->number == 2);
    CHECK(mpi->size == 4);
    const auto next = crew_of(
        {{"OMPI_COMM_WORLD_RANK", "3"}, {"OMPI_COMM_WORLD_SIZE", "4"}, {"PMIX_NAMESPACE", "18"}});
    REQUIRE(next);
    CHECK(next->launch != mpi->launch);
    const auto slurm = crew_of({{"SLURM_PROCID", "0"},
                                {"SLURM_NTASKS", "64"},
                                {"SLURM_JOB_ID", "5"},
                                {"SLURM_STEP_ID", "0"}});
    REQUIRE(slurm);
    CHECK(slurm->size == 64);
    CHECK_FALSE(crew_of({}));
    CHECK_FALSE(crew_of({{"SLURM_PROCID", "0"}, {"SLURM_NTASKS", "1"}}));  // a task of a job array
    CHECK_FALSE(crew_of({{"OMPI_COMM_WORLD_RANK", "x"}, {"OMPI_COMM_WORLD_SIZE", "4"}}));
}

TEST_CASE("a crew takes each chunk once, and its first computes what the dead have taken",
          "[sweep]") {
    const support::TemporaryFolder folder;
    const CrewWork work(folder);
    REQUIRE(work.parts.chunks().size() == 3);
    REQUIRE(work.parts.take(work.parts.chunks()[1], "now"));  // by one that dies here
    CHECK_FALSE(work.parts.take(work.parts.chunks()[1], "now"));
    const auto second = work.run({"now", 1, 2});
    CHECK(second.chunks == 2);
    CHECK(second.computed_scenes == 4);
    CHECK_FALSE(work.parts.read(work.parts.chunks()[1]));
    const auto first = work.run({"now", 0, 2});
    CHECK(first.chunks == 0);
    CHECK(first.computed_scenes == 2);
    CHECK(work.parts.read(work.parts.chunks()[1]));
    // Chunks that an earlier launch has taken mean nothing to the next one; those it has stored do.
    const auto later = work.run({"later", 1, 2});
    CHECK(later.chunks == 3);
    CHECK(later.found == 3);
    CHECK(later.computed_scenes == 0);
    work.parts.remove();
    CHECK_FALSE(std::filesystem::exists(work.parts.folder()));
}

TEST_CASE("a process that comes when the table is complete computes nothing", "[sweep]") {
    const support::TemporaryFolder folder;
    const CrewWork work(folder);
    const auto report = sweep::run_crew(
        work.sweep, work.layout, work.parts, {"now", 1, 2}, [] { return true; }, Control());
    CHECK(report.computed_scenes == 0);
    work.parts.remove();  // as it does after the table is written: nothing can be taken any more
    CHECK(sweep::run_crew(
              work.sweep, work.layout, work.parts, {"now", 1, 2}, [] { return true; }, Control())
              .computed_scenes == 0);
    CHECK_THROWS_AS(work.run({"now", 0, 2}), InputError);
}

TEST_CASE("shared single scattering: written whole, read back to the bit, never in the way",
          "[sweep]") {
    const support::TemporaryFolder folder;
    const std::string hash(64, 'a');
    const std::vector<double> numbers = {0.1, -1e-300, 3.0};
    sweep::OpticsFolder shared(folder / "optics", 64);
    CHECK_FALSE(shared.find(hash));
    shared.store(hash, numbers);
    CHECK(shared.find(hash) == numbers);
    shared.store(std::string(64, 'b'), std::vector<double>(6, 1.0));  // 24 + 48 bytes: too many
    CHECK_FALSE(shared.find(std::string(64, 'b')));
    const auto file = std::filesystem::path(folder / "optics") / "aa" / hash;
    std::filesystem::resize_file(file, std::filesystem::file_size(file) - 8);
    CHECK_FALSE(shared.find(hash));
    sweep::OpticsFolder nowhere(folder / "removed/optics");
    nowhere.store(hash, numbers);
    CHECK_FALSE(nowhere.find(hash));
    CHECK_FALSE(std::filesystem::exists(folder / "removed"));
}

TEST_CASE("a share finds the single scattering that another one has computed", "[sweep]") {
    const support::TemporaryFolder folder;
    const auto toml = folder.write("s.toml", R"(outputs = ["spherical_albedo"]
chunk = 1
[scene]
base = "index:1.5,0.01,radius=0.5"
coat = "hg:0.5,0@{depth}"
stokes = 1
tolerance = 1e-2
[axes]
depth = [0.1, 0.2, 0.3]
wavelength_nm = 550
)");
    const sweep::Sweep job = sweep::read_sweep_file(toml);
    const sweep::Layout layout = sweep::layout_of(job);
    const sweep::Parts alone(job, layout, folder / "alone.parts");
    const sweep::Parts parts(job, layout, folder / "shared.parts");
    sweep::run_share(job, layout, alone, {1, 1}, Control());
    CHECK_FALSE(std::filesystem::exists(alone.optics_folder()));
    sweep::run_share(job, layout, parts, {1, 3}, Control());
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(parts.optics_folder()))
        if (entry.is_regular_file()) files.push_back(entry.path());
    REQUIRE(files.size() == 1);
    const auto albedo = [&](const sweep::Parts& of, std::size_t chunk) {
        return of.read(of.chunks()[chunk])->at(0).values.at(0);
    };
    sweep::run_share(job, layout, parts, {2, 3}, Control());
    CHECK(albedo(parts, 1) == albedo(alone, 1));
    // Other numbers in the file are what the next share computes with.
    sweep::OpticsFolder shared(parts.optics_folder());
    auto numbers = *shared.find(files[0].filename().string());
    numbers[0] = numbers[1] = 0.5;  // single-scattering albedo and what it lacks to 1
    shared.store(files[0].filename().string(), numbers);
    sweep::run_share(job, layout, parts, {3, 3}, Control());
    CHECK(albedo(parts, 2) < 0.5 * albedo(alone, 2));
    parts.remove();
    CHECK_FALSE(std::filesystem::exists(parts.folder()));
}
