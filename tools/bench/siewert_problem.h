// A medium with a strong b2 that several programs have solved: problem IIA of Siewert 2000 (JQSRT
// 64, 227). Tests and the bench suite `stokes` solve it.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>

#include <miebrdf/optics.h>

namespace miebrdf::bench {

/// @param table  rte/stokes_siewert_2000.csv: size(), number(row, column)
template <typename Table>
rte::Optics siewert_optics(const Table& table, bool with_b2) {
    rte::Optics optics;
    optics.single_scattering_albedo = 0.973527;
    optics.one_minus_albedo = 1.0 - 0.973527;
    optics.chi.clear();
    rte::Polarisation p;
    for (std::size_t l = 0; l < table.size(); ++l) {
        optics.chi.push_back(table.number(l, "a1") / (2.0 * double(l) + 1.0));
        p.a2.push_back(table.number(l, "a2"));
        p.a3.push_back(table.number(l, "a3"));
        p.a4.push_back(table.number(l, "a4"));
        p.b1.push_back(table.number(l, "b1"));
        if (with_b2) p.b2.push_back(table.number(l, "b2"));
    }
    optics.polarisation = std::make_shared<const rte::Polarisation>(std::move(p));
    return optics;
}

}  // namespace miebrdf::bench
