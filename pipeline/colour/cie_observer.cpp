#include <miebrdf/colour.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace miebrdf {
namespace {

constexpr double kObserverStep_nm = 5.0;
constexpr int kObserverRows = 95;

/// x, y, z from 360 nm in steps of 5 nm: ISO/CIE 11664-1, as distributed by the Colour & Vision
/// Research Laboratory, University College London (ciexyz31). The trailing 0 and 9 are theirs.
// clang-format off
constexpr std::array<ColourMatching, kObserverRows> kObserver = {{
    {0.0001299, 0.000003917, 0.0006061}, {0.0002321, 0.000006965, 0.001086}, {0.0004149, 0.00001239, 0.001946},  // 360 nm
    {0.0007416, 0.00002202, 0.003486}, {0.001368, 0.000039, 0.006450001}, {0.002236, 0.000064, 0.01054999},  // 375 nm
    {0.004243, 0.00012, 0.02005001}, {0.00765, 0.000217, 0.03621}, {0.01431, 0.000396, 0.06785001},  // 390 nm
    {0.02319, 0.00064, 0.1102}, {0.04351, 0.00121, 0.2074}, {0.07763, 0.00218, 0.3713},  // 405 nm
    {0.13438, 0.004, 0.6456}, {0.21477, 0.0073, 1.0390501}, {0.2839, 0.0116, 1.3856},  // 420 nm
    {0.3285, 0.01684, 1.62296}, {0.34828, 0.023, 1.74706}, {0.34806, 0.0298, 1.7826},  // 435 nm
    {0.3362, 0.038, 1.77211}, {0.3187, 0.048, 1.7441}, {0.2908, 0.06, 1.6692},  // 450 nm
    {0.2511, 0.0739, 1.5281}, {0.19536, 0.09098, 1.28764}, {0.1421, 0.1126, 1.0419},  // 465 nm
    {0.09564, 0.13902, 0.8129501}, {0.05795001, 0.1693, 0.6162}, {0.03201, 0.20802, 0.46518},  // 480 nm
    {0.0147, 0.2586, 0.3533}, {0.0049, 0.323, 0.272}, {0.0024, 0.4073, 0.2123},  // 495 nm
    {0.0093, 0.503, 0.1582}, {0.0291, 0.6082, 0.1117}, {0.06327, 0.71, 0.07824999},  // 510 nm
    {0.1096, 0.7932, 0.05725001}, {0.1655, 0.862, 0.04216}, {0.2257499, 0.9148501, 0.02984},  // 525 nm
    {0.2904, 0.954, 0.0203}, {0.3597, 0.9803, 0.0134}, {0.4334499, 0.9949501, 0.008749999},  // 540 nm
    {0.5120501, 1, 0.005749999}, {0.5945, 0.995, 0.0039}, {0.6784, 0.9786, 0.002749999},  // 555 nm
    {0.7621, 0.952, 0.0021}, {0.8425, 0.9154, 0.0018}, {0.9163, 0.87, 0.001650001},  // 570 nm
    {0.9786, 0.8163, 0.0014}, {1.0263, 0.757, 0.0011}, {1.0567, 0.6949, 0.001},  // 585 nm
    {1.0622, 0.631, 0.0008}, {1.0456, 0.5668, 0.0006}, {1.0026, 0.503, 0.00034},  // 600 nm
    {0.9384, 0.4412, 0.00024}, {0.8544499, 0.381, 0.00019}, {0.7514, 0.321, 0.0001},  // 615 nm
    {0.6424, 0.265, 0.00004999999}, {0.5419, 0.217, 0.00003}, {0.4479, 0.175, 0.00002},  // 630 nm
    {0.3608, 0.1382, 0.00001}, {0.2835, 0.107, 0}, {0.2187, 0.0816, 0},  // 645 nm
    {0.1649, 0.061, 0}, {0.1212, 0.04458, 0}, {0.0874, 0.032, 0},  // 660 nm
    {0.0636, 0.0232, 0}, {0.04677, 0.017, 0}, {0.0329, 0.01192, 0},  // 675 nm
    {0.0227, 0.00821, 0}, {0.01584, 0.005723, 0}, {0.01135916, 0.004102, 0},  // 690 nm
    {0.008110916, 0.002929, 0}, {0.005790346, 0.002091, 0}, {0.004109457, 0.001484, 0},  // 705 nm
    {0.002899327, 0.001047, 0}, {0.00204919, 0.00074, 0}, {0.001439971, 0.00052, 0},  // 720 nm
    {0.0009999493, 0.0003611, 0}, {0.0006900786, 0.0002492, 0}, {0.0004760213, 0.0001719, 0},  // 735 nm
    {0.0003323011, 0.00012, 0}, {0.0002348261, 0.0000848, 0}, {0.0001661505, 0.00006, 0},  // 750 nm
    {0.000117413, 0.0000424, 0}, {0.00008307527, 0.00003, 0}, {0.00005870652, 0.0000212, 0},  // 765 nm
    {0.00004150994, 0.00001499, 0}, {0.00002935326, 0.0000106, 0}, {0.00002067383, 0.0000074657, 0},  // 780 nm
    {0.00001455977, 0.0000052578, 0}, {0.00001025398, 0.0000037029, 0}, {0.000007221456, 0.0000026078, 0},  // 795 nm
    {0.000005085868, 0.0000018366, 0}, {0.000003581652, 0.0000012934, 0}, {0.000002522525, 0.00000091093, 0},  // 810 nm
    {0.000001776509, 0.00000064153, 0}, {0.000001251141, 0.00000045181, 0},  // 825 nm
}};

struct Daylight {
    double mean, first, second;
};

/// S0, S1, S2 from 300 nm in steps of 10 nm: CIE 15:2004, table T.2.
constexpr double kDaylightFirst_nm = 300.0;
constexpr double kDaylightStep_nm = 10.0;
constexpr std::array<Daylight, 54> kDaylight = {{
    {0.04, 0.02, 0.0}, {6.0, 4.5, 2.0}, {29.6, 22.4, 4.0},  // 300 nm
    {55.3, 42.0, 8.5}, {57.3, 40.6, 7.8}, {61.8, 41.6, 6.7},  // 330 nm
    {61.5, 38.0, 5.3}, {68.8, 42.4, 6.1}, {63.4, 38.5, 3.0},  // 360 nm
    {65.8, 35.0, 1.2}, {94.8, 43.4, -1.1}, {104.8, 46.3, -0.5},  // 390 nm
    {105.9, 43.9, -0.7}, {96.8, 37.1, -1.2}, {113.9, 36.7, -2.6},  // 420 nm
    {125.6, 35.9, -2.9}, {125.5, 32.6, -2.8}, {121.3, 27.9, -2.6},  // 450 nm
    {121.3, 24.3, -2.6}, {113.5, 20.1, -1.8}, {113.1, 16.2, -1.5},  // 480 nm
    {110.8, 13.2, -1.3}, {106.5, 8.6, -1.2}, {108.8, 6.1, -1.0},  // 510 nm
    {105.3, 4.2, -0.5}, {104.4, 1.9, -0.3}, {100.0, 0.0, 0.0},  // 540 nm
    {96.0, -1.6, 0.2}, {95.1, -3.5, 0.5}, {89.1, -3.5, 2.1},  // 570 nm
    {90.5, -5.8, 3.2}, {90.3, -7.2, 4.1}, {88.4, -8.6, 4.7},  // 600 nm
    {84.0, -9.5, 5.1}, {85.1, -10.9, 6.7}, {81.9, -10.7, 7.3},  // 630 nm
    {82.6, -12.0, 8.6}, {84.9, -14.0, 9.8}, {81.3, -13.6, 10.2},  // 660 nm
    {71.9, -12.0, 8.3}, {74.3, -13.3, 9.6}, {76.4, -12.9, 8.5},  // 690 nm
    {63.3, -10.6, 7.0}, {71.7, -11.6, 7.6}, {77.0, -12.2, 8.0},  // 720 nm
    {65.2, -10.2, 6.7}, {47.7, -7.8, 5.2}, {68.6, -11.2, 7.4},  // 750 nm
    {65.0, -10.4, 6.8}, {66.0, -10.6, 7.0}, {61.0, -9.7, 6.4},  // 780 nm
    {53.3, -8.3, 5.5}, {58.9, -9.3, 6.1}, {61.9, -9.8, 6.5},  // 810 nm
}};
// clang-format on

/// Of the correlated colour temperature of D65. With these roundings, which the CIE prescribes, the
/// sum is the published table of D65 to its six digits.
constexpr double kM1 = -0.295;
constexpr double kM2 = -0.689;

double daylight_power(double wavelength_nm) {
    const double row = (wavelength_nm - kDaylightFirst_nm) / kDaylightStep_nm;
    const int below = std::clamp(static_cast<int>(row), 0, static_cast<int>(kDaylight.size()) - 2);
    const auto at = [](const Daylight& s) { return s.mean + kM1 * s.first + kM2 * s.second; };
    const double t = row - below;
    return (1.0 - t) * at(kDaylight[below]) + t * at(kDaylight[below + 1]);
}

double tungsten_power(double wavelength_nm) {
    constexpr double kExponent_nm = 1.435e7 / 2848.0;
    const double ratio = 560.0 / wavelength_nm;
    return 100.0 * std::pow(ratio, 5) * std::expm1(kExponent_nm / 560.0) /
           std::expm1(kExponent_nm / wavelength_nm);
}

}  // namespace

