// Parts of a scene: checks of them for those that check the whole, and the opaque lobe from words.
#pragma once

#include <miebrdf/scene.h>

#include <optional>
#include <string>

namespace miebrdf {

/// Share of the volume that equal spheres fill at most (Hales 2005: 0.7405).
inline constexpr double kDensestPacking = 0.74;

/// Bounds n and k that are written down. No matter has more than some thousands; squares of squares
/// of what is far beyond overflow.
inline constexpr double kLargestIndex = 1e6;

/// @throws UsageError  naming the value and the allowed range, like all others here
void validate(const Medium& medium);
void validate(const Host& host);
void validate(const Depth& depth);
void validate(const Substrate& substrate);

/// "rpv:RHO0,K,THETA[,RHOC], ross-li:..."
std::string forms_of_grounds();

/// The paper's opaque lobe: reads `ALPHA`, `ALPHA,beckmann` or `ALPHA,ggx`; empty for 0.
/// @throws UsageError
std::optional<rte::SurfaceOptions> rough_surface(const std::string& text);
/// In the notation of rough_surface().
std::string describe(const rte::SurfaceOptions& surface);

}  // namespace miebrdf
