#include "pipeline/sweep/sweep_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <string_view>

#include "pipeline/scene/toml_file.h"
#include "pipeline/sweep/axis_values.h"
#include "pipeline/sweep/samples.h"
#include "pipeline/sweep/sweep_checks.h"

namespace miebrdf::sweep {
namespace {

constexpr char kKind[] = "sweep file";
const std::vector<std::string> kKeys = {
    "title", "scene",  "axes",        "outputs",          "units", "combine", "viewing",
    "chunk", "layout", "derivatives", "diffuse_fraction", "sky"};

/// In the order of TableLayout.
constexpr std::string_view kLayouts[] = {"cf", "eradiate", "isofit", "isofit-surface", "crtm-snow"};

class SweepFile : TomlFile {
  public:
    explicit SweepFile(const std::string& path) : SweepFile(path, read_toml_text(kKind, path)) {}

    Sweep read() {
        check_keys(root(), kKeys, "key");
        sweep_.title = text_of(root(), "title");
        read_layout();
        read_axes();
        read_units();
        read_words();
        read_outputs();
        read_derivatives();
        if (const std::string eye = text_of(root(), "viewing"); !eye.empty())
            at(*root().get("viewing"), [&] { sweep_.viewing = viewing(eye); });
        if (const toml::node* share = root().get("diffuse_fraction")) {
            const auto number = share->value<double>();
            if (!number || !(*number >= 0.0 && *number <= 1.0) || !sweep_.wants(Output::hdrf))
                refuse(*share,
                       "'diffuse_fraction' is the share of the sky in the light of the "
                       "output hdrf, 0 to 1");
            sweep_.diffuse_fraction = *number;
        } else if (sweep_.wants(Output::hdrf)) {
            at(root(), [] {
                throw UsageError(
                    "the output hdrf needs diffuse_fraction = 0.2, the share of the "
                    "sky in the light");
            });
        }
        if (const std::string text = text_of(root(), "sky"); !text.empty()) {
            if (!(sweep_.diffuse_fraction > 0.0))
                refuse(*root().get("sky"),
                       "'sky' is where the share diffuse_fraction of the light of hdrf comes from");
            at(*root().get("sky"), [&] { sweep_.sky = sky(found_in(sweep_.folder, text)); });
        }
        if (const toml::node* chunk = root().get("chunk")) {
            const auto count = chunk->value_exact<std::int64_t>();
            if (!count || *count < 1 || *count > 1'000'000)
                refuse(*chunk, "'chunk' is a number of scenes, 1 to 1000000");
            sweep_.scenes_per_chunk = std::size_t(*count);
        }
        at(root(), [&] { check_sweep(sweep_); });
        return std::move(sweep_);
    }

  private:
    SweepFile(const std::string& path, const std::string& text) : TomlFile(kKind, path, text) {
        sweep_.text = text;
        sweep_.folder = std::filesystem::path(path).parent_path().string();
    }

    void read_layout() {
        const std::string layout = text_of(root(), "layout");
        if (layout.empty()) return;
        const auto found = std::find(std::begin(kLayouts), std::end(kLayouts), layout);
        if (found == std::end(kLayouts))
            refuse(*root().get("layout"), fmt::format("unknown layout '{}'; allowed: {}", layout,
                                                      fmt::join(kLayouts, ", ")));
        sweep_.table_layout = TableLayout(found - std::begin(kLayouts));
    }

    void read_axes() {
        for (const auto& [name, node] : in_order(table_of("axes", "one line for each axis"))) {
            at(*node, [&, &axis_name = name, &value = *node] {
                if (const toml::table* columns = value.as_table()) {
                    sweep_.dimensions.push_back({axis_name, columns_of(axis_name, *columns)});
                } else {
                    place_axis(sweep_, axis_of_node(axis_name, value));
                }
            });
        }
        const std::string combine = text_of(root(), "combine");
        if (combine == "zip") {
            at(*root().get("combine"), [&] { zip_dimensions(sweep_); });
        } else if (!combine.empty() && combine != "product") {
            refuse(*root().get("combine"),
                   fmt::format("unknown way to combine axes '{}'; allowed: product, zip", combine));
        }
    }

