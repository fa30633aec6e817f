// A start of a fit that cannot be computed, and the nearest that can.
#pragma once

#include <miebrdf/fit.h>

#include <functional>
#include <string>
#include <vector>

namespace miebrdf::fitting {

/// Numbers of unknowns, in their order.
using CanBe = std::function<bool(const std::vector<double>& numbers)>;

/// "; from r = 941 it can begin: ..." where the starts cannot be, but others within the bounds can:
/// one number is moved, or all. Empty where none that was tried can be. Asks `can_be` up to some
/// twenty times.
std::string start_that_works(const std::vector<Unknown>& unknowns, const CanBe& can_be);

/// Fitted number of an unknown at point `index` of a sequence that fills the bounds of all evenly
/// (the additive recurrence of the root of x^(d + 1) = x + 1, Roberts 2018), index >= 1.
double spread_number(const std::vector<Unknown>& unknowns, std::size_t unknown, int index);

}  // namespace miebrdf::fitting
