#include "materials/database/names.h"

#include <algorithm>
#include <tuple>

namespace miebrdf::materials {
namespace {

// Optimal string alignment distance, three rows.
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> two_back(b.size() + 1), back(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) back[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t substitution = back[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = std::min({back[j] + 1, row[j - 1] + 1, substitution});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = std::min(row[j], two_back[j - 2] + 1);
            }
        }
        std::swap(two_back, back);
        std::swap(back, row);
    }
    return back[b.size()];
}

}  // namespace

std::string normalised(std::string_view name) {
    std::string key;
    key.reserve(name.size());
    for (std::size_t i = 0; i < name.size(); ++i) {
        // U+2080 to U+2089, the digits of "TiO\u2082" as they are printed.
        const unsigned last = i + 2 < name.size() ? static_cast<unsigned char>(name[i + 2]) : 0;
        if (name.substr(i, 2) == "\xe2\x82" && last >= 0x80 && last <= 0x89) {
            key += static_cast<char>('0' + (last - 0x80));
            i += 2;
            continue;
        }
        const char c = name[i];
        if (c == ' ' || c == '_' || c == '-' || c == '\t') continue;
        key += (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return key;
}

std::vector<std::string> nearest_names(std::string_view asked,
                                       const std::vector<std::string>& known, std::size_t at_most) {
    const std::string key = normalised(asked.substr(0, 100));
    const std::size_t reach = std::max<std::size_t>(2, key.size() / 3);
    std::vector<std::tuple<bool, std::size_t, std::string>> ranked;
    for (const std::string& name : known) {
        const std::string other = normalised(name);
        const bool starts = !key.empty() && other.starts_with(key);
        const std::size_t distance = edit_distance(key, other);
        // "Xy" is within two edits of every chemical symbol: at least half of the name must agree.
        const bool alike = distance <= reach && 2 * distance <= std::max(key.size(), other.size());
        if (starts || alike) ranked.emplace_back(!starts, distance, name);
    }
    std::sort(ranked.begin(), ranked.end());
    std::vector<std::string> names;
    for (const auto& [not_start, distance, name] : ranked) {
        if (names.size() == at_most) break;
        names.push_back(name);
    }
    return names;
}

}  // namespace miebrdf::materials
