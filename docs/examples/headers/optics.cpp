#include <miebrdf/optics.h>

#include <iostream>

void show_optics() {
    using namespace miebrdf::rte;
    const Optics air = rayleigh_optics(1.0, 0.0279), haze = henyey_greenstein_optics(0.95, 0.7);
    const Optics both = mix({{air, 0.1}, {haze, 0.3}});  // MixtureComponent: optics, extinction
    const MixedPhase phase{{air, haze}, {0.25, 0.75}};   // by shares of the scattering
    std::cout << "albedo " << both.single_scattering_albedo << ", g " << both.chi[1] << ", P(0) "
              << phase(1.0) << '\n';
    const Polarisation& polarised = *air.polarisation;
    Polarisation exact = polarised;  // its matrix beside the series, for narrow features
    exact.matrix = [](double c) {
        return ScatteringMatrix{.a1 = 0.75 * (1 + c * c), .b1 = -0.75 * (1 - c * c)};
    };
    std::cout << "b1 at 90 degrees " << exact.matrix(0.0).b1 << ", b1_2 " << polarised.b1[2]
              << '\n';

    Stack stack;
    stack.base_kind = BaseKind::lambertian;
    stack.ground_albedo = 0.3;
    stack.coats = {Coat{isotropic_optics(0.9), 1.0, /*index*/ 1.5}, Coat{both, 0.4, 1.5}};
    stack.boundary = Boundary{};
    validate(stack);  // @throws UsageError
    std::cout << "index under the air " << top_index(stack) << '\n';
}
