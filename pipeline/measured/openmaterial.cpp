// ASAM OpenMATERIAL 3D, look-up tables of BRDFs (.xompt): JSON whose rows are wavelength in m,
// zenith angles of incidence and exit and their azimuth in radians, BRDF in 1/sr.
// https://github.com/asam-ev/OpenMATERIAL-3D, schemas/material_brdf_schema.json
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "materials/readers/text_table.h"
#include "pipeline/measured/azimuth.h"

namespace miebrdf::measured {
namespace {

bool looks_like_openmaterial(const MeasuredFile& file) {
    const std::size_t first = file.content.find_first_not_of(" \t\r\n");
    const auto has = [&](std::string_view part) {
        return file.content.find(part) != std::string_view::npos;
    };
    return first != std::string_view::npos && file.content[first] == '{' &&
           ((has("\"lookupTable\"") && has("\"brdf\"")) || has("\"openMaterial3dVersion\"") ||
            has("\"OpenMaterial_"));
}

Measurements read_openmaterial(const MeasuredFile& file, const MeasuredOptions& options) {
    constexpr double kNmPerM = 1e9, kLongest = 1e-3 * kNmPerM, kDegrees = 180.0 / std::numbers::pi;
    materials::ReadingBudget::require_values(
        std::size_t(std::count(file.content.begin(), file.content.end(), ',')), file.path);
    Measurements list;
    std::vector<RawDirection> raw;
    try {
        const nlohmann::json root = nlohmann::json::parse(file.content);
        if (!root.contains("brdf")) {
            refuse(file, 0,
                   "an OpenMATERIAL file without a look-up table of a BRDF. Its parameters and "
                   "emissivities are no measurements; its refractive indices are read by `miebrdf "
                   "materials import`");
        }
        list.samples = {root.value("metadata", nlohmann::json::object()).value("name", "table")};
        for (const nlohmann::json& row : root.at("brdf").at("lookupTable")) {
            if (row.size() != 5) {
                refuse(file, 0,
                       fmt::format("row {} of lookupTable has {} numbers; expected: 5",
                                   raw.size() + 1, row.size()));
            }
            const auto number = [&](std::size_t c) {
                return row.at(c).is_null() ? MeasuredValue::kNone : row.at(c).get<double>();
            };
            MeasuredValue value;
            value.quantity = MeasuredQuantity::brdf;
            value.geometry = MeasuredGeometry::directions;
            value.wavelength_nm = kNmPerM * number(0);
            if (value.wavelength_nm > kLongest)
                refuse(file, 0,
                       fmt::format("row {} of lookupTable: a wavelength of {} m; allowed: up to "
                                   "1e-3. The format has metres, not nm or um",
                                   raw.size() + 1, number(0)));
            value.value = number(4);
            RawDirection direction;
            direction.theta_in = kDegrees * number(1);
            direction.theta_out = kDegrees * number(2);
            direction.phi = kDegrees * number(3);
            direction.value = list.values.size();
            list.values.push_back(value);
            raw.push_back(direction);
        }
    } catch (const nlohmann::json::exception& error) {
        refuse(file, 0, fmt::format("no look-up table of a BRDF: {}", error.what()));
    }
    set_directions(list, raw, options, file);
    return list;
}

}  // namespace

extern const Reader kOpenMaterial;
constinit const Reader kOpenMaterial{{"openmaterial", "ASAM OpenMATERIAL 3D BRDF tables (.xompt)"},
                                     looks_like_openmaterial,
                                     read_openmaterial};

}  // namespace miebrdf::measured
