#include "pipeline/plot/words.h"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <string_view>

namespace miebrdf::plot {
namespace {

constexpr double kTitleSize = 14.0;
constexpr double kTitleLine = 18.0;
constexpr double kTitleMargin = 12.0;
constexpr double kNoTitle = 8.0;

/// Makes as many lines as the full width needs, of about the same length.
std::vector<std::string> balanced(const std::string& text, double size, double width) {
    std::vector<std::string> lines = wrapped(text, size, width);
    for (double narrower = 0.95 * width; narrower > 0.4 * width; narrower -= 0.05 * width) {
        std::vector<std::string> next = wrapped(text, size, narrower);
        const bool fits = std::all_of(next.begin(), next.end(), [&](const std::string& line) {
            return SvgDrawing::text_width(line, size) <= width;
        });
        if (next.size() > lines.size() || !fits) break;
        lines = std::move(next);
    }
    return lines;
}

/// Whether a word stays with the number before it.
bool is_unit(std::string word) {
    constexpr const char* kUnits[] = {"nm", "\u00b5m", "um",  "mm",         "cm",
                                      "%",  "ppb",     "ppm", "kg/m\u00b2", "="};
    while (!word.empty() && std::string_view(",;:)").find(word.back()) != std::string_view::npos)
        word.pop_back();
    return std::find(std::begin(kUnits), std::end(kUnits), word) != std::end(kUnits);
}

/// Words, numbers with their units, and "\u03c4 = 0.1" as one.
std::vector<std::string> pieces_of(const std::string& text) {
    std::vector<std::string> pieces;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        if (!pieces.empty() && (is_unit(word) || pieces.back().ends_with(" ="))) {
            pieces.back() += " " + word;
        } else {
            pieces.push_back(word);
        }
    }
    return pieces;
}

}  // namespace

std::vector<std::string> wrapped(const std::string& text, double size, double width) {
    std::vector<std::string> lines;
    for (const std::string& word : pieces_of(text)) {
        const bool joins =
            !lines.empty() && SvgDrawing::text_width(lines.back() + " " + word, size) <= width;
        if (joins) {
            lines.back() += " " + word;
        } else {
            lines.push_back(word);
        }
    }
    return lines;
}

double fitting_size(const std::string& text, double size, double width) {
    const double needed = SvgDrawing::text_width(text, size);
    return needed > width ? size * width / needed : size;
}

double draw_title(SvgDrawing* drawing, const std::string& title, double page_width) {
    if (title.empty()) return kNoTitle;
    const double width = page_width - 2 * kTitleMargin;
    const std::vector<std::string> lines = balanced(title, kTitleSize, width);
    double y = 22.0 - kTitleLine;
    for (const std::string& line : lines) {
        y += kTitleLine;
        if (drawing == nullptr) continue;
        drawing->text({0.5 * page_width, y}, line,
                      {fitting_size(line, kTitleSize, width), Anchor::middle, 0, "#000000"});
    }
    return y + 8.0;
}

}  // namespace miebrdf::plot
