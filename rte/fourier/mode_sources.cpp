#include "rte/fourier/mode_sources.h"

namespace miebrdf::rte {

PhaseRows phase_rows(const ScatteringMode& medium, const PhaseMode& mode) {
    return {even_columns(mode.at_requested) * even_part(medium.strengths).asDiagonal() *
                even_columns(mode.scaled_nodes).transpose(),
            odd_columns(mode.at_requested) * odd_part(medium.strengths).asDiagonal() *
                odd_columns(mode.scaled_nodes).transpose()};
}

void ModeSources::find(const ScatteringMode& medium, const PhaseMode& mode,
                       const TransferModes& modes) {
    const Eigen::Index requested = mode.at_requested.rows();
    const Eigen::Index nodes = mode.scaled_nodes.rows();
    const auto even_degrees = even_columns(mode.scaled_nodes);
    const auto odd_degrees = odd_columns(mode.scaled_nodes);
    weighted_.resize(requested, even_degrees.cols());
    weighted_ = even_columns(mode.at_requested) * even_part(medium.strengths).asDiagonal();
    even.resize(requested, modes.vectors.cols());
    odd.resize(requested, modes.vectors.cols());
    // From the side that has fewer rows: the degrees (few in high orders) or the cosines.
    const bool few_cosines = requested < mode.at_requested.cols() / 2;
    if (few_cosines) {
        degrees_.resize(requested, nodes);
        degrees_.noalias() = weighted_ * even_degrees.transpose();
        product_.resize(requested, nodes);
        product_.noalias() = degrees_ * modes.odd;
        even.noalias() = product_ * modes.vectors;
    } else {
        product_.resize(even_degrees.cols(), nodes);
        product_.noalias() = even_degrees.transpose() * modes.odd;
        degrees_.resize(even_degrees.cols(), modes.vectors.cols());
        degrees_.noalias() = product_ * modes.vectors;
        even.noalias() = weighted_ * degrees_;
    }
    weighted_.resize(requested, odd_degrees.cols());
    weighted_ = odd_columns(mode.at_requested) * odd_part(medium.strengths).asDiagonal();
    if (few_cosines) {
        product_.noalias() = weighted_ * odd_degrees.transpose();
        odd.noalias() = product_ * modes.vectors;
    } else {
        degrees_.resize(odd_degrees.cols(), modes.vectors.cols());
        degrees_.noalias() = odd_degrees.transpose() * modes.vectors;
        odd.noalias() = weighted_ * degrees_;
    }
}

}  // namespace miebrdf::rte
