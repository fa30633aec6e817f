#include <miebrdf/index.h>

#include <cmath>
#include <limits>

#include <miebrdf/error.h>
#include "materials/index/series.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using namespace miebrdf::materials;

namespace {

IndexTable silica_table(double step_nm) {
    const std::vector<double> malitson{0,         0.6961663, 0.0684043, 0.4079426,
                                       0.1162414, 0.8974794, 9.896161};
    IndexTable table;
    for (double w = 360; w <= 840; w += step_nm) {
        table.wavelength_nm.push_back(w);
        table.n.push_back(dispersion_formula(1, malitson, w / 1000));
        table.k.push_back(1e-3 * std::exp((400 - w) / 40));
    }
    return table;
}

}  // namespace

TEST_CASE("tabulated rows come back bit for bit", "[materials][index]") {
    const IndexTable table = silica_table(7.0);
    const RefractiveIndex index("silica", table);
    for (std::size_t i = 0; i < table.n.size(); ++i) {
        CHECK(index.at(table.wavelength_nm[i]).real() == table.n[i]);
        CHECK(index.at(table.wavelength_nm[i]).imag() == table.k[i]);
    }
    CHECK(index.table().n == table.n);
    CHECK(index.shortest_nm() == 360);
}

TEST_CASE("between rows PCHIP follows the dispersion it was sampled from", "[materials][index]") {
    // Against Malitson's formula itself. Inside, PCHIP is of third order in the spacing for n
    // (harmonic-mean slopes), of second in the end intervals: halving the step must divide the
    // worst error by 3 at least, and 5 nm steps leave less than 2e-6.
    const std::vector<double> malitson{0,         0.6961663, 0.0684043, 0.4079426,
                                       0.1162414, 0.8974794, 9.896161};
    const auto worst = [&](double step_nm) {
        const RefractiveIndex index("silica", silica_table(step_nm));
        double error = 0;
        for (double w = 361; w < 839; w += 0.7) {
            error = std::max(
                error, std::abs(index.at(w).real() - dispersion_formula(1, malitson, w / 1000)));
        }
        return error;
    };
    const double at_5 = worst(5), at_10 = worst(10);
    CAPTURE(at_5, at_10);
    CHECK(at_5 <= 8e-6);
    CHECK(at_5 <= at_10 / 3);
}

TEST_CASE("interpolation never overshoots and k never turns negative", "[materials][index]") {
    IndexTable step{
        {400, 410, 420, 430, 440, 450}, {1.5, 1.5, 1.5, 2.5, 2.5, 2.5}, {0, 0, 0, 1, 0, 0}};
    const RefractiveIndex index("step", step);
    for (double w = 400; w <= 450; w += 0.01) {
        const auto m = index.at(w);
        CHECK((m.real() >= 1.5 && m.real() <= 2.5));
        CHECK((m.imag() >= 0 && m.imag() <= 1));
    }
    CHECK(index.at(405).imag() == 0);
    CHECK(index.at(415).real() == 1.5);
}

TEST_CASE("tables of one, two and three rows work", "[materials][index]") {
    const RefractiveIndex one("one", {{500}, {1.5}, {0.1}});
    CHECK(one.at(500) == std::complex<double>(1.5, 0.1));
    CHECK_THROWS_AS(one.at(501), InputError);
    const RefractiveIndex two("two", {{400, 600}, {1.0, 2.0}, {0, 0}});
    // Linear in energy: the middle of 1/400 and 1/600 is 1/480.
    CHECK(two.at(480).real() == Approx(1.5).epsilon(1e-14));
    const RefractiveIndex three("three", {{400, 480, 600}, {1.0, 3.0, 2.0}, {0, 0, 0}});
    CHECK(three.at(480).real() == 3.0);
    CHECK(three.at(600).real() == 2.0);
}

TEST_CASE("interpolation can be chosen", "[materials][index]") {
    const auto n = make_table(Unit::nanometre, {400, 500, 600, 700}, {1.0, 2.0, 4.0, 5.0});
    const RefractiveIndex in_wavelength("x", n, std::nullopt,
                                        {.interpolation = Interpolation::linear_in_wavelength});
    CHECK(in_wavelength.at(550).real() == Approx(3.0).epsilon(1e-14));
    const RefractiveIndex in_energy("x", n, std::nullopt,
                                    {.interpolation = Interpolation::linear_in_energy});
    const double t = (1 / 550.0 - 1 / 600.0) / (1 / 500.0 - 1 / 600.0);
    CHECK(in_energy.at(550).real() == Approx(4.0 - 2.0 * t).epsilon(1e-14));
}

