#include "pipeline/formats/astm_writer.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pipeline/formats/metadata.h"
#include "pipeline/formats/polar_grid.h"
#include "pipeline/solve/vector_pairs.h"

namespace miebrdf::exports {

void write_astm(const BrdfSource& source, int intervals, std::ostream& out,
                const RunControl& control) {
    require_wavelengths(source, "astm");
    const PolarGrid grid = make_polar_grid("astm", intervals);
    const auto description = metadata(source, {.format = "astm",
                                               .cosine_included = false,
                                               .azimuth_zero = "towards the source",
                                               .colour = ""});
    out << "TITLE " << source.provenance().title << "\nCOMMENT " << description.dump() << '\n';
    const std::size_t thetas = grid.theta_deg.size();
    out << "NUM_POINTS " << thetas * thetas * grid.azimuth_deg.size()
        << "\nVARS theta_i,phi_i,theta_s,phi_s";
    for (const double wavelength : source.wavelength_nm()) out << fmt::format(",{}nm", wavelength);
    out << '\n';
    const std::size_t channels = source.wavelength_nm().size();
    for (std::size_t i = 0; i < thetas; ++i) {  // one incidence at a time
        std::vector<Direction> directions;
        std::vector<std::string> angles;
        for (const double theta_out : grid.theta_deg) {
            for (const double azimuth : grid.azimuth_deg) {
                directions.push_back({std::cos(grid.theta_deg[i] * kDegree),
                                      std::cos(theta_out * kDegree), 180.0 - azimuth});
                angles.push_back(fmt::format("{:.9g},0,{:.9g},{:.9g}", grid.theta_deg[i] * kDegree,
                                             theta_out * kDegree, azimuth * kDegree));
            }
        }
        const auto stage = fmt::format("incidence {} of {}", i + 1, thetas);
        const std::vector<double> values = evaluate_all(source, directions, stage, control);
        for (std::size_t d = 0; d < directions.size(); ++d) {
            const auto row = std::span(values).subspan(d * channels, channels);
            out << angles[d] << ',' << fmt::format("{:.9g}\n", fmt::join(row, ","));
        }
    }
}

}  // namespace miebrdf::exports
