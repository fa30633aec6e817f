#include "pipeline/scene/turbid_medium.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include <miebrdf/error.h>
#include "materials/readers/text_table.h"

extern "C" const char miebrdf_embedded_pastes[], miebrdf_embedded_pastes_end[];

namespace miebrdf {
namespace {

constexpr double kUmPerMm = 1e3;
constexpr double kWeightsAsVolumes = 1.0;  // one density of all pastes that are mixed by weight

/// Scattering and absorption per um of layer.
struct Coefficients {
    double scattering = 0.0, absorption = 0.0;

    double extinction() const { return scattering + absorption; }
};

/// Of coefficients that are given per mm, scattering reduced by 1 - g.
Coefficients per_um(double reduced_per_mm, double absorption_per_mm, double g) {
    return {reduced_per_mm / (1.0 - g) / kUmPerMm, absorption_per_mm / kUmPerMm};
}

class TurbidMedium : public GivenMedium {
  public:
    TurbidMedium(std::string name, double g, double density_g_cm3,
                 std::vector<double> wavelength_nm, std::vector<Coefficients> coefficients)
        : name_(std::move(name)),
          g_(g),
          density_g_cm3_(density_g_cm3),
          wavelength_nm_(std::move(wavelength_nm)),
          coefficients_(std::move(coefficients)) {}

    rte::Optics optics(double wavelength_nm) const override {
        const Coefficients at = this->at(wavelength_nm);
        const double extinction = at.extinction();
        rte::Optics optics =
            rte::henyey_greenstein_optics(extinction > 0.0 ? at.scattering / extinction : 0.0, g_);
        optics.one_minus_albedo = extinction > 0.0 ? at.absorption / extinction : 1.0;
        return optics;
    }
    double extinction(double wavelength_nm) const override {
        return at(wavelength_nm).extinction();
    }

    std::optional<double> density_g_cm3() const override {
        return density_g_cm3_ > 0.0 ? std::optional(density_g_cm3_) : std::nullopt;
    }

  private:
    Coefficients at(double nm) const {
        if (wavelength_nm_.empty()) return coefficients_.front();
        if (!(nm >= wavelength_nm_.front() && nm <= wavelength_nm_.back())) {
            throw InputError(fmt::format("paste '{}' has nothing at {} nm; it covers {} to {} nm",
                                         name_, nm, wavelength_nm_.front(), wavelength_nm_.back()));
        }
        if (wavelength_nm_.size() == 1) return coefficients_.front();
        const auto above =
            std::upper_bound(wavelength_nm_.begin() + 1, wavelength_nm_.end() - 1, nm);
        const auto i = static_cast<std::size_t>(above - wavelength_nm_.begin());
        const double t = (nm - wavelength_nm_[i - 1]) / (wavelength_nm_[i] - wavelength_nm_[i - 1]);
        const Coefficients &low = coefficients_[i - 1], &high = coefficients_[i];
        return {std::lerp(low.scattering, high.scattering, t),
                std::lerp(low.absorption, high.absorption, t)};
    }

