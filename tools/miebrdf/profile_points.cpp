#include "tools/miebrdf/profile_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"

namespace miebrdf::program {
namespace {

/// Where the wanted columns are.
struct Columns {
    std::size_t wavelength, mu_in, mu_out, azimuth, value;
    double scale;  ///< from the value to a BRDF
};

std::size_t place_of(const std::vector<std::string>& names, const std::string& name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

Columns columns_of(const std::vector<std::string>& names, const std::string& path) {
    Columns columns{place_of(names, "wavelength_nm"), place_of(names, "mu_in"),
                    place_of(names, "mu_out"),        place_of(names, "azimuth_deg"),
                    place_of(names, "brdf"),          1.0};
    if (columns.value == names.size()) {
        columns.value = place_of(names, "reflection");
        columns.scale = 1.0 / std::numbers::pi;
    }
    for (const std::size_t place :
         {columns.wavelength, columns.mu_in, columns.mu_out, columns.azimuth, columns.value}) {
        if (place < names.size()) continue;
        throw InputError(fmt::format(
            "points '{}': wanted columns: wavelength_nm, mu_in, mu_out, azimuth_deg, and brdf or "
            "reflection",
            path));
    }
    return columns;
}

ProfilePoint point_of(const std::vector<std::string>& fields, const Columns& columns) {
    const auto number = [&](std::size_t place, const char* name) {
        return parse_number(fields.at(place), name);
    };
    return {number(columns.wavelength, "wavelength_nm"), number(columns.mu_in, "mu_in"),
            number(columns.mu_out, "mu_out"), number(columns.azimuth, "azimuth_deg"),
            columns.scale * number(columns.value, "brdf")};
}

}  // namespace

std::vector<ProfilePoint> read_profile_points(const std::string& path) {
    std::ifstream file(path);
    if (!file) throw InputError(fmt::format("points '{}': cannot be read", path));
    std::vector<ProfilePoint> points;
    std::vector<std::string> names;
    Columns columns{};
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        if (line.empty() || line.front() == '#') continue;
        const std::vector<std::string> fields = split_list(line);
        if (names.empty()) {
            names = fields;
            columns = columns_of(names, path);
            continue;
        }
        if (fields.size() != names.size()) {
            throw InputError(fmt::format("points '{}' line {}: {} fields for {} columns", path,
                                         number, fields.size(), names.size()));
        }
        try {
            points.push_back(point_of(fields, columns));
        } catch (const UsageError& error) {
            throw InputError(fmt::format("points '{}' line {}: {}", path, number, error.what()));
        }
    }
    if (points.empty()) throw InputError(fmt::format("points '{}': no values", path));
    return points;
}

}  // namespace miebrdf::program
