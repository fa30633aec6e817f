// SSDD 0.2 binary and ASTM E1392 text, isotropic, evaluated as libbsdf does: linear in theta_i,
// theta_o and the azimuth between the vectors, clamped to the listed angles.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <sstream>

#include "tests/support/outside/bytes.h"
#include "tests/support/outside/outside_file.h"

namespace miebrdf::support {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

/// Values [theta_i][theta_o][phi][wavelength] at listed angles in degrees.
class AngleTable : public OutsideFile {
  public:
    std::vector<double> theta_i, theta_o, phi;
    std::vector<std::vector<double>> spectra;

    std::vector<double> brdf(const Vector& light, const Vector& viewer) const override {
        const double turned = std::abs(std::remainder(
            (std::atan2(viewer.y(), viewer.x()) - std::atan2(light.y(), light.x())) * kDegrees,
            360.0));
        const Between i = between(theta_i, std::acos(light.z()) * kDegrees);
        const Between o = between(theta_o, std::acos(viewer.z()) * kDegrees);
        const Between p = between(phi, turned);
        std::vector<double> values(spectra.front().size(), 0.0);
        for (int corner = 0; corner < 8; ++corner) {
            const std::size_t a = i.low + (corner & 1), b = o.low + (corner >> 1 & 1),
                              c = p.low + static_cast<std::size_t>(corner >> 2);
            const double weight =
                i.weight(corner & 1) * o.weight(corner & 2) * p.weight(corner & 4);
            const auto& spectrum = spectra[(a * theta_o.size() + b) * phi.size() + c];
            for (std::size_t w = 0; w < values.size(); ++w) values[w] += weight * spectrum[w];
        }
        return values;
    }

  private:
    struct Between {
        std::size_t low;
        double share;
        double weight(int upper) const { return upper ? share : 1 - share; }
    };
    static Between between(const std::vector<double>& list, double x) {
        std::size_t low = 0;
        while (low + 2 < list.size() && list[low + 1] <= x) ++low;
        return {low, std::clamp((x - list[low]) / (list[low + 1] - list[low]), 0.0, 1.0)};
    }
};

std::vector<double> numbers_of(const std::string& text) {
    std::istringstream stream(text);
    std::vector<double> numbers;
    for (double x; stream >> x;) numbers.push_back(x);
    return numbers;
}

}  // namespace

std::unique_ptr<OutsideFile> ssdd_file(const std::string& bytes) {
    std::map<std::string, std::string> entries;
    const std::size_t data = bytes.find("\nDATA binary\n") + 13;
    std::istringstream header(bytes.substr(0, data));
    for (std::string line; std::getline(header, line);)
        entries[line.substr(0, line.find(' '))] =
            line.substr(std::min(line.size(), line.find(' ') + 1));
    auto table = std::make_unique<AngleTable>();
    table->theta_i = numbers_of(entries.at("PARAM0_LIST"));
    table->theta_o = numbers_of(entries.at("PARAM2_LIST"));
    table->phi = numbers_of(entries.at("PARAM3_LIST"));
    const std::size_t waves = numbers_of(entries.at("WAVELENGTH_LIST")).size();
    const std::size_t n0 = table->theta_i.size(), n2 = table->theta_o.size(),
                      n3 = table->phi.size();
    for (std::size_t p0 = 0; p0 < n0; ++p0) {
        for (std::size_t p2 = 0; p2 < n2; ++p2) {
            for (std::size_t p3 = 0; p3 < n3; ++p3) {
                const std::size_t index = p0 + n0 * (p2 + n2 * p3);
                const auto floats = numbers_at<float>(bytes, data + 4 * waves * index, waves);
                table->spectra.emplace_back(floats.begin(), floats.end());
            }
        }
    }
    return table;
}

std::unique_ptr<OutsideFile> astm_file(const std::string& bytes) {
    std::istringstream file(bytes);
    std::string line;
    while (std::getline(file, line) && line.rfind("VARS ", 0) != 0) {
    }
    // Rows may come in any order: angles (rounded to 1e-5 degrees) are the keys.
    std::set<double> lists[3];
    std::map<std::vector<double>, std::vector<double>> rows;
    while (std::getline(file, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        const std::vector<double> row = numbers_of(line);
        const auto rounded = [](double radians) {
            return std::round(radians * kDegrees * 1e5) / 1e5;
        };
        const std::vector<double> key = {rounded(row.at(0)), rounded(row.at(2)),
                                         rounded(row.at(3) - row.at(1))};
        for (std::size_t k = 0; k < 3; ++k) lists[k].insert(key[k]);
        rows[key] = {row.begin() + 4, row.end()};
    }
    auto table = std::make_unique<AngleTable>();
    table->theta_i.assign(lists[0].begin(), lists[0].end());
    table->theta_o.assign(lists[1].begin(), lists[1].end());
    table->phi.assign(lists[2].begin(), lists[2].end());
    for (const auto& row : rows) table->spectra.push_back(row.second);
    return table;
}

}  // namespace miebrdf::support
