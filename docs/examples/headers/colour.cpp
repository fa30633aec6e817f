#include <miebrdf/colour.h>

#include <iostream>

void show_colour() {
    using namespace miebrdf;
    const std::vector<double> nm = {400, 440, 480, 520, 560, 600, 640, 680};
    const std::vector<double> reflectance = {0.05, 0.06, 0.08, 0.1, 0.2, 0.6, 0.8, 0.8};
    const Viewing viewing{Illuminant::d50, Observer::ten_degrees};  // also viewing("d50,10")
    std::cout << describe(viewing) << ", enough wavelengths: " << covers_the_visible(nm) << '\n';

    const Colorimeter colorimeter(nm, viewing);
    const Colour colour = colorimeter(reflectance);
    const auto bytes = to_srgb8(colour.srgb);
    std::cout << "L* " << colour.lab.l << ", hue " << colour.lch.h_deg << " degrees, sRGB "
              << int{bytes[0]} << ' ' << int{bytes[1]} << ' ' << int{bytes[2]} << " under "
              << describe(colorimeter.viewing()) << '\n';

    // The same, step by step.
    const ObserverWeights weights = observer_weights(nm, viewing, Between::cubic);
    const Xyz xyz = to_xyz(weights, reflectance);
    const Lab lab = to_lab(xyz, viewing), white = to_lab(white_point(viewing), viewing);
    const Lch lch = to_lch(lab);
    const LinearSrgb linear = to_linear_srgb(xyz, viewing);
    std::cout << "chroma " << lch.c << ", red " << encode_srgb(linear.red) << "; from white "
              << delta_e_2000(lab, white) << " (1976: " << delta_e_76(lab, white) << "), of that "
              << delta_e_2000_parts(lab, white)[0] << " by lightness\n";
    const ColourMatching eye = colour_matching(555, viewing.observer);
    std::cout << "y(555 nm) = " << eye.y << ", D50 there "
              << relative_power(viewing.illuminant, 555) << " of 100\n";

    Scene film;
    film.layers = {layer("hg:0.99,0.6@10[grey]")};
    const Drawdown drawdown = draw_down(film, nm, {1.0}, DrawdownOptions{});
    const Hiding& from_above = drawdown.hiding.front();
    std::cout << "contrast ratio " << from_above.contrast_ratio << ", hides at "
              << from_above.relative_depth.value_or(0) << " times its depth\n";

    Scene varnish;
    say(varnish, "substrate", {"black"});
    say(varnish, "host-index", {"1.5"});
    say(varnish, "boundary", {"smooth"});
    const GlossValues shine = gloss(solve(varnish, {550}));
    for (const Gloss& at : shine.angles)
        std::cout << at.units << " gloss units at " << at.angle_deg << " degrees\n";
    std::cout << "red in ACEScg " << to_acescg(xyz, viewing)[0] << '\n';
}
