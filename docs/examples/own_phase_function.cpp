// Radiative transfer alone: a layer with a phase function of one's own over a white ground.
#include <miebrdf/error.h>
#include <miebrdf/transfer.h>

#include <cmath>
#include <iostream>
#include <vector>

namespace rte = miebrdf::rte;

int main() try {
    // P = 1 + 3 chi_1 cos Theta + 5 chi_2 P_2(cos Theta): its Legendre moments are all of it.
    rte::Optics haze;
    haze.single_scattering_albedo = 0.95;
    haze.one_minus_albedo = 0.05;
    haze.chi = {1.0, 0.3, 0.12};

    rte::Stack stack;
    stack.base_kind = rte::BaseKind::lambertian;
    stack.ground_albedo = 0.8;
    stack.coats = {{haze, 1.5}};  // optical depth
    const rte::Directions directions{{0.5}, {0.2, 0.6, 1.0}, {0, 90, 180}};

    const rte::ReflectionTable table = rte::reflect(stack, directions, {.tolerance = 1e-4});
    std::cout << "mu_out,azimuth_deg,brdf\n";
    std::size_t next = 0;
    for (const double mu_out : directions.mu_out)
        for (const double azimuth : directions.azimuth_deg)
            std::cout << mu_out << ',' << azimuth << ','
                      << table.reflection[next++] / std::acos(-1.0) << '\n';
    const rte::AlbedoTable albedo = rte::albedo(stack, directions.mu_in, {.tolerance = 1e-4});
    std::cout << "plane albedo " << albedo.plane_albedo[0] << ", into the ground "
              << albedo.transmittance[0] << '\n';
    return table.report.converged && albedo.report.converged ? 0 : 1;
} catch (const miebrdf::Error& error) {
    std::cerr << error.what() << '\n';
    return 2;
}
