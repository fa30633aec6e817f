#include "pipeline/scene/size_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <miebrdf/error.h>
#include "materials/readers/text_table.h"
#include "pipeline/scene/number_list.h"
#include "pipeline/scene/species_keys.h"

namespace miebrdf {
namespace {

using Kind = mie::SizeDistributionKind;

constexpr std::array<Unit, 3> kSpecificSurfaces = {
    {{"m2/kg", 1, 1}, {"cm2/g", 1, 10}, {"m2/g", 1000, 1}}};

/// A quantile of the standard normal distribution: 90 % lie below.
constexpr double kNinetyPercent = 1.2815515655446004;

/// Reads the words of one species.
class Reader {
  public:
    Reader(const SizeWords& words, const std::string& text) : words_(words), text_(text) {}

    [[noreturn]] void refuse(const std::string& reason, const std::string& advice) const {
        throw UsageError(fmt::format("medium '{}': {}; write {}", text_, reason, advice));
    }
    bool has(const char* name) const { return words_.count(name) > 0; }
    bool has_any(std::initializer_list<const char*> names) const {
        return std::any_of(names.begin(), names.end(), [&](const char* n) { return has(n); });
    }
    double length_um(const char* name) const {
        return parse_length_um(words_.at(name), what(name));
    }
    double number(const char* name) const { return parse_number(words_.at(name), what(name)); }
    std::string what(const char* name) const { return fmt::format("medium '{}': {}", text_, name); }
    const std::string& value(const char* name) const { return words_.at(name); }

