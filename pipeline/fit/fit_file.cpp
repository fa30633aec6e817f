// Fit files: [scene], [unknowns], [fit] and a [[measured]] for each data set; files of recipes,
// which have a [[target]] in its place.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "pipeline/fit/match_problem.h"
#include "pipeline/fit/measured_values.h"
#include "pipeline/fit/problem.h"
#include "pipeline/scene/number_list.h"
#include "pipeline/scene/toml_file.h"

namespace miebrdf {
namespace {

constexpr char kKind[] = "fit file", kMatchKind[] = "match file";
const std::vector<std::string> kMeasuredKeys = {"file",
                                                "column",
                                                "quantity",
                                                "name",
                                                "wavelengths",
                                                "wavelength_nm",
                                                "values",
                                                "sigma",
                                                "scale",
                                                "relative_sigma",
                                                "diffuse_fraction",
                                                "sky",
                                                "light",
                                                "mu_in",
                                                "mu_out",
                                                "azimuth",
                                                "theta_in",
                                                "theta_out",
                                                "azimuth_zero",
                                                "percent",
                                                "scene",
                                                "wavelength_shift",
                                                "band_width",
                                                "correlation_length",
                                                "sphere",
                                                "other_sphere",
                                                "lost_light"};

class FitFile : TomlFile {
  public:
    FitFile(const std::string& text, std::string folder, const std::string& name,
            const char* kind = kKind)
        : TomlFile(kind, name, text), folder_(std::move(folder)) {}

    FitProblem read() {
        check_keys(root(), {"title", "scene", "unknowns", "derived", "measured", "fit"}, "key");
        read_unknowns();
        if (root().get("derived") != nullptr) {
            const std::string form = "mus = \"a*(wavelength_nm/500)^-b\" for {mus}";
            for (const auto& [name, node] : in_order(table_of("derived", form))) {
                const auto text = node->value_exact<std::string>();
                if (!text) refuse(*node, fmt::format("'{}' is a text, {}", name, form));
                problem_.derived.push_back({std::string(name), *text});
            }
        }
        read_how();
        const toml::node* sets = root().get("measured");
        if (sets == nullptr || !sets->is_array_of_tables())
            throw InputError(
                fmt::format("{} '{}' has no [[measured]]; add one with file = \"measured.csv\"",
                            kKind, path()));
        for (const toml::node& set : *sets->as_array()) read_measured(*set.as_table());
        at(*root().get("unknowns"), [&] { fitting::checked(problem_); });
        for (std::size_t i = 0; i < problem_.data.size(); ++i) {
            at(*sets->as_array()->get(i),
               [&] { fitting::check_scene(problem_, problem_.data[i]); });
        }
        return std::move(problem_);
    }

    /// @throws UsageError, InputError  as read()
    MatchProblem read_match() {
        check_keys(root(), {"title", "scene", "unknowns", "target", "cost", "batch", "limits"},
                   "key");
        read_unknowns();
        MatchProblem match{.scene = problem_.scene, .unknowns = problem_.unknowns};
        const auto numbers_in = [&](const std::string& key, const std::vector<std::string>& known,
                                    const auto& use) {
            const toml::node* node = root().get(key);
            if (node == nullptr) return;
            const toml::table& table = table_of(key, "");
            check_keys(table, known, "key");
            for (const auto& [name, one] : in_order(table)) {
                const double number = number_of(*one, name);
                if (!(number >= 0.0 && std::isfinite(number)))
                    refuse(*one, fmt::format("'{}' is {}; allowed: >= 0", name, number));
                use(name, number);
            }
        };
        std::vector<std::string> names;
        for (const Unknown& unknown : match.unknowns) names.push_back(unknown.name);
        numbers_in("cost", names, [&](const std::string& name, double number) {
            match.cost_per_kg.emplace_back(name, number);
        });
        numbers_in("batch", {"grams"},
                   [&](const std::string&, double number) { match.batch_grams = number; });
        numbers_in("limits", {"total_volume", "thickness_um"},
                   [&](const std::string& name, double number) {
                       (name == "total_volume" ? match.most_volume : match.most_thickness_um) =
                           number;
                   });
        const toml::node* sets = root().get("target");
        if (sets == nullptr || !sets->is_array_of_tables())
            throw InputError(fmt::format(
                "{} '{}' has no [[target]]; add one with lab = [60, 25, 20] and light = \"d65,10\"",
                kMatchKind, path()));
        for (const toml::node& set : *sets->as_array())
            match.targets.push_back(target_of(*set.as_table(), match.targets.size() + 1));
        at(*root().get("unknowns"), [&] { fitting::check_match(match); });
        return match;
    }

