#include "pipeline/scene/scattering_netcdf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <utility>
#include <vector>

#include <miebrdf/error.h>
#include "materials/readers/text_table.h"
#include "pipeline/io/netcdf_file.h"
#include "pipeline/scene/matrix_on_angles.h"

namespace miebrdf {
namespace {

constexpr double kNmPerUm = 1e3, kNmPerM = 1e9, kUmPerM = 1e6;
using Ratio = std::pair<const char*, double>;  ///< a variable, and its sign as ScatteringMatrix

class Variables {
  public:
    explicit Variables(const std::string& path)
        : path_(path), file_(make_netcdf_file(path, "read")) {
        file_->open(path);
    }

    [[noreturn]] void refuse(const std::string& reason) const {
        throw InputError(fmt::format("scattering file '{}' {}", path_, reason));
    }

    bool has(const std::string& name) const { return file_->find(name) >= 0; }
    bool has(std::initializer_list<const char*> names) const {
        return std::all_of(names.begin(), names.end(), [&](const char* n) { return has(n); });
    }

    std::vector<int> dimensions(const std::string& name) const {
        if (!has(name)) refuse(fmt::format("has no variable '{}'", name));
        return file_->dimensions_of(file_->find(name));
    }
    std::size_t size(int dimension) const { return file_->dimension(dimension).size; }

    /// All numbers as they lie in the file.
    std::vector<double> read(const std::string& name) const {
        std::vector<std::size_t> start, count;
        double all = 1.0;
        for (const int dimension : dimensions(name)) {
            start.push_back(0);
            count.push_back(size(dimension));
            all *= double(count.back());
        }
        // Packed, a thousand million numbers take no room in a file.
        if (!(all <= double(materials::ReadingBudget::kNumbers)))
            refuse(fmt::format("has {:g} numbers in '{}'; allowed: up to {}", all, name,
                               materials::ReadingBudget::kNumbers));
        return file_->numbers(file_->find(name), start, count);
    }

    /// Over these dimensions, the last one fastest. A dimension that the variable lacks repeats it.
    std::vector<double> read(const std::string& name, const std::vector<int>& over) const {
        const std::vector<int> own = dimensions(name);
        std::vector<std::size_t> steps(over.size(), 0), at(over.size(), 0);
        std::size_t stride = 1;
        for (std::size_t d = own.size(); d-- > 0; stride *= size(own[d])) {
            const auto found = std::find(over.begin(), over.end(), own[d]);
            if (found != over.end()) {
                steps[std::size_t(found - over.begin())] = stride;
            } else if (size(own[d]) != 1) {
                const auto extra = file_->dimension(own[d]);
                refuse(
                    fmt::format("has {} values of {} in '{}'; write one of them into a file of "
                                "its own, e.g. with ncks -d {},0",
                                extra.size, extra.name, name, extra.name));
            }
        }
        const std::vector<double> values = read(name);
        std::vector<std::size_t> sizes;
        std::size_t count = 1, place = 0;
        for (const int dimension : over) count *= sizes.emplace_back(size(dimension));
        if (count > materials::ReadingBudget::kNumbers)
            refuse(fmt::format("has {} numbers in '{}'; allowed: up to {}", count, name,
                               materials::ReadingBudget::kNumbers));
        std::vector<double> result(count);
        for (double& value : result) {
            value = values[place];
            for (std::size_t d = over.size(); d-- > 0;) {
                place += steps[d];
                if (++at[d] < sizes[d]) break;
                place -= steps[d] * sizes[d];
                at[d] = 0;
            }
        }
        return result;
    }

