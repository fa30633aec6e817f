// Optics between the sizes of a lattice, against averages of their own.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/resolved_scene.h"
#include "pipeline/solve/size_lattice.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;

namespace {

ResolvedSpecies species_of(const std::string& words) {
    return resolve(support::scene_of(words), {550}).media.front().species.front();
}

OpticsDemand demand(bool whole) {
    OpticsDemand demand;
    demand.highest_moment = 32;
    demand.whole_phase_function = whole;
    demand.angles_deg = {10, 90, 170};
    demand.tolerance = 1e-4;
    return demand;
}

const mie::Executor kRun = mie::run_in_order;

}  // namespace

TEST_CASE("optics between the radii of a lattice are those of averages of their own",
          "[pipeline][lattice]") {
    // Cubic interpolation over half of the law's width; both averages err by their tolerance.
    constexpr double kError = 1e-3;
    const bool with_variance = GENERATE(false, true);
    const double radius = GENERATE(0.13, 0.71, 4.0);
    CAPTURE(with_variance, radius);
    const SizeLattice lattice(SizeLattice::kFineStep, {}, with_variance, nullptr);
    const auto species = species_of(
        fmt::format("index:1.5,0.01,radius={},variance=0.17,distribution=log-normal", radius));
    Control control;
    control.memo = make_optics_memo();
    const MediumOptics exact = compute_optics(species, 0, demand(true));
    const MediumOptics between = lattice.optics(species, 0, demand(true), control, kRun);
    CHECK(std::abs(between.optics.one_minus_albedo / exact.optics.one_minus_albedo - 1.0) <=
          kError);
    CHECK(between.optics.one_minus_albedo + between.optics.single_scattering_albedo == 1.0);
    CHECK(std::abs(*between.q_ext / *exact.q_ext - 1.0) <= kError);
    CHECK(std::abs(between.asymmetry - exact.asymmetry) <= kError);
    for (std::size_t l = 0; l <= 32 && l < exact.optics.chi.size(); ++l)
        CHECK(std::abs(between.optics.chi[l] - exact.optics.chi[l]) <= kError);
    // Single angles are known to the phase tolerance of demand_of, which is ten times as much.
    for (std::size_t a = 0; a < exact.phase.size(); ++a)
        CHECK(std::abs(between.phase[a] / exact.phase[a] - 1.0) <= 10.0 * kError);
    // Each of the two tables errs by 50 tolerances, rms: three times that of their difference.
    const double table_error = 3 * std::sqrt(2.0) * 50 * demand(true).tolerance;
    for (const double cosine : {-0.9, 0.0, 0.9})
        CHECK(std::abs(between.optics.phase(cosine) / exact.optics.phase(cosine) - 1.0) <=
              table_error);
}

TEST_CASE("sizes close to each other share their lattice", "[pipeline][lattice]") {
    Control control;
    control.memo = make_optics_memo();
    control.memo->lattice = std::make_shared<const SizeLattice>(
        SizeLattice::kFineStep, std::vector<mie::SizeDistribution>{}, false, nullptr);
    // 0.5 um and 1 % more are in one cell: the lattice has nodes at powers of exp(half a width).
    species_optics(control, species_of("index:1.5,0.01,radius=0.5,variance=0.2"), 0, demand(false),
                   kRun);
    CHECK(control.memo->found() == 0);
    species_optics(control, species_of("index:1.5,0.01,radius=0.505,variance=0.2"), 0,
                   demand(false), kRun);
    CHECK(control.memo->found() == 4);
}

TEST_CASE("shapes are given to spheres of the lattice", "[pipeline][lattice]") {
    const std::string grit = "index:1.6,0.001,variance=0.1,distribution=log-normal,";
    const std::string shape =
        GENERATE("phase=henyey-greenstein,absorption=1.6", "phase=double-henyey-greenstein");
    CAPTURE(shape);
    Control control;
    control.memo = make_optics_memo();
    control.memo->lattice = std::make_shared<const SizeLattice>(
        SizeLattice::kFineStep, std::vector<mie::SizeDistribution>{}, false, nullptr);
    const ResolvedSpecies grains = species_of(grit + "radius=3," + shape);
    const MediumOptics between = species_optics(control, grains, 0, demand(false), kRun);
    const MediumOptics exact = compute_optics(grains, 0, demand(false));
    // As of spheres.
    constexpr double kError = 1e-3;
    CHECK(std::abs(between.optics.one_minus_albedo / exact.optics.one_minus_albedo - 1.0) <=
          kError);
    CHECK(std::abs(*between.q_ext / *exact.q_ext - 1.0) <= kError);
    CHECK(std::abs(between.asymmetry - exact.asymmetry) <= kError);
    CHECK(std::abs(between.phase[1] / exact.phase[1] - 1.0) <= 10.0 * kError);
    CHECK(control.memo->found() == 0);
    // Another asymmetry changes nothing of the spheres.
    species_optics(control, species_of(grit + "radius=3.02," + shape + ",asymmetry=0.6"), 0,
                   demand(false), kRun);
    CHECK(control.memo->found() == 4);
}

TEST_CASE("spheres of one size, fixed sizes and analytic media are not interpolated",
          "[pipeline][lattice]") {
    const auto fixed = species_of("index:1.5,0.01,radius=0.5,variance=0.2");
    const SizeLattice lattice(SizeLattice::kFineStep, {fixed.sizes}, false, nullptr);
    CHECK_FALSE(lattice.covers(fixed, demand(false)));
    CHECK(lattice.covers(species_of("index:1.5,0.01,radius=0.51,variance=0.2"), demand(false)));
    CHECK_FALSE(
        lattice.covers(species_of("index:1.5,0.01,radius=0.7,distribution=mono"), demand(false)));
    CHECK_FALSE(lattice.covers(species_of("hg:0.9,0.5"), demand(false)));
    OpticsDemand polarised = demand(false);
    polarised.polarisation = true;
    CHECK_FALSE(lattice.covers(species_of("index:1.5,0.01,radius=0.51,variance=0.2"), polarised));
}