    std::string name_;  ///< for messages
    double g_ = 0.0;
    double density_g_cm3_ = 0.0;         ///< 0: not known
    std::vector<double> wavelength_nm_;  ///< empty: the same at all
    std::vector<Coefficients> coefficients_;
};

/// Adds a row in 1/mm.
void add_row(double nm, double reduced, double absorption, double g, FileScattering& table) {
    const Coefficients at = per_um(reduced, absorption, g);
    table.wavelength_nm.push_back(nm);
    table.extinction.push_back(at.extinction());
    table.albedo.push_back(at.extinction() > 0.0 ? at.scattering / at.extinction() : 0.0);
}

/// Sets of rows `name,wavelength_nm,mu_s_reduced,mu_a` (pastes.csv), by name.
std::map<std::string, FileScattering> embedded_pastes() {
    materials::TextTable table({miebrdf_embedded_pastes, miebrdf_embedded_pastes_end},
                               "embedded pastes");
    table.next();
    table.take_names();
    std::map<std::string, FileScattering> all;
    while (table.next()) {
        const std::vector<std::string>& row = table.fields();
        add_row(table.number(row[1]), table.number(row[2]), table.number(row[3]), 0.0, all[row[0]]);
    }
    return all;
}

bool is_file(const std::string& name) { return name.find_first_of("./\\") != std::string::npos; }

void read_file(const std::string& path, Species& species) {
    const materials::NumberTable file(path);
    const auto by_volume = file.comment("volume"), by_weight = file.comment("weight");
    if (by_volume && by_weight) file.refuse("has '# volume' and '# weight'; allowed: one of them");
    const double share = by_volume.value_or(by_weight.value_or(1.0));
    if (!(share > 0.0 && share <= 1.0))
        file.refuse(fmt::format("is of a film with a share {}; allowed: above 0, up to 1", share));
    const double g = file.comment("g").value_or(0.0);
    if (!(g > -1.0 && g < 1.0))
        file.refuse(fmt::format("has an asymmetry '# g: {}'; allowed: (-1, 1)", g));
    const double density = file.comment("density").value_or(by_weight ? kWeightsAsVolumes : 0.0);
    species.parameters = {g, density};
    const std::vector<double>&nm = file.column("wavelength_nm"),
          &mu_s = file.column("mu_s_reduced");
    for (std::size_t row = 0; row < file.rows(); ++row) {
        const double mu_a = file.column("mu_a")[row];
        if (!(mu_s[row] >= 0.0 && mu_a >= 0.0 && std::isfinite(mu_s[row]) && std::isfinite(mu_a)))
            file.refuse(row, fmt::format("mu_s_reduced {} and mu_a {}; allowed: >= 0, in 1/mm",
                                         mu_s[row], mu_a));
        add_row(nm[row], mu_s[row] / share, mu_a / share, g, species.scattering);
    }
}

std::shared_ptr<const GivenMedium> medium_of_paste(const Species& species) {
    const FileScattering& table = species.scattering;
    std::vector<Coefficients> coefficients;
    for (std::size_t i = 0; i < table.extinction.size(); ++i)
        coefficients.push_back(
            {table.extinction[i] * table.albedo[i], table.extinction[i] * (1.0 - table.albedo[i])});
    return std::make_shared<TurbidMedium>(species.name, species.parameters[0],
                                          species.parameters[1], table.wavelength_nm,
                                          std::move(coefficients));
}

/// @throws UsageError  for lists that do not fit, and where nothing scatters or absorbs
void check_paste(const Species& species) {
    const FileScattering& table = species.scattering;
    const std::size_t count = table.wavelength_nm.size();
    if (count == 0 || table.extinction.size() != count || table.albedo.size() != count) {
        throw UsageError(
            fmt::format("{} wavelengths, {} extinctions and {} albedos; allowed: as "
                        "many of each, at least one",
                        count, table.extinction.size(), table.albedo.size()));
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (!(table.wavelength_nm[i] > (i == 0 ? 0.0 : table.wavelength_nm[i - 1])))
            throw UsageError("wavelength_nm", table.wavelength_nm[i], "above 0, ascending");
        if (!(table.extinction[i] > 0.0 && std::isfinite(table.extinction[i])))
            throw UsageError(
                fmt::format("nothing scatters or absorbs at {} nm; allowed: "
                            "mu_s_reduced + mu_a above 0, finite",
                            table.wavelength_nm[i]));
        if (!(table.albedo[i] >= 0.0 && table.albedo[i] <= 1.0))
            throw UsageError("albedo", table.albedo[i], "[0, 1]");
    }
}

/// @throws InputError  with file and line; for an unknown name, with the names that there are
void read_paste(const std::string& name, Species& species) {
    species.name = name;
    if (is_file(name)) {
        read_file(name, species);
    } else {
        std::map<std::string, FileScattering> all = embedded_pastes();
        const auto found = all.find(name);
        if (found == all.end()) {
            throw InputError(fmt::format(
                "paste '{}' is not one of the embedded set; allowed: {}; a file has a suffix or a "
                "slash, e.g. paste:{}.csv",
                name, fmt::join(embedded_paste_names(), ", "), name));
        }
        species.scattering = std::move(found->second);
        species.parameters = {0.0, kWeightsAsVolumes};
    }
    try {
        check_paste(species);
    } catch (const UsageError& error) {
        throw InputError(fmt::format("paste '{}': {}", name, error.what()));
    }
}

const MediumParameter kAsymmetry = {"asymmetry", "(-1, 1)",
                                    [](double g) { return g > -1.0 && g < 1.0; }};

/// What fills its layer has a share of it, and a density where that is a share of the mass.
Species without_share(Species rest) {
    rest.density_g_cm3.reset();
    rest.layer_density_kg_m3.reset();
    if (rest.amount && rest.amount->kind != Amount::Kind::number_per_cm3) rest.amount.reset();
    return rest;
}

}  // namespace

std::vector<std::string> embedded_paste_names() {
    std::vector<std::string> names;
    for (const auto& [name, table] : embedded_pastes()) names.push_back(name);
    return names;
}

MediumKind paste() {
    return {.kind = Species::Kind::paste,
            .name = "paste",
            .form = "paste:NAME or paste:FILE",
            .example = "paste:acrylic_white",
            .help =
                "a paint or pigment paste by its reduced scattering and absorption per mm, of the "
                "embedded set or from a CSV file with the columns wavelength_nm, mu_s_reduced, "
                "mu_a; amounts are shares of the film, all of it where none is said",
            .parameters = {kAsymmetry,
                           {"density in g/cm3", "0 (not known) to 30",
                            [](double density) { return density >= 0.0 && density <= 30.0; }}},
            .read = read_paste,
            .given = medium_of_paste,
            .has_extinction = true,
            .fills_layer = true,
            .without_own_keys = without_share,
            .own_keys = "pastes take volume= or mass=, and density=",
            .check = check_paste};
}

MediumKind turbid() {
    const auto is_coefficient = [](double mu) { return mu >= 0.0 && std::isfinite(mu); };
    return {.kind = Species::Kind::turbid,
            .name = "turbid",
            .form = "turbid:MU_A,MU_S_REDUCED,G",
            .example = "turbid:0.01,1.2,0.8",
            .help =
                "a medium by its absorption and reduced scattering per mm, and its asymmetry (0 "
                "where it is left out); it fills its layer, or a share of it",
            .parameters = {{"absorption per mm", ">= 0, finite", is_coefficient},
                           {"reduced scattering per mm", ">= 0, finite", is_coefficient},
                           {.name = kAsymmetry.name,
                            .allowed = kAsymmetry.allowed,
                            .is_allowed = kAsymmetry.is_allowed,
                            .by_default = 0.0}},
            .given = [](const Species& species) -> std::shared_ptr<const GivenMedium> {
                const std::vector<double>& p = species.parameters;
                return std::make_shared<TurbidMedium>(
                    species.name, p[2], 0.0, std::vector<double>{},
                    std::vector<Coefficients>{per_um(p[1], p[0], p[2])});
            },
            .has_extinction = true,
            .fills_layer = true,
            .without_own_keys = without_share,
            .own_keys = "turbid media take volume= or mass=, and density=",
            .check =
                [](const Species& species) {
                    if (species.parameters[0] + species.parameters[1] > 0.0) return;
                    throw UsageError(
                        "it neither scatters nor absorbs; allowed: MU_A + MU_S_REDUCED above 0");
                }};
}

}  // namespace miebrdf
