#include <miebrdf/measured.h>

#include <cmath>
#include <fstream>
#include <iostream>

void show_measured() {
    using namespace miebrdf;
    std::ofstream("paint.csv") << "wavelength_nm,reflectance\n450,12\n550,35\n650,60\n";
    MeasuredOptions options;
    options.percent = true;
    options.sigma = 0.005;
    const Measurements paint = read_measured("paint.csv", options);
    for (const MeasuredValue& value : paint.values)
        std::cout << value.wavelength_nm << " nm: " << value.value << " +- " << value.sigma << '\n';
    for (const std::string& doubt : paint.doubts) std::cout << doubt << '\n';
    for (const MeasuredFormat& format : measured_formats()) std::cout << format.name << ' ';

    const MeasuredKind kind = measured_kind("d8-sci");
    std::cout << '\n'
              << word_of(kind.quantity) << ' ' << word_of(kind.geometry)
              << (is_share(kind.quantity) ? ", a share\n" : "\n");

    // What an integrating sphere reads of a sample that returns half of the light.
    SphereMeasurement spheres;
    spheres.above = IntegratingSphere{.diameter_mm = 150, .sample_port_mm = 20, .wall = 0.97};
    spheres.below = spheres.above;  // of transmittances
    set_sphere_word(spheres, "detector_port", 10);
    spheres.rows = {SphereRow{.wavelength_nm = 550, .wall_above = 0.97}};
    validate(spheres);
    const SlabLight sample{.r_direct = 0.5, .r_diffuse = 0.55};
    std::cout << sphere_reading(spheres.at(550), false, sample) << " in the sphere\n";

    // Directions become a BRDF that can be exported and rendered.
    Measurements goniometer;
    goniometer.samples = {"disc"};
    for (const double mu_in : {0.4, 0.7, 1.0}) {
        for (const double mu_out : {0.3, 0.6, 0.9}) {
            for (const double azimuth : {0.0, 90.0, 180.0}) {
                MeasuredValue value;
                value.quantity = MeasuredQuantity::brdf;
                value.geometry = MeasuredGeometry::directions;
                value.wavelength_nm = 550;
                value.mu_in = mu_in, value.mu_out = mu_out, value.azimuth_deg = azimuth;
                value.value = 0.2 / (mu_in + mu_out);
                goniometer.values.push_back(value);
            }
        }
    }
    const InterpolatedBrdf disc = interpolated_brdf(goniometer);
    std::vector<double> between(1);
    disc.source->evaluate(std::vector{Direction{0.5, 0.5, 45.0}}, between);
    std::cout << "made of " << disc.values << " values; " << between[0]
              << " / sr, left out: " << disc.leave_one_out_rms << '\n';
}
