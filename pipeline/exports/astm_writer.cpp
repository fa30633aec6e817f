#include "pipeline/exports/astm_writer.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pipeline/exports/half_vector.h"
#include "pipeline/exports/metadata.h"
#include "pipeline/exports/polar_grid.h"

namespace miebrdf::exports {

void write_astm(const BrdfSource& source, int intervals, std::ostream& out,
                const RunControl& control) {
    require_wavelengths(source, "astm");
    const PolarGrid grid = make_polar_grid("astm", intervals);
    std::vector<Direction> directions;
    std::vector<std::string> angles;
    for (const double theta_in : grid.theta_deg) {
        for (const double theta_out : grid.theta_deg) {
            for (const double azimuth : grid.azimuth_deg) {
                directions.push_back(
                    {std::cos(theta_in * kDegree), std::cos(theta_out * kDegree), 180.0 - azimuth});
                angles.push_back(fmt::format("{:.9g},0,{:.9g},{:.9g}", theta_in * kDegree,
                                             theta_out * kDegree, azimuth * kDegree));
            }
        }
    }
    const std::vector<double> values = evaluate_all(source, directions, "table", control);
    const auto description = metadata(source, {.format = "astm",
                                               .cosine_included = false,
                                               .azimuth_zero = "towards the source",
                                               .colour = ""});
    out << "TITLE " << source.provenance().title << "\nCOMMENT " << description.dump() << '\n';
    out << "NUM_POINTS " << directions.size() << "\nVARS theta_i,phi_i,theta_s,phi_s";
    for (const double wavelength : source.wavelength_nm()) out << fmt::format(",{}nm", wavelength);
    out << '\n';
    const std::size_t channels = source.wavelength_nm().size();
    for (std::size_t d = 0; d < directions.size(); ++d) {
        const auto first = values.begin() + static_cast<std::ptrdiff_t>(d * channels);
        out << angles[d] << ','
            << fmt::format("{:.9g}\n",
                           fmt::join(first, first + static_cast<std::ptrdiff_t>(channels), ","));
    }
}

}  // namespace miebrdf::exports
