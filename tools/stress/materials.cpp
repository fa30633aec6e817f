// Tables of n and k that are short, rough or at their end, and pipelines of 1 and 10,000
// wavelengths.
#include <fmt/format.h>

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
    double worst = 0;
    for (std::size_t i = 0; i + 1 < table.wavelength_nm.size(); ++i) {
        for (int step = 0; step <= 20; ++step) {
            const double t = step / 20.0;
            const double wavelength =
                (1 - t) * table.wavelength_nm[i] + t * table.wavelength_nm[i + 1];
            const auto m = index.at(wavelength);
            const auto out = [&](double v, double a, double b) {
                return outside(v, std::min(a, b), std::max(a, b)) /
                       std::max(std::abs(a), std::abs(b) + 1e-300);
            };
            worst = std::max({worst, out(m.real(), table.n[i], table.n[i + 1]),
                              table.k[i] + table.k[i + 1] == 0
                                  ? m.imag()
                                  : out(m.imag(), table.k[i], table.k[i + 1])});
        }
    }
    return worst;
}

void check_tables(Log& log) {
    const std::pair<const char*, IndexTable> tables[] = {
        {"two rows", {{400, 700}, {1.5, 1.6}, {0, 1e-3}}},
        {"three rows", {{400, 500, 700}, {1.5, 3, 1.6}, {0, 1, 1e-3}}},
        {"a jump of n over 1e-6 nm",
         {{400, 500, 500.000001, 600, 700}, {1.5, 1.5, 4, 4, 4}, {0, 0, 2, 2, 2}}},
        {"k over twelve decades",
         {{300, 400, 500, 600, 700}, {2, 2, 2, 2, 2}, {10, 1e-3, 1e-11, 1e-3, 10}}},
        {"k = 0 and n = 1", {{300, 400, 500, 600, 700}, {1, 1, 1, 1, 1}, {0, 0, 0, 0, 0}}},
        {"a spike", {{300, 499, 500, 501, 700}, {1, 1, 100, 1, 1}, {0, 0, 100, 0, 0}}}};
    for (const auto& [name, table] : tables) {
        const std::string test_case = name;
        log.run(test_case, [&, table = table] {
            log.at_most(test_case, "values outside those of the neighbouring rows, relative",
                        overshoot(table), 1e-14, "monotone interpolation; rounding");
            const RefractiveIndex index("test", table);
            for (std::size_t i = 0; i < table.wavelength_nm.size(); ++i) {
                const auto m = index.at(table.wavelength_nm[i]);
                log.at_most(fmt::format("{}, row {}", test_case, i), "n and k at a row",
                            std::abs(m.real() - table.n[i]) + std::abs(m.imag() - table.k[i]),
                            1e-13 * (1 + table.n[i]), "tabulated values come back; rounding");
            }
            log.refused(test_case + ", just above the last row",
                        [&] { index.at(table.wavelength_nm.back() * (1 + 1e-6)); });
            log.refused(test_case + ", just below the first row",
                        [&] { index.at(table.wavelength_nm.front() * (1 - 1e-6)); });
        });
    }
    log.run("one row", [&] {
        const RefractiveIndex one("test", {{550}, {1.5}, {0.25}});
        log.at_most("one row", "n and k there",
                    std::abs(one.at(550) - std::complex<double>(1.5, 0.25)), 0, "no arithmetic");
        log.refused("one row, elsewhere", [&] { one.at(551); });
    });
}

void check_many_wavelengths(Log& log, const Options& options) {
    for (const int count : {1, 2, options.fast ? 1000 : 10000}) {
        const std::string name = fmt::format("{} wavelengths of a grey medium", count);
        log.run(name, [&] {
            std::vector<double> wavelengths(static_cast<std::size_t>(count));
            for (int i = 0; i < count; ++i) {
                wavelengths[static_cast<std::size_t>(i)] = 300 + 0.1 * i;
            }
            Scene scene;
            scene.base = medium("hg:0.9,0.5");
            const auto result =
                solve(scene, wavelengths, {}, {.threads = 1}).evaluate({{0.5}, {0.7}, {30}});
            double different = 0;
            for (const auto& slice : result.slices) {
                different += slice.total != result.slices.front().total;
            }
            log.at_most(name, "slices that differ", different, 0,
                        "the same optics give the same bits");
            log.at_most(name, "slices missing", std::abs(double(result.slices.size()) - count), 0,
                        "one for each");
        });
    }
}

// The ends of a real table, on them and just beyond: the last rounding still belongs to them.
void check_ends(Log& log) {
    const RefractiveIndex table = materials::Database::embedded().refractive_index("TiO2");
    for (const double end : {table.shortest_nm(), table.longest_nm()}) {
        const std::string name = fmt::format("TiO2 at the end of its table, {} nm", end);
        log.run(name, [&] {
            const auto m = table.at(end);
            log.at_most(name, "n or k not physical", !(m.real() > 0 && m.imag() >= 0), 0,
                        "physics");
        });
        const double beyond = end == table.shortest_nm() ? end * (1 - 1e-6) : end * (1 + 1e-6);
        log.refused(fmt::format("TiO2 just beyond {} nm", end), [&] { table.at(beyond); });
    }
}

}  // namespace

void materials(const Options& options, std::vector<Check>& checks) {
    Log log("materials", checks);
    check_tables(log);
    log.run("ends of tables", [&] { check_ends(log); });
    check_many_wavelengths(log, options);
}

}  // namespace miebrdf::stress
