// The numbers that a report page shows: BRDF, albedos, colours and single scattering of scenes.
#pragma once

#include <miebrdf/brdf.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/report/packed.h"

namespace miebrdf::report {

/// The page says these in words: name and text.
using Facts = std::vector<std::pair<std::string, std::string>>;

/// One member of a family of scenes: the scene itself where nothing is varied.
struct Variant {
    Brdf brdf;
    std::string label = {};  ///< "optical depth 0.5"
    double value = 0.0;      ///< of what is varied
    /// The page says these of how it was solved.
    std::function<Facts(const ResultReport&)> facts = {};
};

/// A scene, or one that is solved several times with one of its numbers varied.
struct ReportScene {
    std::string name;         ///< short, unique on the page
    std::string description;  ///< in one line
    std::string varied = {};  ///< "optical depth of the top layer"; empty: nothing is varied
    std::vector<Variant> variants = {};  ///< at least one, all at the same wavelengths
};

/// Largest interpolation error that a page aims at, relative to the largest value at an incidence.
inline constexpr double kPageTolerance = 8e-4;

struct ReportData {  // NOLINT(bugprone-exception-escape): moving JSON does not throw
    nlohmann::json root;
    PageBytes bytes;                      ///< the arrays that it names
    std::vector<std::string> shortfalls;  ///< what did not converge, and why; empty: all did
    double interpolation_error =
        0.0;  ///< largest of all scenes (CompactTable::interpolation_error)
};

/// A whole scene without sizes and amounts: "Au (optical depth 0.5) on TiO2".
std::string label_of(Scene scene);

/// A preview is within about 3e-2 of the largest value at an incidence, without an estimate of its
/// error, without glories, and without "facts", "omissions" and "media".
enum class PageDetail { whole, preview };

/// Solves every variant and collects what the page shows.
/// @throws UsageError, InputError, Cancelled  as solve() and Brdf::table()
ReportData collect(const std::vector<ReportScene>& scenes, const Control& control,
                   PageDetail detail = PageDetail::whole);

/// How spectra at these wavelengths become colours under each illuminant; null where the
/// wavelengths do not cover the visible.
nlohmann::json colour_weights(const std::vector<double>& wavelength_nm);

/// Degrees at which albedos are given: 0, 1, ..., 89.
const std::vector<double>& albedo_angles_deg();

}  // namespace miebrdf::report
