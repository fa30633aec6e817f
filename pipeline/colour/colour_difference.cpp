// Distances between colours, and the words for how they are seen.
#include <miebrdf/colour.h>
#include <miebrdf/error.h>

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace miebrdf {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// In [0, 360); 0 for a grey, which has none.
double hue_deg(double a, double b) {
    if (a == 0.0 && b == 0.0) return 0.0;
    const double h = std::atan2(b, a) / kDegree;
    return h < 0.0 ? h + 360.0 : h;
}

struct NamedIlluminant {
    const char* name;
    Illuminant illuminant;
    const char* title;
};
constexpr NamedIlluminant kIlluminants[] = {{"d65", Illuminant::d65, "D65"},
                                            {"d50", Illuminant::d50, "D50"},
                                            {"a", Illuminant::a, "A"},
                                            {"e", Illuminant::e, "E (equal energy)"}};

}  // namespace

Viewing viewing(const std::string& text) {
    const std::size_t comma = text.find(',');
    const std::string light = text.substr(0, comma);
    const std::string eye = comma == std::string::npos ? "2" : text.substr(comma + 1);
    if (eye == "2" || eye == "10") {
        for (const NamedIlluminant& known : kIlluminants) {
            if (light == known.name)
                return {known.illuminant,
                        eye == "2" ? Observer::two_degrees : Observer::ten_degrees};
        }
    }
    throw UsageError(
        fmt::format("unknown illuminant and observer '{}'; allowed: d65, d50, a or e, then ,2 or "
                    ",10 for the observer's degrees, e.g. d65,10",
                    text));
}

std::string describe(const Viewing& viewing) {
    std::string title;
    for (const NamedIlluminant& known : kIlluminants) {
        if (known.illuminant == viewing.illuminant) title = known.title;
    }
    return title + (viewing.observer == Observer::two_degrees ? ", CIE 1931 2-degree observer"
                                                              : ", CIE 1964 10-degree observer");
}

Lch to_lch(const Lab& lab) { return {lab.l, std::hypot(lab.a, lab.b), hue_deg(lab.a, lab.b)}; }

double delta_e_76(const Lab& a, const Lab& b) {
    return std::hypot(a.l - b.l, a.a - b.a, a.b - b.b);
}

double delta_e_2000(const Lab& first, const Lab& second) {
    const auto [l, c, h] = delta_e_2000_parts(first, second);
    return std::hypot(l, c, h);
}

std::array<double, 3> delta_e_2000_parts(const Lab& first, const Lab& second) {
    // Symbols of Sharma, Wu & Dalal (2005), eq. 2 to 22.
    const double c_mean = 0.5 * (std::hypot(first.a, first.b) + std::hypot(second.a, second.b));
    const auto seventh = [](double c) {
        const double c7 = std::pow(c, 7);
        return std::sqrt(c7 / (c7 + std::pow(25.0, 7)));
    };
    const double g = 0.5 * (1.0 - seventh(c_mean));
    const double a1 = (1.0 + g) * first.a, a2 = (1.0 + g) * second.a;
    const double c1 = std::hypot(a1, first.b), c2 = std::hypot(a2, second.b);
    const double h1 = hue_deg(a1, first.b), h2 = hue_deg(a2, second.b);

    // A hue is missing where a chroma is 0: then neither differences nor means of hues count.
    const bool has_hues = c1 * c2 != 0.0;
    double dh = has_hues ? h2 - h1 : 0.0;
    if (dh > 180.0) dh -= 360.0;
    if (dh < -180.0) dh += 360.0;
    const double dl = second.l - first.l, dc = c2 - c1;
    const double dh_chord = 2.0 * std::sqrt(c1 * c2) * std::sin(0.5 * dh * kDegree);

    const double l = 0.5 * (first.l + second.l), c = 0.5 * (c1 + c2);
    double h = h1 + h2;
    if (has_hues) {
        if (std::abs(h1 - h2) > 180.0) h += h < 360.0 ? 360.0 : -360.0;
        h *= 0.5;
    }
    const auto cosine = [](double degrees) { return std::cos(degrees * kDegree); };
    const double t = 1.0 - 0.17 * cosine(h - 30.0) + 0.24 * cosine(2.0 * h) +
                     0.32 * cosine(3.0 * h + 6.0) - 0.20 * cosine(4.0 * h - 63.0);
    const double l50 = (l - 50.0) * (l - 50.0);
    const double s_l = 1.0 + 0.015 * l50 / std::sqrt(20.0 + l50);
    const double s_c = 1.0 + 0.045 * c, s_h = 1.0 + 0.015 * c * t;
    const double turn = (h - 275.0) / 25.0;
    const double rotation = -std::sin(60.0 * std::exp(-turn * turn) * kDegree) * 2.0 * seventh(c);
    const double x = dl / s_l, y = dc / s_c, z = dh_chord / s_h;
    // y^2 + z^2 + rotation y z as a sum of squares; |rotation| <= 2 sin 60 degrees < 2.
    return {x, y + 0.5 * rotation * z, z * std::sqrt(1.0 - 0.25 * rotation * rotation)};
}

}  // namespace miebrdf
