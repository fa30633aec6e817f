// Is a dataset sound, and is it plausible?
#pragma once

#include <string>
#include <vector>

#include "materials/database/database.h"
#include "materials/index/dataset.h"

namespace miebrdf::materials {

struct Finding {
    enum class Severity { note, warning, error };
    Severity severity = Severity::note;
    std::string dataset;  ///< "material/label"; empty when it concerns the database
    std::string text;
};

/// Checks of the figures alone: order, signs and finiteness (errors); values far off both
/// neighbours and formulas without a real value (warnings); agreement of n and k with the
/// Kramers-Kronig relation and k that is 0 throughout (notes).
std::vector<Finding> verify(const Dataset& dataset);

/// One dataset of a database, or (empty name) all of it: its integrity, checksums and every
/// dataset.
std::vector<Finding> verify(const Database& database, const std::string& name = {});

/// How well n follows from k by the Kramers-Kronig relation
///   n(E) = 1 + (2/pi) P integral of E' k(E') / (E'^2 - E^2) dE'
/// when absorption outside the table is allowed to add A + B E^2 + C / E^2 (the leading terms of
/// resonances above and below it), fitted by least squares: root mean square of what is left,
/// relative to that of n - mean(n). Small is consistent; near 1, k explains nothing of n's
/// dispersion. Evaluated on the middle 80 % of the range in energy.
/// Not a number when there are fewer than 10 rows, k is 0 throughout, n hardly varies (less than
/// 1e-3), or n or k is no table.
double kramers_kronig_residual(const Dataset& dataset);

}  // namespace miebrdf::materials
