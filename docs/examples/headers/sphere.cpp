#include <miebrdf/sphere.h>

#include <iostream>

void show_sphere() {
    using namespace miebrdf::mie;
    const SphereOptics glass = scatter_by_sphere({1.5, 0.01}, 10.0);
    std::cout << "Q_ext " << glass.q_ext << ", g " << glass.asymmetry << ", " << glass.terms
              << " partial waves\n";
    const Coefficients waves = mie_coefficients({1.5, 0.01}, 10.0);
    const Amplitudes seen = scattering_amplitudes(waves, std::vector{0.0, 90.0, 180.0});
    std::cout << "a_1 " << waves.a[0] << ", S1(90) " << seen.s1[1] << ", cos(60) "
              << cosine_of_scattering_angle(60.0) << '\n';
    // From the core outwards: relative index, size parameter.
    const std::vector<SphereLayer> coated = {{{1.5, 0.01}, 10.0}, {{1.33, 0.0}, 12.0}};
    std::cout << "coated: Q_ext " << scatter_by_sphere(coated).q_ext << '\n';
}