TEST_CASE("the last rounding of an end of the range is inside", "[materials][index]") {
    const RefractiveIndex index("x", IndexTable{{400, 826.5613226666667}, {1.5, 1.6}, {0, 0.1}});
    CHECK(index.covers(826.561322888));  // 1.5 eV with CODATA 2018
    CHECK(index.at(826.561322888) == std::complex<double>(1.6, 0.1));
    CHECK(index.covers(std::nextafter(400.0, 0.0)));
    CHECK_FALSE(index.covers(826.5614));
}

TEST_CASE("outside the data is an error with the asked and the valid range",
          "[materials][index][errors]") {
    const RefractiveIndex index("GaP", {{400, 500, 600}, {3, 3, 3}, {0, 0, 0}});
    CHECK_THROWS_AS(index.at(399.9), InputError);
    CHECK_THROWS_WITH(index.at(700), Catch::Contains("GaP") && Catch::Contains("700") &&
                                         Catch::Contains("400 to 600 nm"));
    CHECK_THROWS_AS(index.at(std::nan("")), InputError);
    CHECK_THROWS_AS(index.at(-1), InputError);

    const auto n = make_table(Unit::nanometre, {400, 600}, {1.5, 1.6});
    const RefractiveIndex other("GaP/a", n, std::nullopt, {},
                                {{"GaP/b", 650, 900}, {"GaP/c", 100, 300}});
    CHECK_THROWS_WITH(other.at(700),
                      Catch::Contains("GaP/b (650 to 900 nm)") && !Catch::Contains("GaP/c"));
}

TEST_CASE("clamping happens only on request", "[materials][index]") {
    const auto n = make_table(Unit::nanometre, {400, 600}, {1.5, 1.6});
    const RefractiveIndex index("x", n, std::nullopt, {.extrapolation = Extrapolation::clamp});
    CHECK(index.at(300).real() == 1.5);
    CHECK(index.at(900).real() == 1.6);
    CHECK_FALSE(index.covers(900));
    CHECK_THROWS_AS(index.at(std::nan("")), InputError);
}

TEST_CASE("n and k may have grids and ranges of their own", "[materials][index]") {
    const auto n = make_table(Unit::nanometre, {300, 800}, {1.5, 1.5});
    const auto k = make_table(Unit::electronvolt, {3.0, 2.5, 2.0}, {0.3, 0.25, 0.2});
    const RefractiveIndex index("x", n, k);
    CHECK(index.shortest_nm() == to_nm(3.0, Unit::electronvolt));
    CHECK(index.at(to_nm(2.25, Unit::electronvolt)).imag() == Approx(0.225).epsilon(1e-13));
    CHECK_THROWS_WITH(index.at(350), Catch::Contains("n is known from 300 to 800 nm, k is not"));
    const RefractiveIndex transparent("x", n, k, {.missing_k_is_zero = true});
    CHECK(transparent.at(350) == std::complex<double>(1.5, 0));

    const auto far = make_table(Unit::nanometre, {900, 1000}, {0.1, 0.1});
    CHECK_THROWS_WITH(RefractiveIndex("x", n, far), Catch::Contains("no wavelength in common"));
    CHECK_THROWS_WITH(RefractiveIndex("x", std::nullopt, k), Catch::Contains("k only"));
}

TEST_CASE("unknown k is not k = 0", "[materials][index]") {
    IndexTable table{{400, 500}, {1.5, 1.5}, {0, 0}, false};
    CHECK_FALSE(RefractiveIndex("x", table).k_known());
    CHECK(RefractiveIndex("x", table).at(450).imag() == 0);
    table.k_known = true;
    CHECK(RefractiveIndex("x", table).k_known());
    table = {{400, 500}, {1.5, 1.5}, {0, 0.1}, false};
    CHECK_THROWS_AS(RefractiveIndex("x", table), InputError);
}

TEST_CASE("tables that are no refractive index are refused", "[materials][index][errors]") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const IndexTable bad[] = {
        {{}, {}, {}},
        {{400}, {1.5, 1.5}, {0}},
        {{400, 500}, {1.5, 1.5}, {0}},
        {{500, 400}, {1.5, 1.5}, {0, 0}},
        {{400, 400}, {1.5, 1.5}, {0, 0}},
        {{400, 500}, {1.5, -1.5}, {0, 0}},
        {{400, 500}, {1.5, 0}, {0, 0}},
        {{400, 500}, {1.5, 1.5}, {0, -1e-9}},
        {{400, 500}, {1.5, nan}, {0, 0}},
        {{-1, 500}, {1.5, 1.5}, {0, 0}},
        {{400, nan}, {1.5, 1.5}, {0, 0}},
    };
    for (const IndexTable& table : bad) CHECK_THROWS_AS(RefractiveIndex("x", table), InputError);
    CHECK_THROWS_WITH(RefractiveIndex("GaP", bad[7]),
                      Catch::Contains("GaP") && Catch::Contains("500 nm"));
}
