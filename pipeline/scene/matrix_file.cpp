#include "pipeline/scene/matrix_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>

#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"

namespace miebrdf {
namespace {

constexpr char kMatrixAlbedoKey[] = "single_scattering_albedo:";
constexpr std::size_t kMostCoefficients = 100'000;

const std::vector<std::string> kNeeded = {"l", "a1", "a2", "a3", "a4", "b1", "b2"};
const std::vector<std::string> kAllowed = {"wavelength_nm", "single_scattering_albedo"};

using Lists = std::vector<double> MatrixCoefficients::*;
constexpr Lists kLists[] = {&MatrixCoefficients::a1, &MatrixCoefficients::a2,
                            &MatrixCoefficients::a3, &MatrixCoefficients::a4,
                            &MatrixCoefficients::b1, &MatrixCoefficients::b2};

/// One file on its way in; every complaint names the file and the line.
class MatrixReader {
  public:
    explicit MatrixReader(const std::string& path) : path_(path) {}

    MatrixFile read() {
        std::ifstream file(path_);
        if (!file) throw InputError(fmt::format("matrix file '{}' cannot be read", path_));
        std::string line;
        while (std::getline(file, line)) {
            ++line_number_;
            if (!line.empty() && line.back() == '\r') line.pop_back();
            if (!line.empty()) read_line(line);
        }
        if (result_.matrices.empty()) refuse("has no rows");
        for (MatrixCoefficients& matrix : result_.matrices) {
            if (!has_column("single_scattering_albedo")) {
                if (!albedo_) refuse("has no albedo: neither a column nor a comment line");
                matrix.single_scattering_albedo = *albedo_;
            }
        }
        check();
        return std::move(result_);
    }

  private:
    [[noreturn]] void refuse(const std::string& reason) const {
        throw InputError(fmt::format("matrix file '{}', line {}: {}", path_, line_number_, reason));
    }

    double number(const std::string& text) const {
        try {
            return parse_number(text, "value");
        } catch (const UsageError& error) {
            refuse(error.what());
        }
    }

    bool has_column(const std::string& name) const { return columns_.contains(name); }

    void read_line(const std::string& line) {
        if (line[0] == '#') {
            const std::size_t key = line.find(kMatrixAlbedoKey);
            if (key == std::string::npos) return;
            albedo_ = number(trimmed_text(line.substr(key + sizeof(kMatrixAlbedoKey) - 1)));
        } else if (columns_.empty()) {
            read_header(line);
        } else {
            read_row(split_list(line));
        }
    }

    void read_header(const std::string& line) {
        const auto names = split_list(line);
        for (std::size_t i = 0; i < names.size(); ++i) {
            const auto is = [&](const std::string& name) { return name == names[i]; };
            const bool known = std::any_of(kNeeded.begin(), kNeeded.end(), is) ||
                               std::any_of(kAllowed.begin(), kAllowed.end(), is);
            if (!known || has_column(names[i])) {
                refuse(fmt::format("column '{}' is unknown or there twice; allowed: {}, {}",
                                   names[i], fmt::join(kNeeded, ", "), fmt::join(kAllowed, ", ")));
            }
            columns_[names[i]] = i;
        }
        for (const std::string& name : kNeeded) {
            if (!has_column(name))
                refuse(fmt::format("no column '{}' in the header '{}'", name, line));
        }
    }

    void read_row(const std::vector<std::string>& cells) {
        if (cells.size() != columns_.size())
            refuse(fmt::format("{} values for {} columns", cells.size(), columns_.size()));
        const auto value = [&](const std::string& name) {
            return number(cells[columns_.at(name)]);
        };
        if (value("l") == 0.0) begin_matrix(value);
        if (result_.matrices.empty()) refuse("the first row is not l = 0");
        MatrixCoefficients& matrix = result_.matrices.back();
        const double expected = double(matrix.a1.size());
        if (value("l") != expected)
            refuse(fmt::format("l = {} where {} was expected", value("l"), expected));
        if (matrix.a1.size() >= kMostCoefficients)
            refuse(fmt::format("more than {} degrees", kMostCoefficients));
        if (has_column("wavelength_nm") && value("wavelength_nm") != result_.wavelength_nm.back())
            refuse("another wavelength before l = 0");
        for (std::size_t i = 0; i < std::size(kLists); ++i)
            (matrix.*kLists[i]).push_back(value(kNeeded[i + 1]));
    }

