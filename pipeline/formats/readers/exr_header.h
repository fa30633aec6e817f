// What an OpenEXR header claims, before the library believes it.
#pragma once

#include <cstdint>
#include <string_view>

namespace miebrdf::exports {

/// A compressed image of one value can be a thousand times smaller than itself; more is an attack.
inline constexpr std::uint64_t kLargestExpansion = 2048;

/// The header is a list of name, type, size and that many bytes, up to an empty name. OpenEXR
/// allocates what a size claims before it reads: sizes beyond the file are refused here.
/// Files of several parts, which have several headers, are none of ours.
/// @throws InputError  naming the attribute, what it claims and what there is
void check_exr_header(std::string_view content);

}  // namespace miebrdf::exports
