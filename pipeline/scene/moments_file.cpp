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
#include "rte/math/legendre.h"
#include "rte/phase/polarisation.h"

namespace miebrdf {
namespace {

constexpr double kDigitsOfFiles = 1e-6;  // tables are printed with at least six digits
constexpr double kLargestLastTerm = 0.1;
constexpr std::size_t kMostProducts = 20'000'000;  // of a test for negative values: 50 ms

double albedo_of_comment(const materials::NumberTable& table) {
    const auto albedo = table.comment("single_scattering_albedo");
    if (!albedo) table.refuse("has no line '# single_scattering_albedo: X'");
    if (!(*albedo >= 0.0 && *albedo <= 1.0)) {
        table.refuse(
            fmt::format("single-scattering albedo {} is out of range; allowed: [0, 1]", *albedo));
    }
    return *albedo;
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

}  // namespace

rte::Optics optics_of(const MatrixCoefficients& matrix) {
    rte::Optics optics;
    optics.single_scattering_albedo = matrix.single_scattering_albedo;
    optics.one_minus_albedo = 1.0 - matrix.single_scattering_albedo;
    optics.chi.clear();
    for (std::size_t l = 0; l < matrix.a1.size(); ++l)
        optics.chi.push_back(matrix.a1[l] / (2.0 * double(l) + 1.0));
    optics.polarisation = std::make_shared<const rte::Polarisation>(rte::Polarisation{matrix, {}});
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
    table.require_names({"l", "chi"});
    MomentsFile file;
    file.single_scattering_albedo = albedo_of_comment(table);
    const std::vector<double>&degree = table.column("l"), &chi = table.column("chi");
    for (std::size_t l = 0; l < chi.size(); ++l) {
        if (degree[l] != double(l))
            table.refuse(l, fmt::format("l = {}; expected {}", degree[l], l));
        if (l == 0 && !(std::abs(chi[0] - 1.0) <= kDigitsOfFiles)) {
            table.refuse(
                l, fmt::format("chi_0 = {}; it must be 1 (divide all moments by chi_0)", chi[0]));
        }
        if (!(std::abs(chi[l]) <= 1.0 + kDigitsOfFiles))
            table.refuse(l, fmt::format("chi_{} = {}; allowed: [-1, 1]", l, chi[l]));
        file.chi.push_back(l == 0 ? 1.0 : std::clamp(chi[l], -1.0, 1.0));
    }
    try {
        check_moments(file.chi);
    } catch (const UsageError& error) {
        table.refuse(error.what());
    }
    return file;
}

MatrixFile read_matrix_file(const std::string& path) {
    const materials::NumberTable table(path);
    table.require_names({"l", "a1", "a2", "a3", "a4", "b1", "b2"},
                        {"wavelength_nm", "single_scattering_albedo"});
    const std::vector<double>* wavelength_nm = table.find("wavelength_nm");
    const std::vector<double>* albedo = table.find("single_scattering_albedo");
    const std::vector<double>& degree = table.column("l");
    const double one_albedo = albedo == nullptr ? albedo_of_comment(table) : 0.0;
    MatrixFile file;
    for (std::size_t row = 0; row < table.rows(); ++row) {
        const double nm = wavelength_nm == nullptr ? 0.0 : (*wavelength_nm)[row];
        if (degree[row] == 0.0) {
            if (wavelength_nm == nullptr && row > 0)
                table.refuse(row, "l = 0 again; several wavelengths need a column 'wavelength_nm'");
            if (wavelength_nm != nullptr) {
                if (!(nm > (row == 0 ? 0.0 : file.wavelength_nm.back())))
                    table.refuse(row,
                                 fmt::format("wavelength {} nm; allowed: above 0, ascending", nm));
                file.wavelength_nm.push_back(nm);
            }
            file.matrices.emplace_back().single_scattering_albedo =
                albedo == nullptr ? one_albedo : (*albedo)[row];
        }
        if (file.matrices.empty()) table.refuse(row, "the first row is not l = 0");
        MatrixCoefficients& matrix = file.matrices.back();
        if (degree[row] != double(matrix.a1.size())) {
            table.refuse(
                row, fmt::format("l = {} where {} was expected", degree[row], matrix.a1.size()));
        }
        if (wavelength_nm != nullptr && nm != file.wavelength_nm.back())
            table.refuse(row, "another wavelength before l = 0");
        matrix.a1.push_back(table.column("a1")[row]);
        for (const auto& [name, list] : kMatrixLists)
            (matrix.*list).push_back(table.column(name)[row]);
    }
    Species species;
    species.wavelength_nm = file.wavelength_nm;
    species.matrices = file.matrices;
    try {
        check_matrices(species);
    } catch (const UsageError& error) {
        table.refuse(error.what());
    }
    return file;
}

double mean_albedo(const std::vector<MatrixCoefficients>& matrices) {
    double sum = 0.0;
    for (const MatrixCoefficients& matrix : matrices) sum += matrix.single_scattering_albedo;
    return sum / double(matrices.size());
}

rte::Optics optics_of_matrices(const Species& species, double wavelength_nm) {
    const std::vector<double>& at = species.wavelength_nm;
    if (at.size() < 2) return optics_of(species.matrices.front());
    if (!(wavelength_nm >= at.front() && wavelength_nm <= at.back())) {
        throw InputError(fmt::format("matrix file '{}' has nothing at {} nm; it covers {} to {} nm",
                                     species.name, wavelength_nm, at.front(), at.back()));
    }
    const auto above = std::upper_bound(at.begin() + 1, at.end() - 1, wavelength_nm);
    const auto i = static_cast<std::size_t>(above - at.begin());
    const double t = (wavelength_nm - at[i - 1]) / (at[i] - at[i - 1]);
    MatrixCoefficients between;
    add(between, species.matrices[i - 1], 1.0 - t);
    add(between, species.matrices[i], t);
    return optics_of(between);
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
    for (const MatrixCoefficients& matrix : species.matrices) check_matrix(matrix);
}

}  // namespace miebrdf
