#include "pipeline/report/page.h"

#include <stdexcept>
#include <string_view>

#include "pipeline/io/markup.h"

// page_source.S: page.html with styles, scripts and library in their places.
extern "C" {
extern const char miebrdf_report_page[];
extern const char miebrdf_report_page_end[];
}

namespace miebrdf::report {
std::string make_page(const std::string& data, const std::string& title) {
    const std::string_view page(miebrdf_report_page,
                                std::size_t(miebrdf_report_page_end - miebrdf_report_page));
    constexpr std::string_view kTitle = "@TITLE@", kData = "@DATA@";
    const std::size_t title_at = page.find(kTitle), data_at = page.find(kData);
    if (title_at == std::string_view::npos || data_at == std::string_view::npos)
        throw std::logic_error("page.html has no @TITLE@ or no @DATA@");
    std::string text(page.substr(0, title_at));
    text += escape_markup(title);
    text += page.substr(title_at + kTitle.size(), data_at - title_at - kTitle.size());
    text += data;
    text += page.substr(data_at + kData.size());
    return text;
}

bool page_has_3d() {
#ifdef MIEBRDF_HAS_THREE
    return true;
#else
    return false;
#endif
}

}  // namespace miebrdf::report
