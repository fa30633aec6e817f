// The fixed point of a half-space, by which high Fourier orders are solved: what one order and four
// side by side share.
#pragma once

namespace miebrdf::rte {

struct FourierMedium;
struct FourierMode;
struct FourierWork;
struct ZenithGrid;

/// Orders above 0 may err by the tolerance times this share of order 0: it is brightest where it
/// is, and an error counts relative to the largest value at each incidence.
inline constexpr double kShareOfOrderZero = 0.1;

/// The kernels A and B of light scattered to the same and to the opposite side (half_space.cpp),
/// between nodes and into the requested cosines, and what depends on the grid alone.
void form_sides(const FourierMedium& medium, const FourierMode& mode, const ZenithGrid& grid,
                FourierWork& work);

/// What is left to go after a step of the fixed point: each is at most `ratio` of the one before.
inline double left_after(double step, double ratio) { return step * ratio / (1.0 - ratio); }

/// Whether the fixed point arrives at `share` of its first step within so many sweeps. X scatters
/// on into X at most what the phase function returns, as both directions take their part of it.
bool arrives_within(double sweeps, double ratio, double share);

}  // namespace miebrdf::rte