  private:
    std::string path_;
    std::unique_ptr<NetcdfFile> file_;
};

std::vector<double> scaled(std::vector<double> list, double factor) {
    for (double& value : list) value *= factor;
    return list;
}

std::vector<double> part_of(const std::vector<double>& all, std::size_t row, std::size_t length) {
    const auto first = all.begin() + std::ptrdiff_t(row * length);
    return {first, first + std::ptrdiff_t(length)};
}

/// Q_ext of particles with the extinction per mass in m2/kg; density in g/cm3.
double efficiency(double m2_per_kg, double density_g_cm3, double radius_um) {
    constexpr double kUnits = 1e-3;  // um times g/cm3 in kg/m2
    return 4.0 / 3.0 * kUnits * m2_per_kg * density_g_cm3 * radius_um;
}

/// Angles may come from 180 down, and as single precision.
void put_angles_in_order(FileScattering& table) {
    constexpr double kRounding = 1e-4;
    if (table.angles_deg.front() > table.angles_deg.back()) {
        std::reverse(table.angles_deg.begin(), table.angles_deg.end());
        const auto n = std::ptrdiff_t(table.angles_deg.size());
        for (auto* lists : {&table.phase, &table.ratios}) {
            for (std::vector<double>& list : *lists) {
                for (auto at = list.begin(); at != list.end(); at += n) std::reverse(at, at + n);
            }
        }
    }
    if (std::abs(table.angles_deg.front()) < kRounding) table.angles_deg.front() = 0.0;
    if (std::abs(table.angles_deg.back() - 180.0) < kRounding) table.angles_deg.back() = 180.0;
}

/// One element of the scattering matrix on angles of its own.
std::vector<double> on_angles(const std::vector<double>& wanted, std::vector<double> angles,
                              std::vector<double> values, bool is_phase) {
    if (angles == wanted) return values;
    if (angles.front() > angles.back()) {
        std::reverse(angles.begin(), angles.end());
        std::reverse(values.begin(), values.end());
    }
    std::vector<double> result;
    if (is_phase) {
        const MatrixOnAngles phase{angles, values, {}};
        for (const double angle : wanted) result.push_back(phase.at(angle).a1);
        return result;
    }
    const std::vector<double> ones(angles.size(), 1.0);
    std::vector<double> ratios(MatrixOnAngles::kRatios * angles.size(), 0.0);
    std::copy(values.begin(), values.end(), ratios.begin());
    const MatrixOnAngles element{angles, ones, ratios};
    for (const double angle : wanted) result.push_back(element.at(angle).a2);
    return result;
}

/// libRadtran's elements: P11, P12, P33, P34 of spheres, then P22 and P44. The sign of P34 is that
/// of the other direction of circular polarisation, as MOPSMAP writes it for libRadtran.
struct LibradtranElement {
    std::size_t of_spheres, of_all;
    double sign;
};
constexpr LibradtranElement kLibradtran[MatrixOnAngles::kRatios] = {
    {0, 4, 1.0}, {2, 2, 1.0}, {2, 5, 1.0}, {1, 1, 1.0}, {3, 3, -1.0}};

void read_libradtran_phase(const Variables& file, const std::vector<int>& entries,
                           FileScattering& table) {
    const std::vector<int> d = file.dimensions("theta");
    if (d.size() != 4) file.refuse("has 'theta' without 4 dimensions");
    const std::vector<int> over = {entries[0], entries[1], d[2], d[3]};
    const std::size_t elements = file.size(d[2]), longest = file.size(d[3]);
    const auto theta = file.read("theta", over), phase = file.read("phase", over);
    std::vector<double> count(theta.size() / longest, double(longest));
    if (file.has("ntheta")) count = file.read("ntheta", {entries[0], entries[1], d[2]});
    const auto list = [&](const std::vector<double>& all, std::size_t row, std::size_t element) {
        const std::size_t place = row * elements + element;
        std::vector<double> values = part_of(all, place, longest);
        values.resize(std::min(longest, std::size_t(std::max(count[place], 1.0))));
        return values;
    };
    // One list of angles for all: the longest.
    const std::size_t rows = count.size() / elements;
    for (std::size_t row = 0; row < rows; ++row) {
        const std::vector<double> own = list(theta, row, 0);
        if (own.size() > table.angles_deg.size()) table.angles_deg = own;
    }
    if (table.angles_deg.front() > table.angles_deg.back())
        std::reverse(table.angles_deg.begin(), table.angles_deg.end());
    const bool has_all = elements >= 6, has_matrix = elements >= 4;
    for (std::size_t row = 0; row < rows; ++row) {
        const auto element = [&](std::size_t e) {
            return on_angles(table.angles_deg, list(theta, row, e), list(phase, row, e), e == 0);
        };
        table.phase.push_back(element(0));
        if (!has_matrix) continue;
        std::vector<double>& ratios = table.ratios.emplace_back();
        for (const LibradtranElement& which : kLibradtran) {
            const auto values = element(has_all ? which.of_all : which.of_spheres);
            for (std::size_t a = 0; a < values.size(); ++a) {
                const double p = table.phase.back()[a];
                ratios.push_back(p == 0.0 ? 0.0 : which.sign * values[a] / p);
            }
        }
    }
}

/// Files with moments alone: Legendre's of P11, with 2l + 1 in them.
void read_libradtran_moments(const Variables& file, const std::vector<int>& entries,
                             Species& species) {
    const std::vector<int> d = file.dimensions("pmom");
    if (d.size() != 4) file.refuse("has 'pmom' without 4 dimensions");
    const auto all = file.read("pmom", {entries[0], entries[1], d[2], d[3]});
    const std::size_t elements = file.size(d[2]), longest = file.size(d[3]);
    std::vector<double> count(all.size() / longest, double(longest));
    if (file.has("nmom")) count = file.read("nmom", {entries[0], entries[1], d[2]});
    for (std::size_t place = 0; place < count.size(); place += elements) {
        MatrixCoefficients& m = species.matrices.emplace_back();
        m.a1 = part_of(all, place, longest);
        m.a1.resize(std::min(longest, std::size_t(std::max(count[place], 1.0))));
        const double mean = m.a1.front();
        for (double& value : m.a1) value /= mean;
        for (const auto& [name, elements_of] : kMatrixLists) (m.*elements_of).resize(m.a1.size());
    }
}

void read_libradtran(const Variables& file, Species& species) {
    FileScattering& table = species.scattering;
    table.wavelength_nm = scaled(file.read("wavelen"), kNmPerUm);
    const bool has_radii = file.has({"reff", "rho"});
    const int of_sizes = file.dimensions("ext").back();
    const std::vector<int> entries = {file.dimensions("wavelen").at(0), of_sizes};
    table.extinction = file.read("ext", entries);
    table.albedo = file.read("ssa", entries);
    table.has_averages = has_radii;
    if (has_radii) {
        table.radius_um = file.read("reff", {of_sizes});
        const std::vector<double> density = file.read("rho", entries);
        for (std::size_t i = 0; i < table.extinction.size(); ++i) {
            const double radius_um = table.radius_um[i % table.radius_um.size()];
            table.extinction[i] = efficiency(table.extinction[i], density[i], radius_um);
        }
    } else if (file.has("reff")) {
        file.refuse(
            "has effective radii (reff) and no densities (rho): its extinction is per mass and not "
            "per volume; add rho, in g/cm3");
    } else if (file.size(of_sizes) > 1) {
        file.refuse(
            fmt::format("has {} humidities and no effective radii; write one of them into "
                        "a file of its own, e.g. with ncks -d nhum,0",
                        file.size(of_sizes)));
    }
    if (file.has({"theta", "phase"})) {
        read_libradtran_phase(file, entries, table);
    } else {
        read_libradtran_moments(file, entries, species);
    }
}

/// Coefficients of all sizes one after the other, lmax + 1 of each.
void read_mopsmap(const Variables& file, Species& species) {
    FileScattering& table = species.scattering;
    const std::vector<double> last = file.read("lmax"), qsca = file.read("qsca");
    const double volume_over_area_radius = file.read("rat").at(0);
    // Size parameters are of spheres of the same area.
    table.radius_is_parameter = true;
    table.radius_um = scaled(file.read("sizepara"), std::pow(volume_over_area_radius, 3));
    table.area_ratio.assign(table.radius_um.size(), std::pow(volume_over_area_radius, -6));
    table.extinction = file.read("qext");
    for (std::size_t i = 0; i < table.extinction.size(); ++i)
        table.albedo.push_back(std::min(1.0, qsca.at(i) / table.extinction[i]));
    const auto a1 = file.read("a1");
    std::vector<std::vector<double>> lists;
    lists.reserve(std::size(kMatrixLists));
    for (const auto& [name, list] : kMatrixLists) lists.push_back(file.read(name));
    std::size_t first = 0;
    for (std::size_t i = 0; i < table.radius_um.size(); ++i) {
        const auto count = static_cast<std::size_t>(last.at(i)) + 1;
        if (first + count > a1.size())
            file.refuse(
                fmt::format("has {} coefficients; expected: lmax + 1 of each size, more "
                            "than {}",
                            a1.size(), first + count - 1));
        const auto some = [&](const std::vector<double>& all) {
            return std::vector<double>(all.begin() + std::ptrdiff_t(first),
                                       all.begin() + std::ptrdiff_t(first + count));
        };
        MatrixCoefficients& m = species.matrices.emplace_back();
        m.single_scattering_albedo = table.albedo[i];
        m.a1 = some(a1);
        for (std::size_t e = 0; e < lists.size(); ++e) m.*kMatrixLists[e].second = some(lists[e]);
        // As in the T-matrix programs, their functions have the other sign than d^l_02.
        for (auto* list : {&m.b1, &m.b2}) *list = scaled(std::move(*list), -1.0);
        first += count;
    }
}

/// Tables over named dimensions: wavelengths, effective sizes and angles.
struct Layout {
    std::vector<int> entries;  ///< dimensions of wavelengths and of sizes
    int angles = 0;
    const char* phase = nullptr;
    Ratio elements[MatrixOnAngles::kRatios];
    bool are_ratios = false;  ///< elements come over P11
};

void read_layout(const Variables& file, const Layout& layout, FileScattering& table) {
    std::vector<int> over = layout.entries;
    over.push_back(layout.angles);
    const std::size_t angles = file.size(layout.angles);
    const auto phase = file.read(layout.phase, over);
    const std::size_t rows = phase.size() / angles;
    for (std::size_t row = 0; row < rows; ++row) table.phase.push_back(part_of(phase, row, angles));
    table.has_averages = true;
    const bool has_matrix = std::all_of(std::begin(layout.elements), std::end(layout.elements),
                                        [&](const Ratio& e) { return file.has(e.first); });
    table.ratios.resize(has_matrix ? rows : 0);
    for (const auto& [name, sign] : layout.elements) {
        if (!has_matrix) break;
        const auto values = file.read(name, over);
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double p = layout.are_ratios ? 1.0 : phase[i];
            table.ratios[i / angles].push_back(p == 0.0 ? 0.0 : sign * values[i] / p);
        }
    }
    put_angles_in_order(table);
}

void read_ice_habits(const Variables& file, FileScattering& table) {
    const int wavelengths = file.dimensions("wavelengths").at(0),
              sizes = file.dimensions("effective_diameter").at(0);
    table.wavelength_nm = scaled(file.read("wavelengths"), kNmPerUm);
    table.radius_um = scaled(file.read("effective_diameter"), 0.5);
    table.angles_deg = file.read("phase_angles");
    table.albedo = file.read("single_scattering_albedo", {wavelengths, sizes});
    table.extinction = file.read("extinction_efficiency", {wavelengths, sizes});
    read_layout(file,
                {{wavelengths, sizes},
                 file.dimensions("phase_angles").at(0),
                 "p11_phase_function",
                 {{"p22_phase_function", 1.0},
                  {"p33_phase_function", 1.0},
                  {"p44_phase_function", 1.0},
                  {"p21_phase_function", 1.0},
                  {"p43_phase_function", -1.0}},
                 true},
                table);
}

void read_aerosol_table(const Variables& file, FileScattering& table) {
    const char* wavelength = file.has("wavelength") ? "wavelength" : "lambda";
    const int wavelengths = file.dimensions(wavelength).at(0),
              sizes = file.dimensions("rEff").at(0);
    table.wavelength_nm = scaled(file.read(wavelength), kNmPerM);
    table.radius_um = scaled(file.read("rEff", {sizes}), kUmPerM);
    table.angles_deg = file.read("ang");
    table.albedo = file.read("ssa", {wavelengths, sizes});
    table.extinction = file.read("qext", {wavelengths, sizes});
    read_layout(file,
                {{wavelengths, sizes},
                 file.dimensions("ang").at(0),
                 "p11",
                 {{"p22", 1.0}, {"p33", 1.0}, {"p44", 1.0}, {"p12", 1.0}, {"p34", 1.0}},
                 false},
                table);
}

}  // namespace

