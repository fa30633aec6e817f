#include <miebrdf/index.h>

#include <iostream>

void show_index() {
    using namespace miebrdf::materials;
    std::cout << to_nm(2.25, Unit::electronvolt) << " nm, " << from_nm(550, Unit::micrometre) << ' '
              << name_of(Unit::micrometre) << '\n';
    const IndexTable rows{
        .wavelength_nm = {400, 500, 600, 700}, .n = {1.53, 1.52, 1.515, 1.51}, .k = {0, 0, 0, 0}};
    const RefractiveIndex glass("glass", rows);
    std::cout << glass.at(550).real() << " from " << glass.shortest_nm() << " to "
              << glass.longest_nm() << " nm; at 800 nm: " << glass.covers(800) << '\n';

    // n and k on grids of their own, clamped beyond them.
    const Series n = make_table(Unit::micrometre, {0.4, 0.7}, {1.6, 1.5});
    const Series k = make_table(Unit::micrometre, {0.45, 0.65}, {0.01, 0.02});
    const IndexOptions options{.interpolation = Interpolation::linear_in_wavelength,
                               .extrapolation = Extrapolation::clamp};
    const RefractiveIndex ink("ink", n, k, options, {Coverage{"ink/second", 380, 780}});
    std::cout << ink.at(500) << ", k known at 700 nm: " << ink.k_known_at(700) << '\n';

    IndexFunction cauchy;
    cauchy.at = [](double nm) { return 1.5 + 4e3 / (nm * nm); };
    cauchy.shortest_nm = 300;
    cauchy.longest_nm = 1000;
    cauchy.grid_nm = {300, 600, 1000};
    std::cout << RefractiveIndex("Cauchy", cauchy).table().n[1] << '\n';

    Dataset dataset;  // a table with its origin, as databases hold them
    dataset.material = "ink";
    dataset.n = n;
    const DatasetOrigin& origin = dataset;
    std::cout << origin.material << ": n at " << n.wavelengths_nm().size() << " wavelengths\n";
}
