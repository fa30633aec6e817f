// Beams that pass a stack without being scattered: they bend, grow weaker, and come back from
// boundaries and mirrors.
#pragma once

#include <vector>

#include "rte/boundary/fresnel_matrix.h"
#include "rte/phase/stack_of_media.h"

namespace miebrdf::rte {

/// A beam from one direction in air as it passes one medium: shares of its energy, all returns
/// between boundaries and mirrors added up. Light that leaves takes the same ways backwards.
/// @tparam Light  double: the share of unpolarised light; FresnelMatrix: what becomes of polarised
///                light between the meridian planes
template <typename Light>
struct Beam {
    double mu = 1.0;  ///< in the medium
    Light down = {};  ///< at its top
    Light up = {};    ///< at its bottom, sent back by what lies below
};

/// In all media, from the bottom up as they are listed.
template <typename Light>
std::vector<Beam<Light>> beams_of(const ScaledStack& stack, double mu_air);

/// The share of light from a direction in air that boundaries and mirrors send into its mirror
/// direction without scattering.
template <typename Light>
Light mirror_reflection(const ScaledStack& stack, double mu_air);

/// The share of light from a direction in air that enters what lies below all media, be it a
/// ground, a mirror or air, without being scattered.
template <typename Light>
Light straight_transmission(const ScaledStack& stack, double mu_air);

/// The share of light under the topmost boundary that comes back without being scattered.
/// @param mu  in the topmost medium
double unscattered_return(const ScaledStack& stack, double mu);

extern template std::vector<Beam<double>> beams_of(const ScaledStack&, double);
extern template std::vector<Beam<FresnelMatrix>> beams_of(const ScaledStack&, double);
extern template double mirror_reflection(const ScaledStack&, double);
extern template FresnelMatrix mirror_reflection(const ScaledStack&, double);
extern template double straight_transmission(const ScaledStack&, double);
extern template FresnelMatrix straight_transmission(const ScaledStack&, double);

}  // namespace miebrdf::rte
