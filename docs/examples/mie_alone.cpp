// Mie theory alone: one droplet of water, and a cloud of droplets of many sizes.
#include <miebrdf/ensemble.h>
#include <miebrdf/error.h>
#include <miebrdf/sphere.h>

#include <complex>
#include <iostream>
#include <numbers>
#include <vector>

namespace mie = miebrdf::mie;

int main() try {
    const std::complex<double> water = {1.333, 2e-9};  // n + ik, k >= 0
    const double wavelength_nm = 550, radius_nm = 5000;
    const std::vector<double> angles_deg = {0, 30, 90, 138, 180};  // 0 is forward

    const double size_parameter = 2 * std::numbers::pi * radius_nm / wavelength_nm;
    const mie::SphereOptics droplet = mie::scatter_by_sphere(water, size_parameter);
    std::cout << "droplet: extinction efficiency " << droplet.q_ext << ", absorption "
              << droplet.q_abs << ", asymmetry " << droplet.asymmetry << '\n';
    const mie::Amplitudes amplitudes =
        mie::scattering_amplitudes(water, size_parameter, angles_deg);

    mie::EnsembleRequest request;
    request.sizes = {.kind = mie::SizeDistributionKind::gamma,
                     .effective_radius_um = 5,
                     .effective_variance = 0.1};
    request.refractive_index = water;
    request.wavelength_nm = wavelength_nm;
    request.highest_moment = 4;
    request.angles_deg = angles_deg;
    const mie::EnsembleOptics cloud = mie::average_over_sizes(request);
    std::cout << "cloud: single-scattering albedo " << cloud.single_scattering_albedo
              << ", asymmetry " << cloud.asymmetry << ", Legendre moments";
    for (const double chi : cloud.chi) std::cout << ' ' << chi;

    std::cout << "\nangle_deg,droplet_phase,cloud_phase\n";
    for (std::size_t i = 0; i < angles_deg.size(); ++i) {
        // Unpolarised light; the mean of a phase function over the sphere is 1.
        const double intensity = std::norm(amplitudes.s1[i]) + std::norm(amplitudes.s2[i]);
        const double phase = 2 * intensity / (size_parameter * size_parameter * droplet.q_sca);
        std::cout << angles_deg[i] << ',' << phase << ',' << cloud.phase[i] << '\n';
    }
    return droplet.reached && cloud.converged ? 0 : 1;
} catch (const miebrdf::Error& error) {
    std::cerr << error.what() << '\n';
    return 2;
}
