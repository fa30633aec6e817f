#include "pipeline/scene/moments_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>
#include <utility>

#include <miebrdf/error.h>
#include "materials/readers/text_table.h"
#include "pipeline/scene/matrix_on_angles.h"
#include "pipeline/scene/medium_kinds.h"
#include "rte/math/legendre.h"
#include "rte/phase/polarisation.h"

namespace miebrdf {
namespace {

constexpr double kDigitsOfFiles = 1e-6;  // tables are printed with at least six digits
constexpr double kLargestLastTerm = 0.1;
constexpr std::size_t kMostProducts = 20'000'000;  // of a test for negative values: 50 ms

constexpr const char* kNoAlbedo =
    "has no line '# single_scattering_albedo: X' and no column 'single_scattering_albedo'";

std::string wrong_albedo(double albedo) {
    return fmt::format("single-scattering albedo {} is out of range; allowed: [0, 1]", albedo);
}

/// In a row, or for all rows in a comment.
double albedo_at(const materials::NumberTable& table, const std::vector<double>* column,
                 std::size_t row) {
    const auto is_allowed = [](double albedo) { return albedo >= 0.0 && albedo <= 1.0; };
    if (column != nullptr) {
        if (!is_allowed((*column)[row])) table.refuse(row, wrong_albedo((*column)[row]));
        return (*column)[row];
    }
    const auto albedo = table.comment("single_scattering_albedo");
    if (!albedo) table.refuse(kNoAlbedo);
    if (!is_allowed(*albedo)) table.refuse(wrong_albedo(*albedo));
    return *albedo;
}

/// The albedo of a row and, where the table has them, its wavelength.
void add_wavelength(const materials::NumberTable& table, const std::vector<double>* albedo,
                    std::size_t row, MatrixFile& file) {
    if (const std::vector<double>* wavelength_nm = table.find("wavelength_nm")) {
        const double nm = (*wavelength_nm)[row];
        if (!(nm > (file.wavelength_nm.empty() ? 0.0 : file.wavelength_nm.back())))
            table.refuse(row, fmt::format("wavelength {} nm; allowed: above 0, ascending", nm));
        file.wavelength_nm.push_back(nm);
    } else if (row > 0) {
        table.refuse(row, "a second wavelength; several need a column 'wavelength_nm'");
    }
    file.matrices.emplace_back().single_scattering_albedo = albedo_at(table, albedo, row);
}

/// Reads rows with l = 0, 1, 2, ... for each wavelength.
/// @param add  puts the coefficients of a row at the end of their lists
template <typename Add>
MatrixFile read_degrees(const materials::NumberTable& table, const Add& add) {
    const std::vector<double>* wavelength_nm = table.find("wavelength_nm");
    const std::vector<double>* albedo = table.find("single_scattering_albedo");
    const std::vector<double>& degree = table.column("l");
    MatrixFile file;
    for (std::size_t row = 0; row < table.rows(); ++row) {
        if (degree[row] == 0.0) add_wavelength(table, albedo, row, file);
        if (file.matrices.empty()) table.refuse(row, "the first row is not l = 0");
        MatrixCoefficients& matrix = file.matrices.back();
        if (degree[row] != double(matrix.a1.size())) {
            table.refuse(row, fmt::format("l = {}; expected {}", degree[row], matrix.a1.size()));
        }
        if (wavelength_nm != nullptr && (*wavelength_nm)[row] != file.wavelength_nm.back())
            table.refuse(row, "another wavelength before l = 0");
        add(row, matrix);
    }
    return file;
}

/// A moment in a file, 1 and the range of all to within the digits.
double checked_moment(const materials::NumberTable& table, std::size_t row, std::size_t l) {
    const double chi = table.column("chi")[row];
    if (l == 0 && !(std::abs(chi - 1.0) <= kDigitsOfFiles)) {
        table.refuse(row,
                     fmt::format("chi_0 = {}; it must be 1 (divide all moments by chi_0)", chi));
    }
    if (!(std::abs(chi) <= 1.0 + kDigitsOfFiles))
        table.refuse(row, fmt::format("chi_{} = {}; allowed: [-1, 1]", l, chi));
    return l == 0 ? 1.0 : std::clamp(chi, -1.0, 1.0);
}

/// Refuses a table by its name for what its values cannot be.
template <typename Check>
void refuse_unless(const materials::NumberTable& table, const Check& check) {
    try {
        check();
    } catch (const UsageError& error) {
        table.refuse(error.what());
    }
}

/// Refuses a phase function that is negative anywhere. Moments of rounded figures give P only to
/// within the noise of their digits, which is allowed.
void require_positive(std::span<const double> chi) {
    const std::size_t degrees = chi.size();
    double squares = 0.0;
    for (std::size_t l = 1; l < degrees; ++l) squares += std::pow(2.0 * double(l) + 1.0, 2);
    const double noise = 3.0 * kDigitsOfFiles * std::sqrt(squares);
    // Four angles for each degree leave no lobe out; the longest lists have fewer.
    const std::size_t angles = std::clamp<std::size_t>(kMostProducts / degrees, 2, 4 * degrees);
    double lowest = 0.0, at_deg = 0.0;
    for (std::size_t i = 0; i <= angles; ++i) {
        const double angle_deg = 180.0 * double(i) / double(angles);
        const double phase =
            math::legendre_series(chi, std::cos(angle_deg * std::numbers::pi / 180.0));
        if (phase < lowest) {
            lowest = phase;
            at_deg = angle_deg;
        }
    }
    if (lowest >= -noise) return;
    std::string reason =
        fmt::format("the phase function is {:.3g} at {:.1f} degrees; allowed: nowhere negative",
                    lowest, at_deg);
    const double last = (2.0 * double(degrees) - 1.0) * chi.back();
    if (std::abs(last) > kLargestLastTerm) {
        reason += fmt::format(
            ". The list looks cut from a peaked function, since its last term, (2l + 1) chi_l = "
            "{:.3g} at l = {}, is not small: give the moments up to where that is below {}",
            last, degrees - 1, kLargestLastTerm);
    }
    throw UsageError(reason);
}

void require_possible(const rte::Optics& optics) {
    constexpr int kAngles = 90;
    for (int i = 0; i <= kAngles; ++i) {
        const double angle_deg = 180.0 * i / kAngles;
        const rte::ScatteringMatrix m =
            rte::exact_matrix(optics, std::cos(angle_deg * std::numbers::pi / 180.0));
        constexpr double kNoise = 1e-3;  // of sums of coefficients with few digits
        const std::string reason = impossible_matrix(m, angle_deg, kMatrixNoise * m.a1 + kNoise);
        if (!reason.empty()) throw UsageError(reason);
    }
}

/// What is stored for a wavelength, by kind.
void check_of_kind(Species::Kind kind, const MatrixCoefficients& matrix) {
    if (kind == Species::Kind::matrix) return check_matrix(matrix);
    for (const auto& [name, list] : kMatrixLists) {
        if (!(matrix.*list).empty())
            throw UsageError("coefficients", double((matrix.*list).size()), "a1 alone");
    }
    const rte::Optics optics = optics_of(matrix);
    rte::validate(optics);
    if (kind == Species::Kind::moments) return require_positive(optics.chi);
    if (matrix.a1.size() != 2) throw UsageError("a1", double(matrix.a1.size()), "1 and 3 g");
    if (!(std::abs(optics.chi[1]) < 1.0)) throw UsageError("asymmetry", optics.chi[1], "(-1, 1)");
}

/// What check_matrices() holds a file to.
void check_file(const materials::NumberTable& table, Species::Kind kind, const MatrixFile& file) {
    Species species{.kind = kind};
    species.wavelength_nm = file.wavelength_nm;
    species.matrices = file.matrices;
    refuse_unless(table, [&] { check_matrices(species); });
}

/// A column that goes by one of two names; null where there is none.
const std::vector<double>* find_either(const materials::NumberTable& table, const char* name,
                                       const char* other) {
    const std::vector<double>* found = table.find(name);
    if (found != nullptr && table.find(other) != nullptr)
        table.refuse(fmt::format("columns '{}' and '{}' are the same; leave one out", name, other));
    return found != nullptr ? found : table.find(other);
}

}  // namespace

rte::Optics optics_of(const MatrixCoefficients& matrix) {
    rte::Optics optics;
    optics.single_scattering_albedo = matrix.single_scattering_albedo;
    optics.one_minus_albedo = 1.0 - matrix.single_scattering_albedo;
    optics.chi.clear();
    for (std::size_t l = 0; l < matrix.a1.size(); ++l)
        optics.chi.push_back(matrix.a1[l] / (2.0 * double(l) + 1.0));
    if (!matrix.a2.empty()) {
        optics.polarisation =
            std::make_shared<const rte::Polarisation>(rte::Polarisation{matrix, {}});
    }
    return optics;
}

void add(MatrixCoefficients& sum, const MatrixCoefficients& one, double weight) {
    const auto put = [weight](std::vector<double>& to, const std::vector<double>& from) {
        to.resize(std::max(to.size(), from.size()), 0.0);
        for (std::size_t l = 0; l < from.size(); ++l) to[l] += weight * from[l];
    };
    sum.single_scattering_albedo += weight * one.single_scattering_albedo;
    put(sum.a1, one.a1);
    for (const auto& [name, list] : kMatrixLists) put(sum.*list, one.*list);
}

void check_moments(const std::vector<double>& chi) {
    rte::Optics optics;
    optics.chi = chi;
    rte::validate(optics);
    require_positive(chi);
}

MomentsFile read_moments_file(const std::string& path) {
    const materials::NumberTable table(path);
    table.require_names({"l", "chi"}, {"wavelength_nm", "single_scattering_albedo"});
    std::vector<double> chi;
    MatrixFile found = read_degrees(table, [&](std::size_t row, MatrixCoefficients& matrix) {
        const std::size_t l = matrix.a1.size();
        chi.push_back(checked_moment(table, row, l));
        matrix.a1.push_back((2.0 * double(l) + 1.0) * chi.back());
    });
    MomentsFile file;
    file.single_scattering_albedo = mean_albedo(found.matrices);
    if (found.wavelength_nm.empty()) {
        file.chi = std::move(chi);
        refuse_unless(table, [&] { check_moments(file.chi); });
    } else {
        file.by_wavelength = std::move(found);
        check_file(table, Species::Kind::moments, file.by_wavelength);
    }
    return file;
}

MatrixFile read_matrix_file(const std::string& path) {
    const materials::NumberTable table(path);
    table.require_names({"l", "a1", "a2", "a3", "a4", "b1", "b2"},
                        {"wavelength_nm", "single_scattering_albedo"});
    MatrixFile file = read_degrees(table, [&](std::size_t row, MatrixCoefficients& matrix) {
        matrix.a1.push_back(table.column("a1")[row]);
        for (const auto& [name, list] : kMatrixLists)
            (matrix.*list).push_back(table.column(name)[row]);
    });
    check_file(table, Species::Kind::matrix, file);
    return file;
}

void read_asymmetry_file(const std::string& path, Species& species) {
    const materials::NumberTable table(path);
    table.require_names({},
                        {"wavelength_nm", "single_scattering_albedo", "albedo", "g", "asymmetry"});
    const std::vector<double>* albedo = find_either(table, "single_scattering_albedo", "albedo");
    const std::vector<double>* g = find_either(table, "g", "asymmetry");
    if (g == nullptr) table.refuse("no column 'g' (or 'asymmetry')");
    MatrixFile file;
    double sum = 0.0;
    for (std::size_t row = 0; row < table.rows(); ++row) {
        if (!(std::abs((*g)[row]) < 1.0))
            table.refuse(row, fmt::format("asymmetry {}; allowed: (-1, 1)", (*g)[row]));
        add_wavelength(table, albedo, row, file);
        file.matrices.back().a1 = {1.0, 3.0 * (*g)[row]};
        sum += (*g)[row];
    }
    check_file(table, Species::Kind::henyey_greenstein, file);
    species.name = path;
    species.parameters = {mean_albedo(file.matrices), sum / double(table.rows())};
    if (file.wavelength_nm.empty()) return;
    species.wavelength_nm = std::move(file.wavelength_nm);
    species.matrices = std::move(file.matrices);
}

double mean_albedo(const std::vector<MatrixCoefficients>& matrices) {
    double sum = 0.0;
    for (const MatrixCoefficients& matrix : matrices) sum += matrix.single_scattering_albedo;
    return sum / double(matrices.size());
}

CoefficientTable::CoefficientTable(const Species& species)
    : name_(fmt::format("{} file '{}'", kind_of(species).name, species.name)),
      file_{species.wavelength_nm, species.matrices} {}

int CoefficientTable::most_degrees() const {
    std::size_t most = 1;
    for (const MatrixCoefficients& at : file_.matrices) most = std::max(most, at.a1.size());
    return static_cast<int>(most);
}

MatrixCoefficients CoefficientTable::at(double wavelength_nm) const {
    const std::vector<double>& at = file_.wavelength_nm;
    if (at.size() < 2) return file_.matrices.front();
    if (!(wavelength_nm >= at.front() && wavelength_nm <= at.back())) {
        throw InputError(fmt::format("{} has nothing at {} nm; it covers {} to {} nm", name_,
                                     wavelength_nm, at.front(), at.back()));
    }
    const auto above = std::upper_bound(at.begin() + 1, at.end() - 1, wavelength_nm);
    const auto i = static_cast<std::size_t>(above - at.begin());
    const double t = (wavelength_nm - at[i - 1]) / (at[i] - at[i - 1]);
    MatrixCoefficients between;
    add(between, file_.matrices[i - 1], 1.0 - t);
    add(between, file_.matrices[i], t);
    between.single_scattering_albedo = std::min(1.0, between.single_scattering_albedo);  // rounding
    return between;
}

void check_matrix(const MatrixCoefficients& matrix) {
    for (const auto& [name, list] : kMatrixLists) {
        if ((matrix.*list).size() != matrix.a1.size())
            throw UsageError("coefficients", double((matrix.*list).size()),
                             "six lists of one length");
    }
    const rte::Optics optics = optics_of(matrix);
    rte::validate(optics);
    require_positive(optics.chi);
    require_possible(optics);
}

void check_matrices(const Species& species) {
    const std::size_t count = species.wavelength_nm.size();
    if (species.matrices.empty() || (count != 0 && count != species.matrices.size()) ||
        (count == 0 && species.matrices.size() != 1)) {
        throw UsageError("matrices", double(species.matrices.size()),
                         "one for each wavelength, or one alone");
    }
    for (std::size_t w = 1; w < count; ++w) {
        if (!(species.wavelength_nm[w] > species.wavelength_nm[w - 1]))
            throw UsageError("wavelength_nm", species.wavelength_nm[w], "ascending");
    }
    for (const MatrixCoefficients& matrix : species.matrices) check_of_kind(species.kind, matrix);
}

}  // namespace miebrdf