    Axis axis_of_node(const std::string& name, const toml::node& node) const {
        if (const auto text = node.value_exact<std::string>()) return parse_axis(name, *text);
        if (const auto number = node.value<double>()) return axis_of(name, {*number});
        const toml::array* list = node.as_array();
        if (list == nullptr || list->empty())
            throw InputError(
                fmt::format("axis {}: write a number, a range \"50:1000:10 log\" or a "
                            "list with at least one value",
                            name));
        std::vector<double> numbers;
        std::vector<std::string> texts;
        for (const toml::node& item : *list) {
            if (const auto text = item.value_exact<std::string>()) {
                texts.push_back(*text);
            } else if (const auto number = item.value<double>(); number && !item.is_boolean()) {
                numbers.push_back(*number);
            } else {
                throw InputError(fmt::format("axis {}: a list of numbers or of texts", name));
            }
        }
        if (!numbers.empty() && !texts.empty())
            throw InputError(fmt::format("axis {}: numbers and texts in one list", name));
        if (texts.empty()) return axis_of(name, numbers);
        if (name == "wavelength_nm")
            return parse_axis(name, fmt::format("{}", fmt::join(texts, ",")));
        return {.name = name, .words = texts, .unit = ""};
    }

    /// A number of samples or a seed.
    std::int64_t whole_number(const toml::node& node, const std::string& key) const {
        const auto number = node.value_exact<std::int64_t>();
        if (!number || *number < 0 || *number > 0xffffffff)
            refuse(node, fmt::format("'{}' is a whole number", key));
        return *number;
    }

    /// Columns of one dimension: of a file, or samples.
    std::vector<Axis> columns_of(const std::string& name, const toml::table& table) const {
        const toml::node *sobol = table.get("sobol"), *latin = table.get("latin-hypercube");
        if (sobol == nullptr && latin == nullptr) return columns_of_file(name, table);
        if (sobol != nullptr && latin != nullptr)
            refuse(*latin, "sobol and latin-hypercube: give one of them");
        std::vector<SampleRange> ranges;
        for (const auto& [column, node] : in_order(table)) {
            if (column == "sobol" || column == "latin-hypercube") continue;
            if (column == "seed" && latin != nullptr) continue;
            const auto text = node->value_exact<std::string>();
            if (!text) refuse(*node, fmt::format("'{}' is a range, \"50:1000 log\"", column));
            at(*node, [&, &column_name = column] {
                ranges.push_back(parse_sample_range(column_name, *text));
            });
        }
        if (sobol != nullptr)
            return sobol_samples(std::size_t(whole_number(*sobol, "sobol")), ranges);
        const toml::node* seed = table.get("seed");
        return latin_hypercube_samples(
            std::size_t(whole_number(*latin, "latin-hypercube")), ranges,
            seed == nullptr ? 0 : std::uint32_t(whole_number(*seed, "seed")));
    }

    /// Columns of a file, which is looked for beside the sweep file.
    std::vector<Axis> columns_of_file(const std::string& name, const toml::table& table) const {
        check_keys(table, {"file", "columns"}, "key");
        const toml::node* file = table.get("file");
        if (file == nullptr || !file->is_string())
            throw InputError(
                fmt::format("axis {}: a table needs file = \"samples.csv\", sobol = 256 or "
                            "latin-hypercube = 100",
                            name));
        std::vector<std::string> columns;
        if (const toml::node* list = table.get("columns")) {
            if (!list->is_array()) refuse(*list, "'columns' is a list of names");
            for (const toml::node& item : *list->as_array())
                columns.push_back(item.value_or(std::string()));
        }
        const auto samples = std::filesystem::path(path()).parent_path() / file->as_string()->get();
        return read_columns(samples.string(), columns);
    }