bool is_netcdf(const std::string& path) {
    if (!std::filesystem::is_regular_file(path)) return false;  // reading a pipe may not end
    std::string bytes(8, '\0');
    std::ifstream(path, std::ios::binary).read(bytes.data(), std::streamsize(bytes.size()));
    return bytes.starts_with("CDF\x01") || bytes.starts_with("CDF\x02") ||
           bytes.starts_with("CDF\x05") || bytes.starts_with("\x89HDF\r\n\x1a\n");
}

void read_scattering_netcdf(const std::string& path, Species& species) {
    const Variables file(path);
    FileScattering& table = species.scattering;
    if (file.has({"wavelen", "ext", "ssa"}) && (file.has({"theta", "phase"}) || file.has("pmom"))) {
        read_libradtran(file, species);
    } else if (file.has({"sizepara", "lmax", "qext", "qsca", "rat", "a1"})) {
        read_mopsmap(file, species);
    } else if (file.has({"wavelengths", "effective_diameter", "phase_angles",
                         "extinction_efficiency", "p11_phase_function"})) {
        read_ice_habits(file, table);
    } else if (file.has({"ang", "p11", "qext", "ssa", "rEff"})) {
        read_aerosol_table(file, table);
    } else {
        file.refuse(
            "is a NetCDF file of no known kind; known: libRadtran's (wavelen, ext, ssa, theta, "
            "phase or pmom), MOPSMAP's data set (sizepara, lmax, qext, qsca, rat, a1 ... b2), bulk "
            "scattering by ice habits (wavelengths, effective_diameter, phase_angles, "
            "p11_phase_function), aerosol tables of GEOSmie (ang, p11, qext, ssa, rEff)");
    }
    constexpr double kMissing = 1e30;  // NetCDF fills what nobody wrote with 9.97e36
    for (const auto* list : {&table.wavelength_nm, &table.radius_um, &table.extinction}) {
        for (const double value : *list) {
            if (!(value < kMissing))
                file.refuse("has wavelengths, sizes or extinctions without a value");
        }
    }
    for (double& albedo : table.albedo) {
        constexpr double kRounding = 1e-6;  // of single precision
        if (albedo > 1.0 && albedo <= 1.0 + kRounding) albedo = 1.0;
    }
}

}  // namespace miebrdf