  private:
    void read_unknowns() {
        problem_.scene = scene_of(table_of("scene", "whose keys are the words of a scene file"));
        for (const auto& [name, node] :
             in_order(table_of("unknowns", "radius = \"100 in 20:1000 log\" for {radius}"))) {
            const auto text = node->value_exact<std::string>();
            if (!text)
                refuse(*node, fmt::format("unknown '{}' is a text, \"START in LOW:HIGH\"; a number "
                                          "that is known stands in [scene] itself",
                                          name));
            at(*node, [&, &key = name] { problem_.unknowns.push_back(unknown(key, *text)); });
        }
    }

    MatchTarget target_of(const toml::table& set, std::size_t number) const {
        check_keys(set,
                   {"name", "lab", "file", "column", "quantity", "percent", "light", "mu_in",
                    "mu_out", "azimuth", "theta_in", "theta_out", "azimuth_zero", "scene"},
                   "key");
        fitting::MeasuredWords words = measured_words(set);
        MatchTarget target{.name = text_of(set, "name"), .options = words.options};
        if (target.name.empty()) target.name = fmt::format("target {}", number);
        target.scene = own_scene(set);
        std::vector<std::string> lights;
        if (const toml::node* light = set.get("light"); light != nullptr && light->is_array()) {
            for (const toml::node& one : *light->as_array())
                lights.push_back(one.value_or(std::string()));
        } else {
            lights.push_back(text_of(set, "light"));
        }
        const std::vector<double> lab = numbers_of_key(set, "lab");
        if (words.file.empty() == lab.empty())
            refuse(set,
                   "a [[target]] has lab = [60, 25, 20] or file = \"colour.csv\", one of them");
        at(set, [&] {
            FitData data{.name = target.name};
            if (words.file.empty()) {
                words.values = lab;
                words.options.quantity = "lab";
            }
            fitting::read_values(words, data);
            fitting::check_data(data);
            for (const std::string& light : lights)
                target.colours.push_back(
                    {light.empty() ? "d65" : light,
                     fitting::colour_of(data, viewing(light.empty() ? "d65" : light))});
            const MeasuredValue& first = data.values.front();
            if (first.quantity >= MeasuredQuantity::lab_l && target.colours.size() > 1)
                throw UsageError(
                    "a Lab is seen in one light; give each light a [[target]] of its own");
            fitting::set_geometry(target.options, first);
        });
        return target;
    }

    std::vector<SceneText> own_scene(const toml::table& set) const {
        const toml::node* own = set.get("scene");
        if (own == nullptr) return {};
        if (!own->is_table()) refuse(*own, "'scene' is { word = \"value\" }");
        return scene_of(*own->as_table());
    }

    std::string text_of_value(const toml::node& node) const {
        if (const auto flag = node.value_exact<bool>()) return *flag ? "true" : "false";
        if (const auto text = node.value_exact<std::string>()) {
            at(node, [&] { gaps_in(*text); });
            return with_files_in(*text, folder_);
        }
        const auto number = node.value<double>();
        if (!number) refuse(node, "a number, a text or a list of them");
        return fmt::format("{}", *number);
    }

    std::vector<SceneText> scene_of(const toml::table& table) const {
        check_keys(table, scene_word_names("wavelengths"), "word");
        std::vector<SceneText> words;
        for (const auto& [name, node] : in_order(table)) {
            SceneText word{name, {}};
            if (const toml::array* list = node->as_array()) {
                for (const toml::node& item : *list) word.values.push_back(text_of_value(item));
            } else {
                word.values.push_back(text_of_value(*node));
            }
            words.push_back(std::move(word));
        }
        return words;
    }

    double number_of(const toml::node& node, const std::string& key) const {
        const auto number = node.value<double>();
        if (!number || node.is_boolean()) {
            const std::string text = node.value_or(std::string());
            refuse(node, fmt::format("'{}' is a number{}", key,
                                     text.empty() ? "" : fmt::format("; given: '{}'", text)));
        }
        return *number;
    }

    std::optional<double> number_of_key(const toml::table& table, const std::string& key) const {
        const toml::node* node = table.get(key);
        return node == nullptr ? std::optional<double>() : number_of(*node, key);
    }

