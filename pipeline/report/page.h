// The page itself: its sources (page/) and a report's data as one HTML file.
#pragma once

#include <string>

namespace miebrdf::report {

/// @param title  of the browser's window
/// @param data   PageBytes::compressed
std::string make_page(const std::string& data, const std::string& title);

/// The page of `miebrdf studio`: without numbers, which it asks the server for with this token.
std::string make_studio_page(const std::string& token);

/// Whether the page was built with three.js, which its views in 3D need; without it the sphere is
/// drawn by the processor and the lobe is shown as a cut.
bool page_has_3d();

}  // namespace miebrdf::report
