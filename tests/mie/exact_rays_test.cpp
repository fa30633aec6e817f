// P at listed angles by rays: far ones in closed form, and whole spheres at sharp ends.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/ensemble/far_rays.h"
#include "mie/ensemble/paired_size_samples.h"
#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/ray_average.h"
#include "mie/ensemble/ray_columns.h"
#include "mie/ensemble/size_sums.h"
#include "mie/sphere/radial_functions.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using Complex = std::complex<double>;
using Kind = mie::SizeDistributionKind;

TEST_CASE("glories by rays are those of whole spheres, however many sizes there are",
          "[mie][rays]") {
    mie::EnsembleRequest request;
    request.sizes.effective_radius_um = 53.27;
    request.sizes.effective_variance = 0.105;
    request.refractive_index = Complex(1.494, 4.75e-4);
    const mie::Ensemble ensemble = mie::ensemble_of(request);
    const auto phase = [&](mie::PhaseMethod method, int last_level) -> Eigen::VectorXd {
        mie::PairedSizeSamples samples(ensemble, method);
        std::vector<mie::PairedIntensity> parts;
        for (int level = 0; level <= last_level; ++level) {
            const auto more = samples.levels(std::vector<int>(samples.part_count(), level),
                                             {180, 179.9, 179.5}, false, mie::run_in_order);
            if (level == 0) parts = more;
            for (std::size_t i = 0; level > 0 && i < parts.size(); ++i)
                parts[i] = samples.with_level(parts[i], more[i]);
        }
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(3);
        double scattered = 0;
        for (const mie::PairedIntensity& part : parts) {
            sum += part.intensity.rowwise().sum();
            scattered += part.scattered[0] + part.scattered[1];
        }
        return sum / scattered;
    };
    const Eigen::VectorXd whole = phase(mie::PhaseMethod::sizes, 5);
    // Some 460 sizes of each group leave what their weights do not know of; then it is single
    // precision. With orders left out at the edges: 9e-4, more with more sizes.
    for (const auto& [last_level, bound] : {std::pair(4, 2e-4), std::pair(6, 1e-5)}) {
        const Eigen::VectorXd by_rays = phase(mie::PhaseMethod::exact_rays, last_level);
        CAPTURE(last_level, whole.transpose(), by_rays.transpose());
        CHECK((by_rays - whole).cwiseAbs().cwiseQuotient(whole).maxCoeff() <= bound);
    }
}

TEST_CASE("far rays in closed form are the sum of the rays one by one", "[mie][rays]") {
    const Complex m = GENERATE(Complex(1.5, 5e-4), Complex(2.6, 5e-4));
    const mie::WeightedSizes sizes = [] {
        mie::WeightedSizes s;
        for (int i = 0; i < 11; ++i) {
            s.parameters.push_back(90 + 13.7 * i);
            s.weights.push_back(1e-4 * (1 + i));
        }
        return s;
    }();
    const mie::AngularFunctionsOf<float> angular(std::vector<double>{0.5, 20, 90, 170, 179.6, 180},
                                                 mie::number_of_terms(sizes.parameters.back()));
    constexpr int first = 17, last = 800;
    const auto far = mie::intensity_of_far_rays(m, first, sizes, 0, 11, angular);
    Eigen::VectorXd one_by_one = Eigen::VectorXd::Zero(6);
    double scattered = 0;
    for (int way = first; way <= last; ++way) {
        const mie::RayGroup group{way, way};
        mie::SphereBlockOf<float> block;
        mie::RayColumns columns{&group, &block};
        mie::put_rays(m, sizes, 0, 11, {&columns, 1});
        angular.add_intensity(block, one_by_one);
        scattered += columns.scattered;
    }
    // The intensity of whole spheres: what is left out shall not show beside it.
    Eigen::VectorXd whole = Eigen::VectorXd::Zero(6);
    mie::SphereBlockOf<float> block;
    mie::compute_spheres(m, sizes.parameters, sizes.weights, &block);
    angular.add_intensity(block, whole);
    CAPTURE(m, whole.transpose(), far.at_angles.transpose(), one_by_one.transpose());
    // Orders left out at both ends, 1e-7 of the light that meets the spheres each; scattered is
    // twice a sum.
    double light = 0;
    for (std::size_t i = 0; i < sizes.parameters.size(); ++i)
        light += sizes.weights[i] * sizes.parameters[i] * sizes.parameters[i];
    CHECK(scattered > 1e-6 * light);
    CHECK(std::abs(far.scattered - scattered) <= 5e-7 * light);
    for (Eigen::Index i = 0; i < 6; ++i)
        CHECK(std::abs(far.at_angles[i] - one_by_one[i]) <= 1e-3 * whole[i]);
}

TEST_CASE("P at listed angles by rays is within its stated error", "[mie][rays][honesty]") {
    // Absorption widens every resonance, so that a sum over spheres is the truth to 1e-6.
    mie::EnsembleRequest request;
    request.sizes.effective_radius_um = 1;
    request.sizes.effective_variance = 0.15;
    request.sizes.kind = GENERATE(Kind::power_law, Kind::gamma);
    const double x = 520;
    request.wavelength_nm = 2000 * EIGEN_PI / x;
    request.refractive_index = GENERATE(Complex(1.6, 3e-4), Complex(2.7, 4e-4));
    request.angles_deg = {180, 179.8, 178, 172, 160, 137, 110, 70, 30, 8};
    request.tolerance = 2e-4;
    request.phase_tolerance = GENERATE(3e-3, 2e-4);
    const mie::Ensemble problem = mie::ensemble_of(request);
    REQUIRE(mie::phase_ray_bias(problem, true).everywhere > 0);

    const double k = problem.wave_number_per_um;
    mie::SizeSumOptions sums;
    sums.terms = mie::number_of_terms(k * problem.range.largest_um);
    const mie::AngularTables functions = mie::AngularFunctions(request.angles_deg, sums.terms);
    sums.angles = &functions;
    const auto spheres = mie::sum_over_sizes(
        problem.scatterer,
        mie::WeightedSizes(mie::even_size_nodes(problem.sizes, problem.range, 12000, 0.3), k), sums,
        mie::run_in_order);
    const auto values = mie::phase_at_angles(request, 0.0);
    int beyond = 0, missed = 0;
    for (std::size_t i = 0; i < request.angles_deg.size(); ++i) {
        const double exact = spheres.intensity[Eigen::Index(i)] / (2 * spheres.spheres.scattered);
        CAPTURE(name_of(request.sizes.kind), request.refractive_index, request.angles_deg[i], exact,
                values.phase[i], values.error[i]);
        const double error = std::abs(values.phase[i] - exact);
        // Twice an rms.
        beyond += error <= values.error[i] ? 0 : 1;
        CHECK(error <= 2 * values.error[i]);
        // What is stated is relative to the value.
        missed += values.error[i] <= request.phase_tolerance * values.phase[i] ? 0 : 1;
    }
    CHECK(beyond <= 1);
    // Dark angles of tight tolerances end at the finest level.
    CHECK(missed <= (request.phase_tolerance > 1e-3 ? 0 : 3));
}
