// Values that are not there: how files say so, for all readers.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/reader.h"

namespace miebrdf::measured {
namespace {

constexpr std::string_view kWords[] = {
    "",        "nan",     "-nan",    "n/a",      "na",        "null",     "none",
    "nil",     "missing", "-",       "--",       "---",       "?",        ".",
    "*",       "inf",     "+inf",    "-inf",     "#n/a",      "#na",      "#value!",
    "#div/0!", "#num!",   "#null!",  "nan(ind)", "-nan(ind)", "1.#qnan",  "1.#ind",
    "-1.#ind", "1.#inf",  "-1.#inf", "overflow", "infinity",  "-infinity"};

/// Libraries mark deleted channels with -1.23e34, NetCDF with 9.97e36, others with 1e20 and 1e30.
constexpr double kBeyond = 1e19;
constexpr double kFewestNines = 99.0;

}  // namespace

bool is_fill(double number) {
    if (!(std::abs(number) < kBeyond)) return true;
    if (!(number <= -kFewestNines)) return false;
    // -999, -9999, -999.99, -99.9: nothing but nines, at least three.
    const double thousandths = std::round(-number * 1000.0);
    if (std::abs(thousandths + number * 1000.0) > 1e-6 * thousandths) return false;
    std::string digits = std::to_string(static_cast<long long>(thousandths));
    digits.erase(digits.find_last_not_of('0') + 1);
    return digits.size() >= 3 && digits.find_first_not_of('9') == std::string::npos;
}

bool says_missing(std::string_view field) {
    const std::string word = materials::lower_case(field);
    if (std::find(std::begin(kWords), std::end(kWords), word) != std::end(kWords)) return true;
    const auto number = materials::table_number(word);
    return number && is_fill(*number);
}

std::optional<double> measured_number(std::string_view field) {
    if (says_missing(field)) return MeasuredValue::kNone;
    return materials::table_number(field);
}

}  // namespace miebrdf::measured