    std::vector<double> numbers_of_key(const toml::table& table, const std::string& key) const {
        const toml::node* node = table.get(key);
        if (node == nullptr) return {};
        if (const auto text = node->value_exact<std::string>()) {
            std::vector<double> list;
            at(*node, [&] { list = parse_number_list(*text, key); });
            return list;
        }
        const toml::array* list = node->as_array();
        if (list == nullptr) return {number_of(*node, key)};
        std::vector<double> numbers;
        for (const toml::node& item : *list) numbers.push_back(number_of(item, key));
        return numbers;
    }

    void read_how() {
        const toml::node* node = root().get("fit");
        if (node == nullptr) return;
        const toml::table& how = table_of("fit", "starts, loss, iterations");
        check_keys(how, {"starts", "loss", "iterations"}, "key");
        const auto count_of = [&](const std::string& key, int& count) {
            const auto number = number_of_key(how, key);
            if (!number) return;
            if (!(std::abs(*number) <= 1e6) || *number != std::floor(*number))
                refuse(*how.get(key),
                       fmt::format("'{}' is {}; allowed: a whole number", key, *number));
            count = int(*number);
        };
        count_of("starts", problem_.starts);
        count_of("iterations", problem_.most_iterations);
        if (const toml::node* loss = how.get("loss"))
            at(*loss, [&] { fitting::set_loss(problem_, text_of(how, "loss")); });
        at(*node, [&] { fitting::check_search(problem_); });
    }

    /// The cosine that either of two keys says.
    std::optional<double> cosine_of(const toml::table& set, const std::string& side) const {
        const auto mu = number_of_key(set, "mu_" + side),
                   theta = number_of_key(set, "theta_" + side);
        if (mu && theta)
            refuse(*set.get("theta_" + side),
                   fmt::format("mu_{0} and theta_{0} say the same; give one of them", side));
        if (theta && !(*theta >= 0.0 && *theta < 90.0))
            refuse(*set.get("theta_" + side),
                   fmt::format("theta_{} {}; allowed: an angle from the normal, [0, 90) degrees",
                               side, *theta));
        if (mu && !(*mu > 0.0 && *mu <= 1.0))
            refuse(*set.get("mu_" + side),
                   fmt::format("mu_{0} {1}; allowed: a cosine from the normal, in (0, 1]; degrees "
                               "are theta_{0}",
                               side, *mu));
        return theta ? std::cos(*theta * std::numbers::pi / 180.0) : mu;
    }

    /// What a [[measured]] and a [[target]] say alike.
    fitting::MeasuredWords measured_words(const toml::table& set) const {
        fitting::MeasuredWords words;
        MeasuredOptions& options = words.options;
        options.quantity = text_of(set, "quantity");
        options.column = text_of(set, "column");
        options.azimuth_zero = text_of(set, "azimuth_zero");
        options.mu_in = cosine_of(set, "in");
        options.mu_out = cosine_of(set, "out");
        options.azimuth_deg = number_of_key(set, "azimuth");
        if (const toml::node* percent = set.get("percent")) {
            options.percent = percent->value_exact<bool>();
            if (!options.percent) refuse(*percent, "'percent' is true or false");
        }
        if (const std::string file = text_of(set, "file"); !file.empty())
            words.file = (std::filesystem::path(folder_) / file).string();
        return words;
    }

    void read_spheres(const toml::table& set, fitting::MeasuredWords& words, FitData& data) {
        if (set.get("sphere") != nullptr) data.spheres.emplace();
        if (const toml::node* lost = set.get("lost_light")) {
            if (!data.spheres || !lost->is_boolean())
                refuse(*lost, "'lost_light' is true or false, beside 'sphere'");
            data.spheres->lost_light = lost->value_or(false);
        }
        for (const char* key : {"sphere", "other_sphere"}) {
            const bool other = key != std::string_view("sphere");
            const toml::node* node = set.get(key);
            if (node == nullptr) continue;
            const std::string text = node->value_or(std::string());
            if (other && (!data.spheres || words.has_spheres_of_file))
                refuse(*node, "'other_sphere' stands beside sphere = { ... }");
            if (!other && (text == "file" || text == "iad")) {
                words.has_spheres_of_file = true;
                data.spheres->as_iad = text == "iad";
                continue;
            }
            if (!node->is_table())
                refuse(*node,
                       fmt::format("'{}' is {{ diameter = 200, sample_port = 25, wall = 0.97 "
                                   "}}, or of an .rxt file \"file\" or \"iad\"",
                                   key));
            for (const auto& [name, number] : in_order(*node->as_table())) {
                const auto flag = number->value_exact<bool>();
                const double value = flag ? double(*flag) : number_of(*number, name);
                at(*number, [&, &word = name] {
                    set_sphere_word(*data.spheres, std::string(word), value, other);
                });
            }
            if (other) data.spheres->spheres = 2;
        }
    }