    template <typename Value>
    void begin_matrix(const Value& value) {
        if (has_column("wavelength_nm")) {
            const double nm = value("wavelength_nm");
            if (!(nm > 0.0) ||
                (!result_.wavelength_nm.empty() && !(nm > result_.wavelength_nm.back())))
                refuse(fmt::format("wavelength {} nm; allowed: above 0, ascending", nm));
            result_.wavelength_nm.push_back(nm);
        } else if (!result_.matrices.empty()) {
            refuse("l = 0 again; several wavelengths need a column 'wavelength_nm'");
        }
        result_.matrices.emplace_back();
        if (has_column("single_scattering_albedo"))
            result_.matrices.back().single_scattering_albedo = value("single_scattering_albedo");
    }

    void check() const {
        Species species;
        species.wavelength_nm = result_.wavelength_nm;
        species.matrices = result_.matrices;
        try {
            check_matrices(species);
        } catch (const UsageError& error) {
            throw InputError(fmt::format("matrix file '{}': {}", path_, error.what()));
        }
    }

    std::string path_;
    std::size_t line_number_ = 0;
    std::map<std::string, std::size_t> columns_;
    std::optional<double> albedo_;
    MatrixFile result_;
};

rte::Optics optics_of(const MatrixCoefficients& matrix) {
    rte::Optics optics;
    optics.single_scattering_albedo = matrix.single_scattering_albedo;
    optics.one_minus_albedo = 1.0 - matrix.single_scattering_albedo;
    optics.chi.clear();
    for (std::size_t l = 0; l < matrix.a1.size(); ++l)
        optics.chi.push_back(matrix.a1[l] / (2.0 * double(l) + 1.0));
    rte::Polarisation polarisation;
    polarisation.a2 = matrix.a2;
    polarisation.a3 = matrix.a3;
    polarisation.a4 = matrix.a4;
    polarisation.b1 = matrix.b1;
    polarisation.b2 = matrix.b2;
    optics.polarisation = std::make_shared<const rte::Polarisation>(std::move(polarisation));
    return optics;
}

/// (1 - t) a + t b; the shorter one is zero beyond its end.
MatrixCoefficients between(const MatrixCoefficients& a, const MatrixCoefficients& b, double t) {
    MatrixCoefficients mean;
    mean.single_scattering_albedo =
        (1.0 - t) * a.single_scattering_albedo + t * b.single_scattering_albedo;
    for (const Lists list : kLists) {
        const std::vector<double>&from = a.*list, &to = b.*list;
        for (std::size_t l = 0; l < std::max(from.size(), to.size()); ++l) {
            (mean.*list)
                .push_back((l < from.size() ? (1.0 - t) * from[l] : 0.0) +
                           (l < to.size() ? t * to[l] : 0.0));
        }
    }
    return mean;
}

}  // namespace

MatrixFile read_matrix_file(const std::string& path) { return MatrixReader(path).read(); }

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
    return optics_of(between(species.matrices[i - 1], species.matrices[i], t));
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
    for (const MatrixCoefficients& matrix : species.matrices) {
        for (const Lists list : kLists) {
            if ((matrix.*list).size() != matrix.a1.size())
                throw UsageError("coefficients", double((matrix.*list).size()),
                                 "six lists of one length");
        }
        rte::validate(optics_of(matrix));
    }
}

}  // namespace miebrdf
