#include "tests/plot/svg_text.h"

#include <regex>
#include <sstream>

namespace miebrdf::support {

bool is_well_formed(const std::string& xml) {
    std::vector<std::string> open;
    static const std::regex tag(
        R"re(<([/?]?)([A-Za-z]+)((?:\s+[-A-Za-z0-9:]+="[^"<]*")*)\s*([/?]?)>)re");
    static const std::regex good_text(R"re((?:[^&<]|&(?:amp|lt|gt|quot|#39);)*)re");
    std::size_t at = 0;
    while (at < xml.size()) {
        const std::size_t next = xml.find('<', at);
        if (!std::regex_match(xml.substr(at, next == std::string::npos ? next : next - at),
                              good_text))
            return false;
        if (next == std::string::npos) break;
        const std::size_t end = xml.find('>', next);
        if (end == std::string::npos) return false;
        std::smatch match;
        const std::string element = xml.substr(next, end - next + 1);
        if (!std::regex_match(element, match, tag)) return false;
        if (match[1] == "/") {
            if (open.empty() || open.back() != match[2]) return false;
            open.pop_back();
        } else if (match[1] != "?" && match[4] != "/") {
            open.push_back(match[2]);
        }
        at = end + 1;
    }
    return open.empty();
}

std::vector<std::string> attributes(const std::string& svg, const std::string& element,
                                    const std::string& name) {
    std::vector<std::string> values;
    for (std::size_t at = svg.find("<" + element + " "); at != std::string::npos;
         at = svg.find("<" + element + " ", at + 1)) {
        const std::string tag = svg.substr(at, svg.find('>', at) - at);
        const std::size_t from = tag.find(" " + name + "=\"");
        if (from == std::string::npos) continue;
        const std::size_t start = from + name.size() + 3;
        values.push_back(tag.substr(start, tag.find('"', start) - start));
    }
    return values;
}

std::vector<std::string> texts(const std::string& svg) {
    std::vector<std::string> found;
    for (std::size_t at = svg.find("<text "); at != std::string::npos;
         at = svg.find("<text ", at + 1)) {
        const std::size_t start = svg.find('>', at) + 1;
        found.push_back(svg.substr(start, svg.find("</text>", start) - start));
    }
    return found;
}

std::vector<std::pair<double, double>> points(const std::string& list) {
    std::vector<std::pair<double, double>> found;
    std::istringstream stream(list);
    double x = 0, y = 0;
    for (char comma = 0; stream >> x >> comma >> y;) found.emplace_back(x, y);
    return found;
}

}  // namespace miebrdf::support