  private:
    const SizeWords& words_;
    const std::string& text_;
};

/// By number, area, volume or mass.
std::string measure(const Reader& read, const char* by_default) {
    const std::string by = read.has("by") ? read.value("by") : by_default;
    for (const char* known : {"number", "area", "volume", "mass"}) {
        if (by == known) return by;
    }
    read.refuse(fmt::format("by '{}'; allowed: number, area, volume, mass", by), "by=volume");
}

/// Effective radius and variance of a log-normal law. With s = ln sigma_g and the median r by
/// number, the mean of r^3 over the mean of r^2 is r exp(5/2 s^2), the variance exp(s^2) - 1
/// (Hansen & Travis 1974, eq. 2.60); medians by area and by volume are r exp(2 s^2), r exp(3 s^2)
/// (Hatch & Choate, J. Franklin Inst. 207, 369 (1929)).
void set_log_normal(double median_um, double s, const std::string& by, ParticleSizes& sizes) {
    const double power = by == "number" ? 2.5 : by == "area" ? 0.5 : -0.5;
    sizes.effective_radius_um = median_um * std::exp(power * s * s);
    sizes.effective_variance = std::expm1(s * s);
    sizes.distribution = Kind::log_normal;
}

constexpr double kLargestSigma = 4.5;  // a variance of 9.6

void require_sigma(const Reader& read, double sigma_g, const char* advice) {
    if (!(sigma_g > 1.0 && sigma_g <= kLargestSigma))
        read.refuse(
            fmt::format("sigma_g {:.4g}; allowed: above 1, up to {}", sigma_g, kLargestSigma),
            advice);
}

void set_median(const Reader& read, ParticleSizes& sizes) {
    const char* advice =
        "median=0.1,sigma_g=1.6 (by=volume where the median is not that of numbers)";
    if (!read.has("median") || !read.has("sigma_g"))
        read.refuse("median and sigma_g belong together", advice);
    const double sigma_g = read.number("sigma_g");
    require_sigma(read, sigma_g, advice);
    set_log_normal(read.length_um("median"), std::log(sigma_g), measure(read, "number"), sizes);
}

/// The log-normal law whose diameters have these quantiles: with all three, d50 is the median and
/// the width that of d90 / d10.
void set_quantiles(const Reader& read, ParticleSizes& sizes) {
    const char* advice = "d50=300nm,d90=450nm (diameters, by volume unless by= says otherwise)";
    const bool d10 = read.has("d10"), d50 = read.has("d50"), d90 = read.has("d90");
    if (int(d10) + int(d50) + int(d90) + int(read.has("sigma_g")) < 2 || read.has("median"))
        read.refuse("two of d10, d50, d90 (or d50 and sigma_g) make a distribution", advice);
    double s = 0.0;
    if (read.has("sigma_g")) {
        if (d10 || d90 || !d50)
            read.refuse("sigma_g goes with d50 and no other of d10, d90", advice);
        s = std::log(read.number("sigma_g"));
    } else if (d10 && d90) {
        s = 0.5 * std::log(read.length_um("d90") / read.length_um("d10")) / kNinetyPercent;
    } else {
        s = std::log(d90 ? read.length_um("d90") / read.length_um("d50")
                         : read.length_um("d50") / read.length_um("d10")) /
            kNinetyPercent;
    }
    require_sigma(read, std::exp(s), advice);
    const double median =
        d50 ? read.length_um("d50") : std::sqrt(read.length_um("d10") * read.length_um("d90"));
    set_log_normal(0.5 * median, s, measure(read, "volume"), sizes);
}

void set_junge(const Reader& read, ParticleSizes& sizes) {
    const char* advice = "junge=4,from=0.1,to=10 (n(r) ~ r^-4 between these radii)";
    if (!read.has("junge") || !read.has("from") || !read.has("to"))
        read.refuse("Junge's law has an exponent and two limits", advice);
    sizes.distribution = Kind::junge;
    sizes.exponent = read.number("junge");
    sizes.radii_um = {read.length_um("from"), read.length_um("to")};
}

/// A quantity per class of sizes, as a density in r: classes meet halfway, in ratios.
void divide_by_widths(const std::vector<double>& radius_um, std::vector<double>& values) {
    const std::size_t count = radius_um.size();
    for (std::size_t i = 0; i < count; ++i) {
        const double below = i > 0 ? std::sqrt(radius_um[i - 1] * radius_um[i])
                                   : radius_um[0] * std::sqrt(radius_um[0] / radius_um[1]);
        const double above = i + 1 < count
                                 ? std::sqrt(radius_um[i] * radius_um[i + 1])
                                 : radius_um[i] * std::sqrt(radius_um[i] / radius_um[i - 1]);
        values[i] /= above - below;
    }
}

}  // namespace

const std::vector<std::string>& size_word_names() {
    static const std::vector<std::string> names = {"median", "sigma_g", "by", "d10", "d50",  "d90",
                                                   "junge",  "from",    "to", "ssa", "sizes"};
    return names;
}

void read_sizes(const std::string& file, ParticleSizes& sizes) {
    const materials::NumberTable table(file);
    struct Column {
        const char* name;
        double factor;  // to radii in um; or the power of r that a density of numbers has more
        bool is_class = false;
    };
    constexpr Column kRadii[] = {
        {"radius_um", 1}, {"radius_nm", 1e-3}, {"diameter_um", 0.5}, {"diameter_nm", 0.5e-3}};
    constexpr Column kDensities[] = {{"number_density", 0},   {"dn_dlnr", 1},
                                     {"dv_dlnr", 4},          {"number_share", 0, true},
                                     {"area_share", 2, true}, {"volume_share", 3, true}};
    const auto find = [&](const auto& columns, const char* what) {
        std::vector<std::string> names;
        for (const Column& column : columns) {
            if (table.find(column.name) != nullptr) return column;
            names.emplace_back(column.name);
        }
        table.refuse(
            fmt::format("has no {}; allowed: one of the columns {}", what, fmt::join(names, ", ")));
    };
    const Column radii = find(kRadii, "sizes"), amounts = find(kDensities, "amounts");
    table.require_names({radii.name, amounts.name});
    sizes.file = file;
    sizes.distribution = Kind::tabulated;
    sizes.radii_um = table.column(radii.name);
    sizes.number_density = table.column(amounts.name);
    for (double& radius : sizes.radii_um) radius *= radii.factor;
    mie::SizeDistribution checked{.kind = Kind::tabulated,
                                  .radii_um = sizes.radii_um,
                                  .number_density = sizes.number_density};
    try {
        mie::radius_range(checked);
    } catch (const UsageError& error) {
        table.refuse(error.what());
    }
    if (amounts.is_class) divide_by_widths(sizes.radii_um, sizes.number_density);
    for (std::size_t i = 0; i < sizes.radii_um.size(); ++i)
        sizes.number_density[i] /= std::pow(sizes.radii_um[i], amounts.factor);
}

void set_sizes(const SizeWords& words, Species& species, const std::string& text) {
    if (words.empty()) return;
    const Reader read(words, text);
    ParticleSizes& sizes = species.sizes;
    const bool quantiles = read.has_any({"d10", "d50", "d90"});
    const bool median = !quantiles && read.has_any({"median", "sigma_g", "by"});
    const bool junge = read.has_any({"junge", "from", "to"});
    const int ways =
        int(quantiles) + int(median) + int(junge) + int(read.has("ssa")) + int(read.has("sizes"));
    const bool own_law =
        sizes.effective_variance || (sizes.distribution && (junge || read.has("sizes"))) ||
        ((quantiles || median) && sizes.distribution && *sizes.distribution != Kind::log_normal);
    if (ways > 1 || sizes.effective_radius_um || (own_law && !read.has("ssa"))) {
        std::vector<std::string> names;
        for (const auto& [name, value] : words) names.push_back(name);
        read.refuse(
            fmt::format("{} say radius, variance and distribution", fmt::join(names, " and ")),
            "one of radius=, median=, d50=, junge=, ssa=, sizes=");
    }
    if (quantiles) {
        set_quantiles(read, sizes);
    } else if (median) {
        set_median(read, sizes);
    } else if (junge) {
        set_junge(read, sizes);
    } else if (read.has("ssa")) {
        if (!species.coatings.empty())
            read.refuse("ssa is for particles without coatings", "radius=");
        sizes.specific_surface_m2_per_kg =
            parse_quantity(read.value("ssa"), read.what("ssa"), kSpecificSurfaces);
    } else {
        read_sizes(read.value("sizes"), sizes);
    }
}

}  // namespace miebrdf
