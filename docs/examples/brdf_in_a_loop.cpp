// A BRDF in the inner loop of a renderer: a painted sphere in parallel light.
//
// The scene is solved once; the table is then asked for every pixel. Writes sphere.ppm.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iostream>
#include <numbers>
#include <vector>

namespace {

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Light and viewer above a surface, as the BRDF is asked for them. All are unit vectors that point
/// away from the surface.
miebrdf::Direction direction(const Vector& normal, const Vector& light, const Vector& viewer) {
    // Azimuth 0 is the mirror side: the viewer opposite to the light.
    const double mu_in = dot(normal, light), mu_out = dot(normal, viewer);
    const double along = dot(light, viewer) - mu_in * mu_out;
    const double across = dot(normal, cross(light, viewer));
    return {mu_in, mu_out, std::atan2(across, -along) * 180.0 / std::numbers::pi};
}

/// Linear to the picture's byte, with the transfer curve of sRGB nearly.
char byte(double radiance) {
    return static_cast<char>(
        std::lround(255.0 * std::pow(std::clamp(radiance, 0.0, 1.0), 1 / 2.2)));
}

void render(const miebrdf::BrdfSource& brdf, std::ostream& file) {
    constexpr int kSize = 200;
    constexpr Vector kViewer = {0, 0, 1}, kLight = {0.6, 0.48, 0.64};
    constexpr double kIrradiance = 3.0;
    const std::size_t channels = brdf.channels().size();  // three: see main()
    std::vector<miebrdf::Direction> directions;
    std::vector<int> columns;
    std::vector<double> values;
    file << "P6\n" << kSize << ' ' << kSize << "\n255\n";
    for (int row = 0; row < kSize; ++row) {
        // All the directions of a row are asked for at once; one at a time is allowed, too.
        directions.clear();
        columns.clear();
        for (int column = 0; column < kSize; ++column) {
            const double x = (2 * column + 1.0) / kSize - 1, y = 1 - (2 * row + 1.0) / kSize;
            if (x * x + y * y >= 1) continue;
            const Vector normal = {x, y, std::sqrt(1 - x * x - y * y)};
            if (dot(normal, kLight) <= 0) continue;  // the light is below this surface
            directions.push_back(direction(normal, kLight, kViewer));
            columns.push_back(column);
        }
        values.resize(directions.size() * channels);
        brdf.evaluate(directions, values);

        std::vector<char> line(3 * kSize, 0);
        for (std::size_t i = 0; i < directions.size(); ++i) {
            for (std::size_t c = 0; c < channels; ++c) {
                // The cosine is never hidden in a BRDF's value.
                const double radiance =
                    values[i * channels + c] * directions[i].mu_in * kIrradiance;
                line[3 * static_cast<std::size_t>(columns[i]) + c] = byte(radiance);
            }
        }
        file.write(line.data(), static_cast<std::streamsize>(line.size()));
    }
}

}  // namespace

int main() try {
    miebrdf::Scene scene;
    scene.base = miebrdf::medium("TiO2,radius=0.5");
    scene.layers = {miebrdf::layer("Au,radius=0.05@0.5")};
    scene.surface = miebrdf::rte::SurfaceOptions{.beckmann_alpha = 0.3};

    const miebrdf::Brdf brdf = miebrdf::solve(scene, {620, 535, 480});  // red, green, blue
    const miebrdf::BrdfTable table = brdf.table();
    std::cout << table.provenance().title << ": " << table.report().summary() << '\n';

    std::ofstream file("sphere.ppm", std::ios::binary);
    render(table, file);
    return table.report().converged() && file ? 0 : 1;
} catch (const miebrdf::Error& error) {
    std::cerr << error.what() << '\n';
    return 2;
}