    void read_units() {
        const toml::node* node = root().get("units");
        if (node == nullptr) return;
        const toml::table& units = table_of("units", "name = \"unit\"");
        for (const auto& [key, value] : units) {
            const std::string name(key.str());
            Axis* axis = find_axis(sweep_, name);
            if (axis == nullptr)
                refuse_word(key.source(), fmt::format("there is no axis '{}'", name), name,
                            axis_names(sweep_));
            if (!value.is_string()) refuse(value, "a unit is a text, \"um\"");
            axis->unit = value.as_string()->get();
        }
    }

    WordValue word_value(const toml::node& node) const {
        if (const auto flag = node.value_exact<bool>()) return *flag;
        if (const auto text = node.value_exact<std::string>()) {
            at(node, [&] {
                for (const std::string& gap : gaps_in(*text)) use_axis(node, gap);
            });
            return *text;
        }
        const auto number = node.value<double>();
        if (!number) refuse(node, "a number, a text or a list of them");
        return *number;
    }

    void use_axis(const toml::node& node, const std::string& name) const {
        const std::vector<std::string> known = scene_axis_names(sweep_);
        if (std::find(known.begin(), known.end(), name) != known.end()) return;
        refuse_word(node.source(), fmt::format("there is no axis '{}' for {{{}}}", name, name),
                    name, known);
    }

    void read_words() {
        for (const auto& [name, node] :
             in_order(table_of("scene", "whose keys are the words of a scene file"))) {
            if (name == "wavelengths") {
                throw UsageError(located(node->source(),
                                         "wavelengths are an axis: write wavelength_nm = "
                                         "\"400:700:10\" in [axes]"));
            }
            if (find_scene_word(name) == nullptr)
                refuse_word(node->source(), fmt::format("unknown word '{}'", name), name,
                            scene_word_names("wavelengths"));
            TemplateWord word{name, {}, located(node->source(), "")};
            if (const toml::array* list = node->as_array()) {
                for (const toml::node& item : *list) word.values.push_back(word_value(item));
            } else {
                word.values.push_back(word_value(*node));
            }
            const auto* off =
                word.values.size() == 1 ? std::get_if<bool>(&word.values[0]) : nullptr;
            if (off == nullptr || *off) sweep_.words.push_back(std::move(word));
        }
    }

    void read_outputs() {
        const toml::node* node = root().get("outputs");
        const toml::array* list = node == nullptr ? nullptr : node->as_array();
        if (list == nullptr || list->empty()) {
            throw InputError(fmt::format(
                "sweep file '{}' asks for nothing; write outputs = [\"plane_albedo\"] above its "
                "tables; allowed: {}",
                path(), fmt::join(output_names(), ", ")));
        }
        for (const toml::node& item : *list) {
            const std::string name = item.value_or(std::string());
            if (!add_output(sweep_, name)) {
                refuse_word(item.source(), fmt::format("unknown output '{}'", name), name,
                            output_names());
            }
        }
    }

    void read_derivatives() {
        const toml::node* node = root().get("derivatives");
        if (node == nullptr) return;
        const toml::array* list = node->as_array();
        if (list == nullptr)
            refuse(*node, "'derivatives' is a list of names of numbers, [\"radius_um\"]");
        for (const toml::node& item : *list) {
            const std::string name = item.value_or(std::string());
            const Axis* axis = find_axis(sweep_, name);
            if (name.empty() || (axis != nullptr && axis->is_text()))
                refuse(item,
                       "allowed derivatives: by axes of numbers, by names as in {w=0.9}, by "
                       "n(NAME) and k(NAME)");
            sweep_.derivatives.push_back(name);
        }
    }

    Sweep sweep_;
};

}  // namespace

Sweep read_sweep_file(const std::string& path) {
    Sweep sweep = SweepFile(path).read();
    check_names(sweep);
    order_for_sharing(sweep);
    return sweep;
}

}  // namespace miebrdf::sweep