ColourMatching colour_matching(double wavelength_nm) {
    if (!(wavelength_nm >= kObserverShortest_nm && wavelength_nm <= kObserverLongest_nm)) return {};
    const double row = (wavelength_nm - kObserverShortest_nm) / kObserverStep_nm;
    const int first = std::clamp(static_cast<int>(row) - 1, 0, kObserverRows - 4);
    const double t = row - first;  // 1 <= t < 2 except at the ends
    const double weights[4] = {-(t - 1) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2,
                               -t * (t - 1) * (t - 3) / 2, t * (t - 1) * (t - 2) / 6};
    ColourMatching sum{};
    for (int i = 0; i < 4; ++i) {
        const ColourMatching& row_i = kObserver[first + i];
        sum.x += weights[i] * row_i.x;
        sum.y += weights[i] * row_i.y;
        sum.z += weights[i] * row_i.z;
    }
    return {std::max(0.0, sum.x), std::max(0.0, sum.y), std::max(0.0, sum.z)};
}

double relative_power(Illuminant illuminant, double wavelength_nm) {
    if (!(wavelength_nm >= kObserverShortest_nm && wavelength_nm <= kObserverLongest_nm)) {
        throw std::invalid_argument(fmt::format("illuminant at {} nm; allowed: {} to {} nm",
                                                wavelength_nm, kObserverShortest_nm,
                                                kObserverLongest_nm));
    }
    switch (illuminant) {
        case Illuminant::d65:
            return daylight_power(wavelength_nm);
        case Illuminant::a:
            return tungsten_power(wavelength_nm);
        case Illuminant::e:
            break;
    }
    return 100.0;
}

}  // namespace miebrdf
