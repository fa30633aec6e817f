#include "tools/miebrdf/studio_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <regex>
#include <set>

#include <miebrdf/error.h>
#include "materials/database/user_file.h"

namespace miebrdf::program {
namespace {

using nlohmann::json;

// What a page asks for by mistake or on purpose ends here; a person's scene is far below.
constexpr std::size_t kMostValues = 32, kMostCharacters = 2000, kMostWavelengths = 128;
constexpr double kLeastTolerance = 1e-4;
constexpr int kMostStreams = 64;

constexpr char kPageMark[] = "# page: ";

/// `hg:0.9,0.5` is a medium, `hg:FILE` is a file; `paste:NAME` is one that is built in.
void refuse_files(const std::string& word, const std::string& text) {
    static const std::regex pattern(
        "(^|[\\s+(,=])(hg|dhg|lambert|moments|matrix|scattering|paste|sizes)\\s*[:=]\\s*"
        "([^,\\s+@]*)",
        std::regex::icase);
    const auto refuse = [&] {
        throw UsageError(word, text, "words without files: a page reads nothing of the disk");
    };
    for (auto at = std::sregex_iterator(text.begin(), text.end(), pattern);
         at != std::sregex_iterator(); ++at) {
        const std::string kind = (*at)[2].str(), value = (*at)[3].str();
        const bool is_number =
            !value.empty() && value.find_first_not_of("+-.0123456789eE%{}=") == std::string::npos;
        const bool is_name = value.find_first_of("./\\~") == std::string::npos;
        if (!is_number && !(kind == "paste" && is_name)) refuse();
    }
}

WordValue value_from(const std::string& name, const json& value) {
    if (value.is_boolean()) return value.get<bool>();
    if (!value.is_string())
        throw UsageError(name, value.dump(), "a text as on the command line, or true");
    const auto text = value.get<std::string>();
    const bool is_plain = std::none_of(text.begin(), text.end(),
                                       [](unsigned char c) { return c < ' ' || c == 0x7f; });
    if (text.empty() || text.size() > kMostCharacters || !is_plain)
        throw UsageError(name, text.substr(0, 40), "a line of 1 to 2000 characters");
    refuse_files(name, text);
    return text;
}

}  // namespace

SaidWords words_from_page(const json& page) {
    if (!page.is_object()) throw UsageError("words", page.dump().substr(0, 40), "an object");
    SaidWords said;
    for (const auto& [name, values] : page.items()) {
        const SceneWord* word = find_scene_word(name);
        if (word == nullptr || name == "database")
            throw UsageError("word", name, "a word of a scene: base, coat, boundary, ...");
        if (!values.is_array() || values.size() > kMostValues)
            throw UsageError(name, values.dump().substr(0, 40), "a list of at most 32 values");
        for (const json& value : values) said[name].push_back(value_from(name, value));
    }
    return said;
}

json words_for_page(const SaidWords& said) {
    json page = json::object();
    for (const auto& [name, values] : said) {
        for (const WordValue& value : values) {
            if (const bool* flag = std::get_if<bool>(&value))
                page[name].push_back(*flag);
            else
                page[name].push_back(text_of(value));
        }
    }
    return page;
}

Request request_of_page(const SaidWords& said) {
    Request request = request_of(said);
    if (request.wavelength_nm.empty())
        apply(*find_scene_word("wavelengths"), std::vector<WordValue>{std::string("400:700:20")},
              request);
    if (request.wavelength_nm.size() > kMostWavelengths) {
        throw UsageError("wavelengths", double(request.wavelength_nm.size()),
                         "at most 128 on a page that is solved while one waits");
    }
    if (!(request.solver.tolerance >= kLeastTolerance))
        throw UsageError("tolerance", request.solver.tolerance, "1e-4 and above on this page");
    if (request.solver.streams > kMostStreams)
        throw UsageError("streams", request.solver.streams, "at most 64 on this page");
    request.scene.database = materials::from_environment("MIEBRDF_DATABASE");
    return request;
}

std::vector<std::string> arguments_of(const SaidWords& said) {
    std::vector<std::string> arguments;
    for (const auto& [name, values] : said) {
        const bool is_flag = find_scene_word(name)->kind == WordKind::flag;
        for (const WordValue& value : values) {
            if (is_flag && std::holds_alternative<bool>(value) && !std::get<bool>(value)) continue;
            arguments.push_back("--" + name);
            if (!is_flag) arguments.push_back(text_of(value));
        }
    }
    return arguments;
}

std::string scene_file_of(const SaidWords& said, const std::string& page) {
    std::string text = "# A scene of miebrdf studio: miebrdf run, report, studio read it.\n";
    for (const auto& [name, values] : said) {
        if (!values.empty()) text += toml_of(*find_scene_word(name), values) + "\n";
    }
    if (!page.empty()) text += kPageMark + page + "\n";
    return text + "\n[[result]]\ncommand = \"report\"\noutput = \"studio.html\"\n";
}

std::string page_of_scene_file(const std::string& text) {
    const std::size_t at = text.find(kPageMark);
    if (at == std::string::npos || (at > 0 && text[at - 1] != '\n')) return "";
    const std::size_t from = at + std::size(kPageMark) - 1;
    return text.substr(from, text.find('\n', from) - from);
}

std::string python_of(const SaidWords& said) {
    static const std::map<std::string, std::string> kNames = {
        {"coat", "coats"},
        {"effective-radius", "effective_radius_um"},
        {"host-index", "host"},
        {"layer-density", "layer_density_kg_m3"}};
    // Words that the classes take as texts; all others as numbers.
    static const std::set<std::string> kTexts = {
        "base",          "substrate",   "boundary", "coupling",  "size-distribution",
        "interpolation", "extrapolate", "packing",  "host-index"};
    static const std::set<std::string> kOfSolve = {"tolerance", "stokes", "streams"};
    std::string scene, solve, left_out;
    for (const auto& [name, values] : said) {
        if (values.empty() || name == "wavelengths") continue;
        const SceneWord& word = *find_scene_word(name);
        const std::string text = text_of(values.front());
        std::string value;
        if (word.kind == WordKind::flag) {
            value = "True";
        } else if (word.kind == WordKind::repeated || kTexts.count(name) > 0) {
            const std::string line = toml_of(word, values);  // Python writes texts and lists alike
            value = line.substr(line.find('=') + 2);
        } else if (text.find_first_not_of("+-.0123456789eE") == std::string::npos) {
            value = text;
        }
        const bool of_solve = kOfSolve.count(name) > 0;
        if (of_solve && text == "auto") continue;
        if (value.empty() || (word.group == "Method" && !of_solve)) {
            left_out += fmt::format("# not written here: --{} {}\n", name, text);
            continue;
        }
        const auto found = kNames.find(name);
        std::string key = found == kNames.end() ? name : found->second;
        std::replace(key.begin(), key.end(), '-', '_');
        if (of_solve)
            solve += fmt::format(", {}={}", key, value);
        else
            scene += fmt::format("{}{}={}", scene.empty() ? "" : ",\n                      ", key,
                                 value);
    }
    return fmt::format(
        "import miebrdf\n\n{}scene = miebrdf.Scene({})\nsolved = scene.solve([{}]{})\n"
        "print(solved.albedo(theta_in_deg=45))\n",
        left_out, scene, fmt::join(request_of_page(said).wavelength_nm, ", "), solve);
}

}  // namespace miebrdf::program
