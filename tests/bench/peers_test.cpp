// Other programs beside our methods: the protocol, and programs that do not keep to it.
#include "tools/bench/peers.h"

#include <cmath>
#include <string>
#include <vector>

#include <miebrdf/error.h>
#include "tests/support/catch.h"
#include "tools/bench/suites.h"

using namespace miebrdf;

namespace {

std::vector<bench::BenchCase> with_peer(const std::string& command, double patience_s,
                                        std::vector<std::string>& notes) {
    std::vector<bench::BenchCase> cases{bench::half_space_suite().front()};
    cases[0].contenders.clear();
    bench::add_peer(
        {"peer", command}, patience_s, [&](const std::string& line) { notes.push_back(line); },
        cases);
    return cases;
}

/// A peer in the shell: it answers the first question, then what a test wants.
std::string shell_peer(const std::string& then) {
    return "read q; echo '{\"settings\": [\"1\"]}'; read q; " + then;
}

}  // namespace

TEST_CASE("the peer of the documentation stands beside the other methods", "[bench][peers]") {
    std::vector<std::string> notes;
    const auto cases =
        with_peer("python3 " MIEBRDF_SOURCE_DIR "/docs/examples/bench_peer.py", 60, notes);
    REQUIRE(cases[0].contenders.size() == 3);
    const auto points = bench::measure(cases[0], {.repeats = 2});
    REQUIRE(points.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
        CAPTURE(points[i].parameter, points[i].error);
        CHECK(points[i].method == "peer");
        CHECK(points[i].seconds > 0.0);
        CHECK(std::isnan(points[i].memory));  // of another process
    }
    CHECK(points[0].error <= 1e-5);  // 8 nodes for H, which is not smooth at 0
    CHECK(points[1].error < 0.1 * points[0].error);
    CHECK(points[2].error < 0.1 * points[1].error);
    CHECK(notes.empty());
}

TEST_CASE("peers that cannot do a case are not asked for values", "[bench][peers]") {
    std::vector<std::string> notes;
    const auto cases = with_peer("read q; echo '{\"settings\": []}'; exit 1", 10, notes);
    CHECK(cases[0].contenders.empty());
    std::vector<bench::BenchCase> spectral{bench::pipeline_suite().front()};
    const std::size_t before = spectral[0].contenders.size();
    bench::add_peer({"peer", "exit 1"}, 10, {}, spectral);  // no question is put: it never starts
    CHECK(spectral[0].contenders.size() == before);
}

TEST_CASE("a peer that fails has no point, and says why", "[bench][peers]") {
    struct Case {
        std::string command, reason;
    };
    const std::vector<Case> cases = {
        {shell_peer("exit 3"), "it has ended"},
        {shell_peer("echo nonsense"), "'nonsense' is no JSON object"},
        {shell_peer("echo '{\"values\": [1]}'"), "'seconds'"},
        {shell_peer("echo '{\"values\": [1], \"seconds\": -1}'"), "above 0"},
        {shell_peer("echo '{\"error\": \"no licence\"}'"), "no licence"},
        {shell_peer("sleep 60"), "no answer in 0.2 s"}};
    for (const auto& [command, reason] : cases) {
        CAPTURE(command);
        std::vector<std::string> notes;
        const auto with = with_peer(command, 0.2, notes);
        REQUIRE(with[0].contenders.size() == 1);
        CHECK(bench::measure(with[0]).empty());
        REQUIRE(notes.size() == 1);
        CHECK_THAT(notes[0], Catch::Contains("peer peer: ") && Catch::Contains(reason));
    }
}

TEST_CASE("an answer of the wrong length is infinitely wrong", "[bench][peers]") {
    std::vector<std::string> notes;
    const auto cases = with_peer(
        "while read q; do case \"$q\" in *settings*) echo '{\"settings\": [\"1\"]}';; *) echo "
        "'{\"values\": [1, 2], \"seconds\": 1}';; esac; done",
        10, notes);
    const auto points = bench::measure(cases[0], {.repeats = 1});
    REQUIRE(points.size() == 1);
    CHECK(std::isinf(points[0].error));
}

TEST_CASE("a peer that does not start is an error with its command", "[bench][peers]") {
    std::vector<std::string> notes;
    CHECK_THROWS_WITH(with_peer("/no/such/program 2>/dev/null", 5, notes),
                      Catch::Contains("/no/such/program") && Catch::Contains("settings"));
    for (const std::string bad : {"disort", "=run", "name="})
        CHECK_THROWS_AS(bench::parse_peer(bad), UsageError);
    CHECK(bench::parse_peer("a=b=c").command == "b=c");
}
