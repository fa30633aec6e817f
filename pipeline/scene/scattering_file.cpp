#include "pipeline/scene/scattering_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <regex>
#include <sstream>

#include <miebrdf/error.h>
#include "materials/readers/text_table.h"
#include "pipeline/scene/moments_file.h"
#include "pipeline/scene/species_keys.h"
#include "rte/math/quadrature.h"

namespace miebrdf {
namespace {

constexpr double kNmPerUm = 1e3;
constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
    throw InputError(fmt::format("scattering file '{}' {}", path, reason));
}

std::string text_of_file(const std::string& path) {
    std::ifstream in(path);
    if (!in) refuse(path, "cannot be opened");
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// The numbers of a line up to the first word that is none; Fortran's D is an E.
std::vector<double> numbers_in(std::string line) {
    std::replace(line.begin(), line.end(), 'D', 'E');
    std::istringstream in(line);
    std::vector<double> numbers;
    for (double number; in >> number;) numbers.push_back(number);
    return numbers;
}

/// Component files of OPAC: rows of spectra behind `#`, then a row for each angle.
void read_opac(const std::string& path, const std::string& text, FileScattering& table) {
    constexpr std::size_t kSpectrumColumns = 9;  // wavelength, ext, sca, abs, albedo, g, ...
    constexpr double kUm2 = 1e3;                 // 1/km of one particle in a cm3
    std::istringstream in(text);
    bool in_spectra = false;
    for (std::string line; std::getline(in, line);) {
        if (line.find("optical parameters") != std::string::npos) in_spectra = true;
        if (line.find("phase function") != std::string::npos) in_spectra = false;
        const bool is_comment = line.starts_with('#');
        const std::vector<double> row = numbers_in(is_comment ? line.substr(1) : line);
        if (is_comment && in_spectra && row.size() == kSpectrumColumns) {
            table.wavelength_nm.push_back(kNmPerUm * row[0]);
            table.extinction.push_back(kUm2 * row[1]);
            table.albedo.push_back(row[2] / row[1]);
        } else if (!is_comment && row.size() == table.wavelength_nm.size() + 1) {
            table.angles_deg.push_back(row[0]);
            table.phase.resize(table.wavelength_nm.size());
            for (std::size_t w = 0; w + 1 < row.size(); ++w) table.phase[w].push_back(row[w + 1]);
        } else if (!is_comment && !row.empty()) {
            refuse(path, fmt::format("has a row of {} numbers at angle {}; expected: the angle and "
                                     "one for each of {} wavelengths",
                                     row.size(), row[0], table.wavelength_nm.size()));
        }
    }
    table.has_cross_sections = true;
}

/// What the T-matrix programs print of particles in random orientation.
void read_t_matrix(const std::string& path, const std::string& text, Species& species) {
    const std::regex of_wavelength("LAM *= *([0-9.DE+-]+)"),
        of_sections("CEXT *= *([0-9.DE+-]+).*W *= *([0-9.DE+-]+)");
    std::istringstream in(text);
    FileScattering& table = species.scattering;
    bool in_list = false;
    for (std::string line; std::getline(in, line);) {
        std::smatch found;
        if (std::regex_search(line, found, of_wavelength))
            table.wavelength_nm.push_back(kNmPerUm * numbers_in(found[1]).at(0));
        if (std::regex_search(line, found, of_sections)) {
            table.extinction.push_back(numbers_in(found[1]).at(0));
            table.albedo.push_back(std::min(1.0, numbers_in(found[2]).at(0)));
        }
        const std::vector<double> row = numbers_in(line);
        if (line.find("ALPHA1") != std::string::npos) {
            in_list = true;
            species.matrices.emplace_back();
        } else if (in_list && row.size() == 7) {
            MatrixCoefficients& m = species.matrices.back();
            if (row[0] != double(m.a1.size()))
                refuse(path, fmt::format("has S = {} where {} was expected", row[0], m.a1.size()));
            m.a1.push_back(row[1]);
            m.a2.push_back(row[2]);
            m.a3.push_back(row[3]);
            m.a4.push_back(row[4]);
            m.b1.push_back(row[5]);
            m.b2.push_back(row[6]);
        } else {
            in_list = false;
        }
    }
    if (table.wavelength_nm.size() != species.matrices.size() ||
        table.albedo.size() != species.matrices.size()) {
        refuse(path, fmt::format("has {} wavelengths (LAM), {} cross-sections (CEXT) and {} lists "
                                 "of coefficients (ALPHA1); expected: as many of each",
                                 table.wavelength_nm.size(), table.albedo.size(),
                                 species.matrices.size()));
    }
    for (std::size_t w = 0; w < table.albedo.size(); ++w)
        species.matrices[w].single_scattering_albedo = table.albedo[w];
    table.has_cross_sections = true;
}

/// Wavelength, largest dimension, volume, projected area, Q_ext, albedo and g, sizes fastest; the
/// phase functions in the file beside it, its angles first.
void read_sizes_of_particles(const std::string& path, const std::string& text,
                             FileScattering& table) {
    std::istringstream in(text);
    std::vector<double> asymmetry;
    for (std::string line; std::getline(in, line);) {
        const std::vector<double> row = numbers_in(line);
        if (row.empty()) continue;
        if (row.size() != 7)
            refuse(path, fmt::format("has a row of {} numbers; expected: 7", row.size()));
        const double nm = kNmPerUm * row[0], radius_um = 0.75 * row[2] / row[3];
        if (table.wavelength_nm.empty() || nm != table.wavelength_nm.back())
            table.wavelength_nm.push_back(nm);
        if (table.wavelength_nm.size() == 1) table.radius_um.push_back(radius_um);
        table.extinction.push_back(row[4]);
        table.albedo.push_back(std::min(1.0, row[5]));
        asymmetry.push_back(row[6]);
    }
    if (table.extinction.size() != table.wavelength_nm.size() * table.radius_um.size()) {
        refuse(path, fmt::format("has {} rows; expected: {} sizes at each of {} wavelengths",
                                 table.extinction.size(), table.radius_um.size(),
                                 table.wavelength_nm.size()));
    }
    std::filesystem::path beside(path);
    std::string name = beside.filename().string();
    name.replace(name.find("isca"), 4, "P11");
    beside.replace_filename(name);
    if (!std::filesystem::exists(beside))
        refuse(path, fmt::format("has no phase functions beside it ('{}')", beside.string()));
    std::istringstream phases(text_of_file(beside.string()));
    for (std::string line; std::getline(phases, line);) {
        std::vector<double> row = numbers_in(line);
        if (row.empty()) continue;
        (table.angles_deg.empty() ? table.angles_deg : table.phase.emplace_back()) = std::move(row);
    }
}

void read_csv(const std::string& path, FileScattering& table) {
    const materials::NumberTable file(path);
    file.require_names({"angle_deg", "p11"},
                       {"wavelength_nm", "single_scattering_albedo", "extinction_um2"});
    const auto* nm = file.find("wavelength_nm");
    const auto* albedo = file.find("single_scattering_albedo");
    const auto* extinction = file.find("extinction_um2");
    if (albedo == nullptr && !file.comment("single_scattering_albedo"))
        file.refuse("has no column single_scattering_albedo, nor '# single_scattering_albedo: X'");
    for (std::size_t row = 0; row < file.rows(); ++row) {
        const double at = nm == nullptr ? 0.0 : (*nm)[row];
        if (table.phase.empty() || at != table.wavelength_nm.back()) {
            table.wavelength_nm.push_back(at);
            table.phase.emplace_back();
            table.albedo.push_back(albedo == nullptr ? *file.comment("single_scattering_albedo")
                                                     : (*albedo)[row]);
            table.extinction.push_back(extinction == nullptr ? 1.0 : (*extinction)[row]);
        }
        table.phase.back().push_back(file.column("p11")[row]);
        const double angle = file.column("angle_deg")[row];
        if (table.phase.size() == 1) {
            table.angles_deg.push_back(angle);
        } else if (table.phase.back().size() > table.angles_deg.size() ||
                   angle != table.angles_deg[table.phase.back().size() - 1]) {
            file.refuse(row, "expected: the same angles at every wavelength");
        }
    }
    if (nm == nullptr) table.wavelength_nm.clear();
    table.has_cross_sections = extinction != nullptr;
}

/// P at any angle: linear in angle and log P, or in P beside zeros.
struct TabulatedPhase {
    std::vector<double> angles_deg, values;

    double at(double angle_deg) const {
        const auto above =
            std::upper_bound(angles_deg.begin() + 1, angles_deg.end() - 1, angle_deg);
        const auto i = static_cast<std::size_t>(above - angles_deg.begin());
        const double t = std::clamp(
            (angle_deg - angles_deg[i - 1]) / (angles_deg[i] - angles_deg[i - 1]), 0.0, 1.0);
        const double a = values[i - 1], b = values[i];
        if (a > 0.0 && b > 0.0) return a * std::pow(b / a, t);
        return (1.0 - t) * a + t * b;
    }
    double operator()(double cos_theta) const {
        return at(std::acos(std::clamp(cos_theta, -1.0, 1.0)) / kRadiansPerDegree);
    }
};

/// chi_0 ... chi_last of an interpolated phase function, by Gauss rules between its angles.
std::vector<double> moments_of(const TabulatedPhase& phase, std::size_t last) {
    std::vector<double> chi(last + 1, 0.0);
    for (std::size_t i = 1; i < phase.angles_deg.size(); ++i) {
        const double width = (phase.angles_deg[i] - phase.angles_deg[i - 1]) * kRadiansPerDegree;
        const int nodes = 4 + static_cast<int>(std::ceil(0.5 * double(last) * width));
        const auto rule = math::gauss_legendre(nodes, phase.angles_deg[i - 1], phase.angles_deg[i]);
        for (int n = 0; n < nodes; ++n) {
            const double theta = rule.nodes[n] * kRadiansPerDegree, mu = std::cos(theta);
            const double weight = 0.5 * rule.weights[n] * kRadiansPerDegree * std::sin(theta) *
                                  phase.at(rule.nodes[n]);
            double before = 0.0, here = 1.0;
            for (std::size_t l = 0; l <= last; ++l) {
                chi[l] += weight * here;
                const double k = static_cast<double>(l);
                const double next = ((2.0 * k + 1.0) * mu * here - k * before) / (k + 1.0);
                before = here;
                here = next;
            }
        }
    }
    return chi;
}

/// Moments until the terms (2l + 1) chi_l are small, at most this many.
constexpr std::size_t kFirstTableMoments = 64, kMostTableMoments = 1024;
constexpr double kSmallTerm = 1e-3;

rte::Optics optics_of_table(TabulatedPhase phase, double albedo) {
    std::vector<double> chi;
    bool has_more = true;
    for (std::size_t last = kFirstTableMoments; has_more && last <= kMostTableMoments; last *= 2) {
        chi = moments_of(phase, last);
        double largest = 0.0;  // of the last quarter: odd and even ones alternate
        for (std::size_t l = last - last / 4; l <= last; ++l)
            largest = std::max(largest, (2.0 * double(l) + 1.0) * std::abs(chi[l] / chi[0]));
        has_more = largest > kSmallTerm;
    }
    const double mean = chi[0];
    for (double& value : chi) value /= mean;
    for (double& value : phase.values) value /= mean;
    rte::Optics optics;
    optics.single_scattering_albedo = albedo;
    optics.one_minus_albedo = 1.0 - albedo;
    optics.chi = std::move(chi);
    optics.has_more_moments = has_more;
    optics.phase = std::move(phase);
    return optics;
}

/// The average over sizes at one wavelength of the file: extinction, scattering, and P times it.
struct Average {
    double extinction = 0.0, scattering = 0.0;
    std::vector<double> phase;
};

/// Sizes that averages are taken over.
constexpr int kSizes = 400;

mie::SizeDistribution sizes_for(const Species& species) {
    const FileScattering& table = species.scattering;
    if (!states_radius(species)) {
        throw InputError(fmt::format(
            "scattering file '{}' has {} sizes from {:.4g} to {:.4g} um; say over which the "
            "average is taken, e.g. scattering:{},radius=1,variance=0.2",
            species.name, table.radius_um.size(), table.radius_um.front(), table.radius_um.back(),
            species.name));
    }
    return sizes_of(species, {});
}

Average average_at(const Species& species, std::size_t w) {
    const FileScattering& table = species.scattering;
    const std::vector<double>& radii = table.radius_um;
    Average sum;
    sum.phase.assign(table.angles_deg.size(), 0.0);
    const auto add = [&](std::size_t row, double weight) {
        const double scattering = weight * table.extinction[row] * table.albedo[row];
        sum.extinction += weight * table.extinction[row];
        sum.scattering += scattering;
        for (std::size_t a = 0; a < sum.phase.size(); ++a)
            sum.phase[a] += scattering * table.phase[row][a];
    };
    if (!has_sizes(table)) {
        add(w, 1.0);
        return sum;
    }
    const mie::SizeDistribution sizes = sizes_for(species);
    // Particles of tails beyond the file are few: they take part with its ends.
    constexpr double kTail = 1e-3;
    const mie::RadiusRange range = mie::radius_range(sizes, kTail);
    const auto add_radius = [&](double radius, double weight) {
        const auto above = std::upper_bound(radii.begin() + 1, radii.end() - 1, radius);
        const auto i = static_cast<std::size_t>(above - radii.begin());
        const double t = std::clamp((radius - radii[i - 1]) / (radii[i] - radii[i - 1]), 0.0, 1.0);
        add(w * radii.size() + i - 1, (1.0 - t) * weight);
        add(w * radii.size() + i, t * weight);
    };
    if (range.smallest_um < radii.front() / 2 || range.largest_um > radii.back() * 2) {
        throw InputError(fmt::format(
            "scattering file '{}' has sizes from {:.4g} to {:.4g} um; those asked for reach from "
            "{:.4g} to {:.4g} um",
            species.name, radii.front(), radii.back(), range.smallest_um, range.largest_um));
    }
    if (range.smallest_um == range.largest_um) {
        add_radius(range.largest_um, 1.0);
        return sum;
    }
    double before = range.smallest_um;
    for (int i = 1; i <= kSizes; ++i) {
        const double here =
            range.smallest_um * std::pow(range.largest_um / range.smallest_um, double(i) / kSizes);
        add_radius(std::sqrt(before * here), mie::area_share_within(sizes, {before, here}));
        before = here;
    }
    return sum;
}

struct Between {
    std::size_t below = 0, above = 0;
    double t = 0.0;
};

Between wavelengths_at(const Species& species, double nm) {
    const std::vector<double>& at = species.scattering.wavelength_nm;
    if (at.empty()) return {};
    // One wavelength is not asked to hold for others.
    constexpr double kSame = 1e-3;
    if (!(nm >= at.front() * (1 - kSame) && nm <= at.back() * (1 + kSame))) {
        throw InputError(
            fmt::format("scattering file '{}' has nothing at {} nm; it covers {} to "
                        "{} nm",
                        species.name, nm, at.front(), at.back()));
    }
    if (at.size() == 1) return {};
    const auto above = std::upper_bound(at.begin() + 1, at.end() - 1, nm);
    const auto i = static_cast<std::size_t>(above - at.begin());
    return {i - 1, i, std::clamp((nm - at[i - 1]) / (at[i] - at[i - 1]), 0.0, 1.0)};
}

}  // namespace

bool has_sizes(const FileScattering& table) { return table.radius_um.size() > 1; }

void read_scattering_file(const std::string& path, Species& species) {
    species.name = path;
    FileScattering& table = species.scattering;
    const std::string text = text_of_file(path);
    const std::string first = text.substr(0, text.find('\n'));
    if (text.find("ALPHA1") != std::string::npos) {
        read_t_matrix(path, text, species);
    } else if (text.find("optical parameters") != std::string::npos) {
        read_opac(path, text, table);
    } else if (std::filesystem::path(path).filename().string().find("isca") != std::string::npos &&
               numbers_in(first).size() == 7) {
        read_sizes_of_particles(path, text, table);
    } else {
        read_csv(path, table);
    }
    double sum = 0.0;
    for (const double albedo : table.albedo) sum += albedo;
    species.parameters = {table.albedo.empty() ? 0.0 : sum / double(table.albedo.size())};
    try {
        check_scattering(species);
    } catch (const UsageError& error) {
        refuse(path, fmt::format("is no file of single scattering: {}", error.what()));
    }
}

rte::Optics optics_of_file(const Species& species, double wavelength_nm) {
    const Between at = wavelengths_at(species, wavelength_nm);
    if (!species.matrices.empty()) {
        Species matrix = species;
        matrix.wavelength_nm.clear();
        if (species.matrices.size() > 1) matrix.wavelength_nm = species.scattering.wavelength_nm;
        return optics_of_matrices(matrix, wavelength_nm);
    }
    Average mean = average_at(species, at.below);
    if (at.t > 0.0) {
        const Average other = average_at(species, at.above);
        const auto between = [&](double a, double b) { return (1.0 - at.t) * a + at.t * b; };
        mean.extinction = between(mean.extinction, other.extinction);
        mean.scattering = between(mean.scattering, other.scattering);
        for (std::size_t a = 0; a < mean.phase.size(); ++a)
            mean.phase[a] = between(mean.phase[a], other.phase[a]);
    }
    return optics_of_table({species.scattering.angles_deg, mean.phase},
                           std::min(1.0, mean.scattering / mean.extinction));
}

double extinction_of_file(const Species& species, double wavelength_nm) {
    const Between at = wavelengths_at(species, wavelength_nm);
    if (!has_sizes(species.scattering)) {
        const std::vector<double>& e = species.scattering.extinction;
        return (1.0 - at.t) * e[at.below] + at.t * e[at.above];
    }
    return (1.0 - at.t) * average_at(species, at.below).extinction +
           at.t * average_at(species, at.above).extinction;
}

double effective_radius_of_file(const Species& species) {
    return mie::effective_radius_of(sizes_for(species));
}

void check_scattering(const Species& species) {
    const FileScattering& table = species.scattering;
    const auto refuse = [](const std::string& reason) { throw UsageError(reason); };
    for (std::size_t i = 0; i < table.albedo.size(); ++i) {
        if (!(table.albedo[i] >= 0.0 && table.albedo[i] <= 1.0 && table.extinction[i] > 0.0))
            refuse(
                fmt::format("albedo {} and extinction {} in entry {}; allowed: [0, 1] and above "
                            "0",
                            table.albedo[i], table.extinction[i], i + 1));
    }
    for (const auto* ascending : {&table.wavelength_nm, &table.radius_um, &table.angles_deg}) {
        for (std::size_t i = 1; i < ascending->size(); ++i) {
            if (!((*ascending)[i] > (*ascending)[i - 1]))
                refuse(fmt::format("{} follows {}; wavelengths, sizes and angles ascend",
                                   (*ascending)[i], (*ascending)[i - 1]));
        }
    }
    if (!species.matrices.empty()) {
        Species matrix = species;
        matrix.wavelength_nm.clear();
        if (species.matrices.size() > 1) matrix.wavelength_nm = table.wavelength_nm;
        return check_matrices(matrix);
    }
    if (table.phase.size() != table.albedo.size() || table.phase.empty()) {
        refuse(fmt::format("{} phase functions for {} entries", table.phase.size(),
                           table.albedo.size()));
    }
    const std::vector<double>& angles = table.angles_deg;
    if (angles.size() < 3 || angles.front() != 0.0 || angles.back() != 180.0) {
        refuse(fmt::format("{} angles from {} to {} degrees; allowed: 3 or more, from 0 to 180",
                           angles.size(), angles.empty() ? 0.0 : angles.front(),
                           angles.empty() ? 0.0 : angles.back()));
    }
    for (std::size_t row = 0; row < table.phase.size(); ++row) {
        if (table.phase[row].size() != angles.size()) {
            refuse(fmt::format("{} values of phase function {} at {} angles",
                               table.phase[row].size(), row + 1, angles.size()));
        }
        double largest = 0.0;
        for (std::size_t a = 0; a < angles.size(); ++a) {
            const double value = table.phase[row][a];
            if (!(value >= 0.0 && std::isfinite(value))) {
                refuse(
                    fmt::format("the phase function is {} at {} degrees{}; allowed: nowhere "
                                "negative",
                                value, angles[a],
                                table.wavelength_nm.empty() ? std::string()
                                                            : fmt::format(" (entry {})", row + 1)));
            }
            largest = std::max(largest, value);
        }
        if (!(largest > 0.0)) refuse("a phase function is 0 at all angles");
    }
}

}  // namespace miebrdf
