#include "pipeline/scene/scattering_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <sstream>

#include <miebrdf/error.h>
#include "materials/readers/text_table.h"
#include "pipeline/scene/matrix_on_angles.h"
#include "pipeline/scene/moments_file.h"
#include "pipeline/scene/scattering_netcdf.h"

namespace miebrdf {
namespace {

constexpr double kNmPerUm = 1e3;

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
    throw InputError(fmt::format("scattering file '{}' {}", path, reason));
}

std::string text_of_file(const std::string& path) {
    return materials::read_bytes(path, materials::ReadingBudget::kLargeBytes);
}

/// The numbers of a line up to the first word that is none; Fortran's D is an E.
std::vector<double> numbers_in(std::string line) {
    std::replace(line.begin(), line.end(), 'D', 'E');
    std::istringstream in(line);
    std::vector<double> numbers;
    for (double number; in >> number;) numbers.push_back(number);
    return numbers;
}

/// The number of "NAME = X" in a line; nothing where there is none.
std::optional<double> number_of(const std::string& line, const std::string& name) {
    for (std::size_t at = line.find(name); at != std::string::npos; at = line.find(name, at + 1)) {
        const std::size_t mark = line.find_first_not_of(' ', at + name.size());
        if (mark == std::string::npos || line[mark] != '=') continue;
        // The next name follows without a blank in some versions.
        const std::size_t begin = line.find_first_not_of(' ', mark + 1),
                          end = line.find_first_not_of("0123456789.DE+-", begin);
        if (begin == std::string::npos) return std::nullopt;
        const auto numbers = numbers_in(line.substr(begin, end - begin));
        if (!numbers.empty()) return numbers.front();
    }
    return std::nullopt;
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

/// Reads what the T-matrix programs print of particles in random orientation. Their functions of
/// BETA1 and BETA2 have the other sign than d^l_02.
void read_t_matrix(const std::string& path, const std::string& text, Species& species) {
    std::istringstream in(text);
    FileScattering& table = species.scattering;
    bool in_list = false;
    for (std::string line; std::getline(in, line);) {
        if (const auto lam = number_of(line, "LAM")) table.wavelength_nm.push_back(kNmPerUm * *lam);
        const auto extinction = number_of(line, "CEXT"), albedo = number_of(line, " W");
        if (extinction && albedo) {
            table.extinction.push_back(*extinction);
            table.albedo.push_back(std::min(1.0, *albedo));
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
            m.b1.push_back(-row[5]);
            m.b2.push_back(-row[6]);
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

/// The file beside one whose name has `isca` in it, with another word in its place.
std::filesystem::path beside(const std::string& path, const std::string& word) {
    std::filesystem::path other(path);
    std::string name = other.filename().string();
    name.replace(name.find("isca"), 4, word);
    return other.replace_filename(name);
}

std::vector<std::vector<double>> rows_of(const std::filesystem::path& path) {
    std::istringstream in(text_of_file(path.string()));
    std::vector<std::vector<double>> rows;
    std::size_t count = 0;
    for (std::string line; std::getline(in, line);) {
        std::vector<double> row = numbers_in(line);
        if (row.empty()) continue;
        count += row.size();
        materials::ReadingBudget::require_values(count, path.string(), 0,
                                                 materials::ReadingBudget::kNumbers);
        rows.push_back(std::move(row));
    }
    return rows;
}

/// Elements over P11 in the order of FileScattering::ratios, and the sign they have there.
constexpr std::pair<const char*, double> kRatioFiles[] = {
    {"P22", 1.0}, {"P33", 1.0}, {"P44", 1.0}, {"P12", 1.0}, {"P43", -1.0}};

/// Of a database, phase functions of all entries, the angles first; other elements likewise.
void read_phase_files(const std::string& path, FileScattering& table) {
    if (!std::filesystem::exists(beside(path, "P11")))
        refuse(path, fmt::format("has no phase functions beside it ('{}')",
                                 beside(path, "P11").string()));
    table.phase = rows_of(beside(path, "P11"));
    if (table.phase.empty()) refuse(path, "has no rows in its file P11");
    table.angles_deg = std::move(table.phase.front());
    table.phase.erase(table.phase.begin());
    if (!std::all_of(std::begin(kRatioFiles), std::end(kRatioFiles), [&](const auto& file) {
            return std::filesystem::exists(beside(path, file.first));
        }))
        return;
    table.ratios.resize(table.phase.size());
    for (const auto& [name, sign] : kRatioFiles) {
        const auto rows = rows_of(beside(path, name));
        if (rows.size() != table.phase.size() + 1) {
            refuse(path, fmt::format("has {} rows in its file {}; expected: as many as in P11, {}",
                                     rows.size(), name, table.phase.size() + 1));
        }
        for (std::size_t row = 0; row < table.phase.size(); ++row) {
            for (const double value : rows[row + 1]) table.ratios[row].push_back(sign * value);
        }
    }
}

/// Of one particle, a row for each angle: P11, then P12, P22, P33, P43, P44 over it.
void read_phase_rows(const std::string& path, FileScattering& table) {
    const auto rows = rows_of(beside(path, "PMat"));
    table.phase.emplace_back();
    table.ratios.emplace_back(5 * rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i].size() != 7)
            refuse(path, fmt::format("has a row of {} numbers in its file PMat; expected: 7",
                                     rows[i].size()));
        table.angles_deg.push_back(rows[i][0]);
        table.phase[0].push_back(rows[i][1]);
        const double ratios[] = {rows[i][3], rows[i][4], rows[i][6], rows[i][2], -rows[i][5]};
        for (std::size_t e = 0; e < 5; ++e) table.ratios[0][e * rows.size() + i] = ratios[e];
    }
}

/// Wavelength, largest dimension, volume, projected area, Q_ext, albedo and g, sizes fastest.
void read_sizes_of_particles(const std::string& path, FileScattering& table) {
    for (const std::vector<double>& row : rows_of(path)) {
        if (row.size() != 7)
            refuse(path, fmt::format("has a row of {} numbers; expected: 7", row.size()));
        const double nm = kNmPerUm * row[0], radius_um = 0.75 * row[2] / row[3];
        if (table.wavelength_nm.empty() || nm != table.wavelength_nm.back())
            table.wavelength_nm.push_back(nm);
        if (table.wavelength_nm.size() == 1) {
            table.radius_um.push_back(radius_um);
            table.area_ratio.push_back(row[3] / (std::numbers::pi * radius_um * radius_um));
        }
        table.extinction.push_back(row[4]);
        table.albedo.push_back(std::min(1.0, row[5]));
    }
    if (table.extinction.size() != table.wavelength_nm.size() * table.radius_um.size()) {
        refuse(path, fmt::format("has {} rows; expected: {} sizes at each of {} wavelengths",
                                 table.extinction.size(), table.radius_um.size(),
                                 table.wavelength_nm.size()));
    }
    if (std::filesystem::exists(beside(path, "PMat")) && table.extinction.size() == 1) {
        read_phase_rows(path, table);
    } else {
        read_phase_files(path, table);
    }
}

void read_csv(const std::string& path, FileScattering& table) {
    const materials::NumberTable file(path);
    file.require_names({"angle_deg", "p11"}, {"wavelength_nm", "single_scattering_albedo",
                                              "extinction_um2", "p12", "p22", "p33", "p34", "p44"});
    const std::vector<double>* elements[] = {file.find("p22"), file.find("p33"), file.find("p44"),
                                             file.find("p12"), file.find("p34")};
    const auto there = std::count_if(std::begin(elements), std::end(elements),
                                     [](const auto* column) { return column != nullptr; });
    if (there != 0 && there != 5)
        file.refuse(
            "has some columns of a scattering matrix; expected: p12, p22, p33, p34 and p44, "
            "or none of them");
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
    const std::size_t angles = table.angles_deg.size();
    for (std::size_t row = 0; there == 5 && row + angles <= file.rows(); row += angles) {
        std::vector<double>& ratios = table.ratios.emplace_back();
        for (const auto* element : elements) {
            for (std::size_t a = row; a < row + angles; ++a) {
                const double p = file.column("p11")[a];
                ratios.push_back(p == 0.0 ? 0.0 : (*element)[a] / p);
            }
        }
    }
    if (nm == nullptr) table.wavelength_nm.clear();
    table.has_cross_sections = extinction != nullptr;
}

/// Matrices that no particle can have, at any angle. @throws UsageError
void check_ratios(const FileScattering& table) {
    const std::size_t angles = table.angles_deg.size(), all = MatrixOnAngles::kRatios * angles;
    if (table.ratios.size() != table.phase.size())
        throw UsageError(fmt::format("{} matrices for {} phase functions", table.ratios.size(),
                                     table.phase.size()));
    for (std::size_t row = 0; row < table.ratios.size(); ++row) {
        const std::vector<double>& r = table.ratios[row];
        if (r.size() != all)
            throw UsageError(fmt::format("{} elements of matrix {}; expected: {} at {} angles",
                                         r.size(), row + 1, MatrixOnAngles::kRatios, angles));
        for (std::size_t a = 0; a < angles; ++a) {
            const rte::ScatteringMatrix m{
                1.0, r[a], r[angles + a], r[2 * angles + a], r[3 * angles + a], r[4 * angles + a]};
            const std::string reason = impossible_matrix(m, table.angles_deg[a], kMatrixNoise);
            if (!reason.empty())
                throw UsageError(fmt::format("entry {}, over its a1: {}", row + 1, reason));
        }
    }
}

}  // namespace

void read_scattering_file(const std::string& path, Species& species) {
    species.name = path;
    FileScattering& table = species.scattering;
    const bool is_binary = is_netcdf(path);
    const std::string text = is_binary ? "" : text_of_file(path);
    const std::string first = text.substr(0, text.find('\n'));
    if (is_binary) {
        read_scattering_netcdf(path, species);
    } else if (text.find("ALPHA1") != std::string::npos) {
        read_t_matrix(path, text, species);
    } else if (text.find("optical parameters") != std::string::npos) {
        read_opac(path, text, table);
    } else if (std::filesystem::path(path).filename().string().find("isca") != std::string::npos &&
               numbers_in(first).size() == 7) {
        read_sizes_of_particles(path, table);
    } else {
        read_csv(path, table);
    }
    double sum = 0.0;
    for (const double albedo : table.albedo) sum += albedo;
    species.parameters = {table.albedo.empty() ? 0.0 : sum / double(table.albedo.size())};
    try {
        check_scattering(species);
    } catch (const UsageError& error) {
        refuse(path, fmt::format("is not a file of single scattering: {}", error.what()));
    }
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
    if (!table.area_ratio.empty() && table.area_ratio.size() != table.radius_um.size())
        refuse(
            fmt::format("{} areas for {} sizes", table.area_ratio.size(), table.radius_um.size()));
    for (const auto* ascending : {&table.wavelength_nm, &table.radius_um, &table.angles_deg}) {
        for (std::size_t i = 1; i < ascending->size(); ++i) {
            if (!((*ascending)[i] > (*ascending)[i - 1]))
                refuse(fmt::format("{} follows {}; wavelengths, sizes and angles ascend",
                                   (*ascending)[i], (*ascending)[i - 1]));
        }
    }
    if (!species.matrices.empty()) {
        if (species.matrices.size() != table.albedo.size()) {
            refuse(fmt::format("{} lists of coefficients for {} entries", species.matrices.size(),
                               table.albedo.size()));
        }
        // Averages over sizes are looked at where they are taken.
        if (has_sizes(table)) return;
        for (const MatrixCoefficients& matrix : species.matrices) check_matrix(matrix);
        return;
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
    if (!table.ratios.empty()) check_ratios(table);
}

}  // namespace miebrdf