    void read_measured(const toml::table& set) {
        check_keys(set, kMeasuredKeys, "key");
        fitting::MeasuredWords words = measured_words(set);
        MeasuredOptions& options = words.options;
        options.sigma = number_of_key(set, "sigma");
        options.relative_sigma = number_of_key(set, "relative_sigma");
        words.wavelength_nm = numbers_of_key(set, "wavelength_nm");
        words.values = numbers_of_key(set, "values");
        if (words.values.empty() && words.wavelength_nm.size() == 1)
            options.wavelength_nm = words.wavelength_nm[0];
        if (const std::string range = text_of(set, "wavelengths"); !range.empty())
            at(*set.get("wavelengths"), [&] { words.ranges = fitting::wavelength_ranges(range); });
        const std::string file = text_of(set, "file");
        if (file.empty() == words.values.empty())
            refuse(set,
                   "a [[measured]] has file = \"measured.csv\" or values = "
                   "[...], one of them");
        FitData data;
        data.name = text_of(set, "name");
        if (data.name.empty()) {
            data.name = file.empty() ? "values" : file;
            if (!options.column.empty()) data.name += " " + options.column;
        }
        const auto same = [&](const FitData& other) { return other.name == data.name; };
        if (std::any_of(problem_.data.begin(), problem_.data.end(), same))
            data.name += fmt::format(" #{}", problem_.data.size() + 1);
        if (const auto share = number_of_key(set, "diffuse_fraction"))
            data.diffuse_fraction = *share;
        if (const std::string text = text_of(set, "sky"); !text.empty()) {
            at(*set.get("sky"), [&] {
                data.sky = sky(found_in(folder_, text));
                if (data.sky.kind != Sky::Kind::uniform && !(data.diffuse_fraction > 0.0))
                    throw UsageError(
                        "'sky' is where the share diffuse_fraction of the light of hdrf comes "
                        "from; write diffuse_fraction = 0.2 beside it");
            });
        }
        if (const std::string light = text_of(set, "light"); !light.empty())
            at(*set.get("light"), [&] { data.viewing = viewing(light); });
        if (const toml::node* scale = set.get("scale")) {
            data.free_scale = scale->value_or(std::string()) == "free";
            if (!data.free_scale)
                refuse(
                    *scale,
                    "'scale' is \"free\" where values are known up to a factor; a factor that is "
                    "known goes into the values");
        }
        if (const toml::node* shift = set.get("wavelength_shift")) {
            data.free_wavelength_shift = shift->value_or(std::string()) == "free";
            if (!data.free_wavelength_shift)
                data.wavelength_shift_nm = number_of(*shift, "wavelength_shift");
        }
        data.band_width_nm = number_of_key(set, "band_width").value_or(0.0);
        data.correlation_length_nm = number_of_key(set, "correlation_length").value_or(0.0);
        data.scene = own_scene(set);
        read_spheres(set, words, data);
        at(set, [&] {
            fitting::read_values(words, data);
            fitting::check_data(data);
        });
        problem_.data.push_back(std::move(data));
    }

    std::string folder_;
    FitProblem problem_;
};

}  // namespace

MatchProblem read_match_text(const std::string& text, const std::string& folder,
                             const std::string& name) {
    return FitFile(text, folder, name, kMatchKind).read_match();
}

MatchProblem read_match_file(const std::string& path) {
    return read_match_text(read_toml_text(kMatchKind, path),
                           std::filesystem::path(path).parent_path().string(), path);
}

FitProblem read_fit_text(const std::string& text, const std::string& folder,
                         const std::string& name) {
    return FitFile(text, folder, name).read();
}

FitProblem read_fit_file(const std::string& path) {
    return read_fit_text(read_toml_text(kKind, path),
                         std::filesystem::path(path).parent_path().string(), path);
}

}  // namespace miebrdf
