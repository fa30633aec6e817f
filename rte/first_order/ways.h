// The ways of light that is scattered once in one medium, between its beams in and out.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rte/first_order/first_order.h"

namespace miebrdf::rte {

/// alpha / (1 - alpha f): what P has to be multiplied by.
double strength_of(const ScaledMedium& medium, const Optics& seen);

/// dR/dP per strength of the light that turns back and of the light that goes on, per share of both
/// beams.
struct ShareWeights {
    double back, forward;
    ShareWeights(const ScaledMedium& medium, double mu_in, double mu_out);
};

/// The ways of polarised light in and out of one medium.
struct PolarisedWays {
    double mu_in, mu_out;
    double back, forward;  // PhaseWeights but for the beams
    Eigen::Matrix4d in_down, in_up, out_down, out_up;

    /// @param F  of light that turns back, and of light that goes on
    Eigen::Matrix4d matrix(const ScatteringMatrix& F, const ScatteringMatrix& F_forward,
                           double azimuth_deg) const;
    /// Its element 11, of half the azimuth.
    double intensity(const ScatteringMatrix& F, const ScatteringMatrix& F_forward,
                     double half_cosine, double half_sine) const;
};

/// In all media, from the bottom up.
std::vector<PolarisedWays> polarised_ways(const FirstOrder& first_order, double mu_in,
                                          double mu_out);

/// The Mueller matrix of light scattered once at an azimuth of this cosine.
/// @param back, forward  overwritten by the matrices of the media
Eigen::Matrix4d scattered_matrix(const FirstOrder& first_order,
                                 const std::vector<PolarisedWays>& ways, double cosine,
                                 double azimuth_deg, std::vector<ScatteringMatrix>& back,
                                 std::vector<ScatteringMatrix>& forward);

}  // namespace miebrdf::rte
