#include <miebrdf/ensemble.h>

#include <iostream>

void show_ensemble() {
    using namespace miebrdf::mie;
    EnsembleRequest request;
    request.sizes = {.effective_radius_um = 0.2, .effective_variance = 0.1};
    request.refractive_index = {2.6, 0.0};
    request.host_index = 1.5;
    request.highest_moment = 8;
    request.with_phase_table = true;
    require_average(request);  // what it refuses it refuses at once
    const EnsembleOptics rutile = average_over_sizes(request, run_in_order);
    const PhaseTable& phase = *rutile.phase_table;
    std::cout << "g " << rutile.asymmetry << ", " << rutile.chi.size() << " moments, P(0) "
              << phase(1.0) << " within " << phase.noise(1.0) << ", stored at "
              << phase.angle_count() << " angles\n";
    std::cout << "degrees up to " << highest_moment_of(request) << " matter\n";

    request.angles_deg = {90};
    const PhaseValues aside = phase_at_angles(request, rutile.q_sca);
    std::cout << "P(90) = " << aside.phase[0] << " +- " << aside.error[0] << '\n';

    require_matrix(request);
    std::cout << "the scattering matrix will take " << matrix_seconds(request) << " s\n";
    const MatrixOptics polarised = average_matrix(request);
    std::cout << polarised.expansion.a2.size() << " coefficients of a2\n";

    EnsembleRequest smaller = request, larger = request;
    smaller.sizes.effective_radius_um *= 0.999;
    larger.sizes.effective_radius_um *= 1.001;
    const EnsembleDifference by_radius =
        differences_of_averages(request, {EnsembleChange{larger, smaller}},
                                DifferenceDemand{.highest_moment = 2})
            .front();
    std::cout << "dg/d ln r = " << by_radius.asymmetry / 0.002 << '\n';

    std::cout << "a thousandth more radius changes it by "
              << difference_between(average_over_sizes(request), average_over_sizes(larger))
              << '\n';

    request.coatings = {ParticleCoating{.refractive_index = 1.46, .thickness_um = 0.01}};
    std::cout << "under silica: Q_ext " << average_over_sizes(request).q_ext << '\n';
}
