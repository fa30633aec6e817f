// miebrdf bench: files of results that are read back, compared, and put into pages.
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>

#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/one_line.h"
#include "tools/bench/results.h"

using namespace miebrdf;
namespace fs = std::filesystem;

namespace {

const std::string kHeader =
    "# processor: one of "
    "ours\nsuite,case,method,parameter,error,seconds,memory,spread,half_width\n";

std::string results(const char* seconds) {
    return kHeader + "coat,\"hg 0.9, depth 1\",exact,n=8,1e-3," + seconds +
           ",1000,0.01,\n"
           "coat,\"hg 0.9, depth 1\",exact,n=16,1e-5,0.01,2000,0.01,\n"
           "coat,\"hg 0.9, depth 1\",first-order,n=8,1e-1,0.0005,500,0.01,\n";
}

}  // namespace

TEST_CASE("bench --read draws an earlier run again, to the same results", "[program][bench]") {
    const support::TemporaryFolder folder;
    const std::string old = folder.write("old.csv", results("0.002"));
    const std::string out = folder / "again";
    const auto run = support::run_ok("bench --read " + old + " -o " + out);
    CHECK(run.out.empty());
    CHECK_THAT(run.err, Catch::Contains("3 points in " + out));
    // Punctuation of cases stays out of names of files.
    CHECK_THAT(support::read_file(out + "/coat-hg-0.9-depth-1.svg"),
               Catch::Contains("coat: hg 0.9, depth 1") && Catch::Contains("first-order"));
    CHECK_THAT(support::read_file(out + "/index.html"),
               Catch::Contains("one of ours") && Catch::Contains("n=16"));
    CHECK_FALSE(fs::exists(out + "/comparison.csv"));

    support::run_ok("bench --read " + out + "/results.csv -o " + (folder / "twice"));
    CHECK(support::read_file(folder / "twice/results.csv") ==
          support::read_file(out + "/results.csv"));
}

TEST_CASE("bench --compare tells what became slower", "[program][bench]") {
    const support::TemporaryFolder folder;
    const std::string before = folder.write("before.csv", results("0.002"));
    const std::string after = folder.write("after.csv", results("0.004"));
    const std::string out = folder / "out";
    const auto run =
        support::run_ok("bench --read " + after + " --compare " + before + " -o " + out);
    CHECK_THAT(run.err, Catch::Contains("coat / hg 0.9, depth 1, exact n=8: slower"));
    CHECK(run.err.find("n=16") == std::string::npos);
    const std::string table = support::read_file(out + "/comparison.csv");
    CHECK_THAT(table, Catch::Contains(",exact,n=8,0.002,0.004,") && Catch::Contains(",slower\n"));
    CHECK_THAT(table, Catch::Contains(",same\n"));
}

TEST_CASE("bench measures a suite, where our own lobe keeps each tolerance", "[program][bench]") {
    const support::TemporaryFolder folder;
    const std::string out = folder / "out";
    const auto run =
        support::run_ok("bench --suite surface --repeats 1 --longest 0.001 --quiet -o " + out);
    CHECK(run.err.empty());
    const auto results = bench::read_results(out + "/results.csv");
    REQUIRE_FALSE(results.facts.empty());
    CHECK_THAT(results.facts.back().second, Catch::StartsWith("miebrdf bench --suite surface"));
    int ours = 0;
    for (const bench::Measurement& m : results.measurements) {
        CHECK(m.suite == "surface");
        CHECK(m.seconds > 0.0);
        if (m.method != "miebrdf") continue;
        ++ours;
        CAPTURE(m.test_case, m.parameter);
        CHECK(m.error <= std::stod(m.parameter.substr(m.parameter.find('=') + 1)));
    }
    CHECK(ours >= 8);
    for (const auto& [suite, name] : bench::cases_of(results)) {
        CAPTURE(name);
        CHECK_THAT(support::read_file(out + "/index.html"), Catch::Contains(name));
    }
}

TEST_CASE("bench refuses what it cannot do before it measures anything",
          "[program][bench][errors]") {
    const support::TemporaryFolder folder;
    const std::string to = " -o " + (folder / "out");
    const auto refused = [](const std::string& options, int code,
                            const std::vector<std::string>& words) {
        CAPTURE(options);
        support::check_one_line(support::run_program("bench" + options), code, words);
    };
    refused("", support::kUsage, {"-o DIR"});
    refused(" --suite coats" + to, support::kUsage, {"coats", "coat"});
    refused(" --repeats 0" + to, support::kUsage, {"0 repeats", "at least 1"});
    refused(" --read " + (folder / "no.csv") + to, support::kBadInput, {"no.csv"});
    refused(" --suite coat --compare " + (folder / "no.csv") + to, support::kBadInput, {"no.csv"});
    const std::string other = folder.write("other.csv", "a,b\n1,2\n");
    refused(" --read " + other + to, support::kBadInput, {"other.csv"});
    CHECK_FALSE(fs::exists(folder / "out"));
}

TEST_CASE("bench and stress are commands of miebrdf, done by a program that lies beside it",
          "[program][bench]") {
    const auto help = support::run_program("--help");
    for (const char* command : {"bench", "stress"}) {
        CAPTURE(command);
        CHECK_THAT(help.out, Catch::Contains(std::string("\n  ") + command + " "));
        // Words that miebrdf itself does not know are read by the other program.
        const auto own = support::run_program(std::string(command) + " --help");
        CHECK(own.exit_code == 0);
        CHECK_THAT(own.out, Catch::Contains("--docs FOLDER"));
        support::check_one_line(support::run_program(std::string(command) + " --dcos x"),
                                support::kUsage, {"--dcos", "did you mean --docs?"});
    }
}

TEST_CASE("without miebrdf-bench, bench and stress say how to get it", "[program][bench][errors]") {
    const support::TemporaryFolder folder;
    const std::string alone = folder / "miebrdf";
    std::error_code elsewhere;
    fs::create_hard_link(MIEBRDF_PROGRAM, alone, elsewhere);  // not across file systems
    if (elsewhere) fs::copy_file(MIEBRDF_PROGRAM, alone);
    for (const char* command : {"bench", "stress"}) {
        support::ProgramRun run;
        const int status = std::system(("PATH=/nowhere '" + alone + "' " + command + " >'" +
                                        (folder / "out") + "' 2>'" + (folder / "err") + "'")
                                           .c_str());
        run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        run.out = support::read_file(folder / "out");
        run.err = support::read_file(folder / "err");
        support::check_one_line(run, support::kUsage,
                                {std::string("miebrdf ") + command, "miebrdf-bench", "--target"});
    }
}
