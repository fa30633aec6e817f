#include "pipeline/report/page.h"

#include <initializer_list>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "pipeline/io/markup.h"

// page_source.S: page.html with styles, scripts and library in their places, and what the studio
// has besides.
extern "C" {
extern const char miebrdf_report_page[];
extern const char miebrdf_report_page_end[];
extern const char miebrdf_studio_page[];
extern const char miebrdf_studio_page_end[];
extern const char miebrdf_studio_script[];
extern const char miebrdf_studio_script_end[];
}

namespace miebrdf::report {
namespace {

/// The page with a text in each of these places.
std::string filled(std::initializer_list<std::pair<std::string_view, std::string_view>> texts) {
    std::string_view rest(miebrdf_report_page,
                          std::size_t(miebrdf_report_page_end - miebrdf_report_page));
    std::string page;
    for (const auto& [place, text] : texts) {
        const std::size_t at = rest.find(place);
        if (at == std::string_view::npos)
            throw std::logic_error("page.html has no " + std::string(place));
        page.append(rest.substr(0, at)).append(text);
        rest.remove_prefix(at + place.size());
    }
    return page.append(rest);
}

}  // namespace

std::string make_page(const std::string& data, const std::string& title) {
    return filled({{"@TITLE@", escape_markup(title)},
                   {"@BRAND@", "report"},
                   {"@STUDIO@", ""},
                   {"@DATA@", data},
                   {"@STUDIO_SCRIPT@", ""}});
}

std::string make_studio_page(const std::string& token) {
    const std::string_view studio(miebrdf_studio_page,
                                  std::size_t(miebrdf_studio_page_end - miebrdf_studio_page));
    const std::string_view script(miebrdf_studio_script,
                                  std::size_t(miebrdf_studio_script_end - miebrdf_studio_script));
    const std::string with_token = "const StudioToken = '" + token + "';\n" + std::string(script);
    return filled({{"@TITLE@", "miebrdf studio"},
                   {"@BRAND@", "studio"},
                   {"@STUDIO@", studio},
                   {"@DATA@", ""},
                   {"@STUDIO_SCRIPT@", with_token}});
}

bool page_has_3d() {
#ifdef MIEBRDF_HAS_THREE
    return true;
#else
    return false;
#endif
}

}  // namespace miebrdf::report
