// Tables of n and k that are short, rough or at their end, and pipelines of 1 and 10,000
// wavelengths.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include <miebrdf/brdf.h>
#include <miebrdf/database.h>
#include <miebrdf/index.h>
#include "tools/stress/battery.h"

namespace miebrdf::stress {
namespace {

using materials::IndexTable;
using materials::RefractiveIndex;

// PCHIP may not leave the values at the ends of each interval.
double overshoot(const IndexTable& table) {
    const RefractiveIndex index("test", table);
    const auto out = [](double v, double a, double b) {
        return outside(v, std::min(a, b), std::max(a, b)) /
               std::max(std::abs(a), std::abs(b) + 1e-300);
    };
    double worst = 0;
    for (std::size_t i = 0; i + 1 < table.wavelength_nm.size(); ++i) {
        for (int step = 0; step <= 20; ++step) {
            const double t = step / 20.0;
            const auto m =
                index.at((1 - t) * table.wavelength_nm[i] + t * table.wavelength_nm[i + 1]);
            worst = std::max({worst, out(m.real(), table.n[i], table.n[i + 1]),
                              table.k[i] + table.k[i + 1] == 0
                                  ? m.imag()
                                  : out(m.imag(), table.k[i], table.k[i + 1])});
        }
    }
    return worst;
}

void check_table(Log& log, const std::string& name, const IndexTable& table) {
    const RefractiveIndex index("test", table);
    log.run(name, [&](const Case& is) {
        is.at_most("values outside those of the neighbouring rows, relative", overshoot(table),
                   1e-14, "monotone interpolation; rounding");
    });
    for (std::size_t i = 0; i < table.wavelength_nm.size(); ++i) {
        log.run(fmt::format("{}, row {}", name, i), [&](const Case& is) {
            const auto m = index.at(table.wavelength_nm[i]);
            is.at_most("n and k at a row",
                       std::abs(m.real() - table.n[i]) + std::abs(m.imag() - table.k[i]),
                       1e-13 * (1 + table.n[i]), "tabulated values come back; rounding");
        });
    }
    log.refused(name + ", just above the last row",
                [&] { index.at(table.wavelength_nm.back() * (1 + 1e-6)); });
    log.refused(name + ", just below the first row",
                [&] { index.at(table.wavelength_nm.front() * (1 - 1e-6)); });
}

void check_tables(Log& log) {
    check_table(log, "two rows", {{400, 700}, {1.5, 1.6}, {0, 1e-3}});
    check_table(log, "three rows", {{400, 500, 700}, {1.5, 3, 1.6}, {0, 1, 1e-3}});
    check_table(log, "a jump of n over 1e-6 nm",
                {{400, 500, 500.000001, 600, 700}, {1.5, 1.5, 4, 4, 4}, {0, 0, 2, 2, 2}});
    check_table(log, "k over twelve decades",
                {{300, 400, 500, 600, 700}, {2, 2, 2, 2, 2}, {10, 1e-3, 1e-11, 1e-3, 10}});
    check_table(log, "k = 0 and n = 1",
                {{300, 400, 500, 600, 700}, {1, 1, 1, 1, 1}, {0, 0, 0, 0, 0}});
    check_table(log, "a spike", {{300, 499, 500, 501, 700}, {1, 1, 100, 1, 1}, {0, 0, 100, 0, 0}});
    const RefractiveIndex one("test", {{550}, {1.5}, {0.25}});
    log.run("one row", [&](const Case& is) {
        is.at_most("n and k there", std::abs(one.at(550) - std::complex<double>(1.5, 0.25)), 0,
                   "no arithmetic");
    });
    log.refused("one row, elsewhere", [&] { one.at(551); });
}

// The ends of a real table, on them and just beyond: the last rounding still belongs to them.
void check_ends(Log& log) {
    const RefractiveIndex table = materials::Database::embedded().refractive_index("TiO2");
    for (const bool first : {true, false}) {
        const double end = first ? table.shortest_nm() : table.longest_nm();
        log.run(fmt::format("TiO2 at the end of its table, {} nm", end), [&](const Case& is) {
            const auto m = table.at(end);
            is.at_most("n or k not physical", !(m.real() > 0 && m.imag() >= 0), 0, "physics");
        });
        log.refused(fmt::format("TiO2 just beyond {} nm", end),
                    [&] { table.at(end * (first ? 1 - 1e-6 : 1 + 1e-6)); });
    }
}

void check_many_wavelengths(Log& log, std::size_t count) {
    log.run(fmt::format("{} wavelengths of a grey medium", count), [&](const Case& is) {
        std::vector<double> wavelengths(count);
        for (std::size_t i = 0; i < count; ++i) wavelengths[i] = 300 + 0.1 * double(i);
        Scene scene;
        scene.base = medium("hg:0.9,0.5");
        const auto slices =
            solve(scene, wavelengths, {}, {.threads = 1}).evaluate({{0.5}, {0.7}, {30}}).slices;
        const auto different = std::count_if(slices.begin(), slices.end(), [&](const auto& slice) {
            return slice.total != slices.front().total;
        });
        is.at_most("slices that differ", double(different), 0,
                   "the same optics give the same bits");
        is.at_most("slices missing", std::abs(double(slices.size()) - double(count)), 0,
                   "one for each");
    });
}

}  // namespace

void materials(Log& log, bool fast) {
    check_tables(log);
    check_ends(log);
    for (const std::size_t count : {1, 2, fast ? 1000 : 10000}) check_many_wavelengths(log, count);
}

}  // namespace miebrdf::stress
