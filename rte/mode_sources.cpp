#include "rte/mode_sources.h"

namespace miebrdf::rte {

PhaseRows phase_rows(const ScatteringMode& medium, const PhaseMode& mode) {
    return {even_columns(mode.at_requested) * even_part(medium.strengths).asDiagonal() *
                even_columns(mode.scaled_nodes).transpose(),
            odd_columns(mode.at_requested) * odd_part(medium.strengths).asDiagonal() *
                odd_columns(mode.scaled_nodes).transpose()};
}

ModeSources mode_sources(const ScatteringMode& medium, const PhaseMode& mode,
                         const TransferModes& modes) {
    // From the side that has fewer rows: the degrees (few in high orders) or the cosines.
    if (mode.at_requested.rows() < mode.at_requested.cols() / 2) {
        const PhaseRows rows = phase_rows(medium, mode);
        return {(rows.even * modes.odd) * modes.vectors, rows.odd * modes.vectors};
    }
    const Eigen::MatrixXd even_degrees =
        (even_columns(mode.scaled_nodes).transpose() * modes.odd) * modes.vectors;
    const Eigen::MatrixXd odd_degrees = odd_columns(mode.scaled_nodes).transpose() * modes.vectors;
    return {
        even_columns(mode.at_requested) * even_part(medium.strengths).asDiagonal() * even_degrees,
        odd_columns(mode.at_requested) * odd_part(medium.strengths).asDiagonal() * odd_degrees};
}

}  // namespace miebrdf::rte
