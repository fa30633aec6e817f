#include "pipeline/solve/shared_work.h"

#include "pipeline/plan/plan.h"
#include "pipeline/solve/brdf.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

/// Spheres under one paint or another.
Request painted(const std::string& coat) {
    Request request;
    request.scene.base = parse_medium("index:1.5,0.01");
    request.scene.coats = {parse_coat(coat)};
    request.scene.particles.sizes.effective_radius_um = 1;
    request.wavelength_nm = {450, 550};
    request.directions = {{0.3, 1.0}, {0.2, 0.9}, {0.0, 70.0, 180.0}};
    request.solver.streams = 16;
    return request;
}

const std::vector<std::string> kCoats = {"hg:0.5,0.5@0.3", "index:2.2,0.001@0.1",
                                         "isotropic:0.9@1"};

/// The totals of every result of one run.
std::vector<std::vector<double>> run(const std::vector<Request>& requests, RunControl control) {
    std::vector<std::vector<double>> totals;
    for (const Request& request : requests) {
        for (const SpectralSlice& slice : compute_brdf(request, control).slices) {
            totals.push_back(slice.total);
        }
    }
    return totals;
}

std::vector<Request> results() {
    std::vector<Request> requests;
    for (const std::string& coat : kCoats) requests.push_back(painted(coat));
    return requests;
}

}  // namespace

TEST_CASE("coats on one base share its spheres, to the same bits on any number of threads",
          "[pipeline][shared]") {
    const auto alone = run(results(), {.threads = 1});
    for (const int threads : {1, 2, 7}) {
        SharedWork shared;
        for (const Request& request : results()) shared.expect(request, LayerQuantity::reflection);
        RunControl control{.threads = threads};
        control.shared = &shared;
        CAPTURE(threads);
        CHECK(run(results(), control) == alone);
        // Two wavelengths, the second and the third result.
        CHECK(shared.optics_found() == 4);
        // After the last of them nothing is kept.
        CHECK(shared.free_bytes() == SharedWork::kDefaultLimit_bytes);
    }
}

TEST_CASE("Mie theory of what results have in common runs once, with no cache at all",
          "[pipeline][shared]") {
    SharedWork shared;
    for (const Request& request : results()) shared.expect(request, LayerQuantity::reflection);
    RunControl control{.threads = 1};
    control.shared = &shared;
    run({results()[0]}, control);
    CHECK(shared.free_bytes() < SharedWork::kDefaultLimit_bytes);
    CHECK(shared.optics_found() == 0);
    run({results()[1]}, control);
    CHECK(shared.optics_found() == 2);
}

TEST_CASE("what no later result uses is not kept, and no more than the limit",
          "[pipeline][shared]") {
    SECTION("one result alone") {
        SharedWork shared;
        shared.expect(results()[0], LayerQuantity::reflection);
        RunControl control{.threads = 1};
        control.shared = &shared;
        run({results()[0]}, control);
        CHECK(shared.free_bytes() == SharedWork::kDefaultLimit_bytes);
    }
    SECTION("no room") {
        SharedWork shared(1000);
        for (const Request& request : results()) shared.expect(request, LayerQuantity::reflection);
        RunControl control{.threads = 1};
        control.shared = &shared;
        CHECK(run(results(), control) == run(results(), {.threads = 1}));
        CHECK(shared.free_bytes() == 1000);
    }
}

TEST_CASE("after an interrupted result the others are what they would have been",
          "[pipeline][shared]") {
    SharedWork shared;
    for (const Request& request : results()) shared.expect(request, LayerQuantity::reflection);
    std::atomic<bool> cancelled = false;
    RunControl control{.threads = 1};
    control.shared = &shared;
    control.cancelled = &cancelled;
    control.progress = [&](const std::string& stage, std::size_t, std::size_t) {
        if (stage == "radiative transfer") cancelled = true;  // after the first wavelength
    };
    CHECK_THROWS_AS(run({results()[0]}, control), Cancelled);
    cancelled = false;
    control.progress = {};
    CHECK(run(results(), control) == run(results(), {.threads = 1}));
}
