// Optical constants of OpenMATERIAL, JSON: in ASAM's OpenMATERIAL 3D (.xompt) rows of wavelength in
// m, temperature in K, n, k; in its predecessor (.gltf) of each temperature the pairs of n and k.
// https://github.com/asam-ev/OpenMATERIAL-3D, schemas/material_optical_schema.json
#include <fmt/format.h>

#include <set>

#include "materials/readers/file_format.h"
#include "materials/readers/text_table.h"
#include "materials/readers/yaml_node.h"

namespace miebrdf::materials {
namespace {

bool looks_like_openmaterial(std::string_view text) {
    return text.find("\"opticalProperties\"") != std::string_view::npos ||
           text.find("\"OpenMaterial_ior_data\"") != std::string_view::npos;
}

class OpenMaterialReader {
  public:
    explicit OpenMaterialReader(const SourceFile& source) : file_(source.path.string()) {}

    Dataset read(std::string_view text, const ReadOptions& options) {
        const YamlNode root = parse_yaml(text, file_);  // JSON is YAML
        Dataset dataset;
        dataset.format = "openmaterial";
        if (const YamlNode* rows = root.find("opticalProperties"))
            read_rows(*rows);
        else
            read_pairs(root);
        if (temperatures_.size() > 1) {
            throw ImportError(
                file_, 0,
                fmt::format("{} temperatures, from {:g} to {:g} K; a file may have "
                            "one: write a file of each",
                            temperatures_.size(), *temperatures_.begin(), *temperatures_.rbegin()));
        }
        if (table_.rows.empty()) throw ImportError(file_, 0, "no optical constants");
        dataset.temperature_k = *temperatures_.begin();
        add_table(dataset, std::move(table_), file_, options);
        return dataset;
    }

  private:
    double number(const YamlNode& node) const {
        const auto value = table_number(node.text);
        if (!value) throw ImportError(file_, node.line, fmt::format("'{}'", node.text));
        return *value;
    }
    void require_count(const YamlNode& row, std::size_t count) const {
        if (row.items.size() == count) return;
        throw ImportError(file_, row.line,
                          fmt::format("{} numbers; expected {}", row.items.size(), count));
    }
    double nm(const YamlNode& node) const { return 1e9 * number(node); }

    void read_rows(const YamlNode& rows) {
        for (const YamlNode& row : rows.items) {
            require_count(row, 4);
            temperatures_.insert(number(row.items[1]));
            table_.rows.push_back(
                {nm(row.items[0]), number(row.items[2]), number(row.items[3]), row.line});
        }
    }

    void read_pairs(const YamlNode& root) {
        const YamlNode* extensions = root.find("extensions");
        const YamlNode* data = extensions ? extensions->find("OpenMaterial_ior_data") : nullptr;
        for (std::size_t t = 0; data != nullptr && t < data->items.size(); ++t) {
            const auto kelvin = table_number(data->keys[t]);
            const YamlNode *n = data->items[t].find("n"), *k = data->items[t].find("k");
            if (!kelvin || !n || !k || n->items.size() != k->items.size()) {
                throw ImportError(
                    file_, data->items[t].line,
                    fmt::format("'{}' has no tables of n and k of one length", data->keys[t]));
            }
            temperatures_.insert(*kelvin);
            for (std::size_t i = 0; i < n->items.size(); ++i) {
                const YamlNode &at_n = n->items[i], &at_k = k->items[i];
                require_count(at_n, 2);
                require_count(at_k, 2);
                if (number(at_n.items[0]) != number(at_k.items[0]))
                    throw ImportError(file_, at_k.line, "n and k have other wavelengths");
                table_.rows.push_back(
                    {nm(at_n.items[0]), number(at_n.items[1]), number(at_k.items[1]), at_n.line});
            }
        }
    }

    std::string file_;
    RawTable table_;
    std::set<double> temperatures_;
};

Dataset read_openmaterial(const SourceFile& source, const ReadOptions& options) {
    return OpenMaterialReader(source).read(source.text, options);
}

}  // namespace

extern const FileFormat kOpenMaterial;
constinit const FileFormat kOpenMaterial{
    .name = "openmaterial",
    .title = "OpenMATERIAL",
    .looks_like = looks_like_openmaterial,
    .read = read_openmaterial,
};

}  // namespace miebrdf::materials
