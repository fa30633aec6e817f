// CxF3 (X-Rite, ISO 17972): XML with the spectra and colours of objects, and how they were
// measured. Schema: http://colorexchangeformat.com/CxF3-core.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <pugixml.hpp>

#include "materials/index/units.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/columns.h"
#include "pipeline/measured/reader.h"

namespace miebrdf::measured {
namespace {

/// The name of an element without the prefix of its namespace.
std::string_view bare(const pugi::xml_node& node) {
    const std::string_view name = node.name();
    const std::size_t colon = name.find(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

pugi::xml_node child(const pugi::xml_node& node, std::string_view name) {
    for (const pugi::xml_node inner : node.children()) {
        if (bare(inner) == name) return inner;
    }
    return {};
}

/// The first of this name at any depth.
pugi::xml_node below(const pugi::xml_node& node, std::string_view name) {
    return node.find_node([&](const pugi::xml_node& inner) { return bare(inner) == name; });
}

struct CxfSpecification {
    NamedGeometry geometry;
    std::string words, type;  ///< type: "Spectrum_Reflectance"
    double start_nm = MeasuredValue::kNone, increment_nm = MeasuredValue::kNone;
    double mu_out = MeasuredValue::kNone;
};

class CxfReader {
  public:
    CxfReader(const MeasuredFile& file, const MeasuredOptions& options)
        : file_(file), options_(options) {
        materials::ReadingBudget::require_values(
            std::size_t(std::count(file.content.begin(), file.content.end(), '<')), file.path);
        for (std::size_t i = 0; i < file.content.size(); ++i) {
            if (file.content[i] == '\n') line_ends_.push_back(i);
        }
        const auto parsed = document_.load_buffer(file.content.data(), file.content.size());
        if (!parsed) {
            refuse(file, line_at(parsed.offset),
                   fmt::format("damaged XML: {}", parsed.description()));
        }
    }

    Measurements read() {
        const pugi::xml_node resources = below(document_, "Resources");
        if (!resources) refuse(file_, 0, "no Resources: not a CxF3 file");
        for (const pugi::xml_node s : below(resources, "ColorSpecificationCollection").children())
            read_specification(s);
        for (const pugi::xml_node object : below(resources, "ObjectCollection").children()) {
            if (bare(object) == "Object") read_object(object);
        }
        if (list_.values.empty())
            refuse(file_, 0, "no reflectance, transmittance or CIELab of any object");
        for (const auto& [id, s] : specifications_) {
            if (!s.words.empty()) list_.facts.emplace_back("geometry of " + id, s.words);
        }
        return std::move(list_);
    }

  private:
    int line_at(std::ptrdiff_t offset) const {
        const auto end = std::min(static_cast<std::size_t>(offset), file_.content.size());
        const auto before = std::lower_bound(line_ends_.begin(), line_ends_.end(), end);
        return 1 + static_cast<int>(before - line_ends_.begin());
    }
    double number(const pugi::xml_node& node, std::string_view text) const {
        const auto value = measured_number(materials::without_blanks(text));
        if (!value) {
            refuse(file_, line_at(node.offset_debug()),
                   fmt::format("'{}' is not a number", text.substr(0, 40)));
        }
        return *value;
    }

    void read_specification(const pugi::xml_node& node) {
        CxfSpecification s;
        const pugi::xml_node geometry = below(node, "GeometryChoice");
        if (const pugi::xml_node sphere = child(geometry, "SphereGeometry")) {
            s.words = sphere.child_value();
            s.geometry = geometry_in("sphere " + s.words);
        } else if (const pugi::xml_node single = child(geometry, "SingleAngle")) {
            const pugi::xml_node in = child(single, "IlluminationAngle");
            const pugi::xml_node out = child(single, "MeasurementAngle");
            const double theta_in = number(in, in.child_value());
            const double theta_out = number(out, out.child_value());
            s.words = fmt::format("{:g}/{:g}", theta_in, theta_out);
            const bool usual =
                (theta_in == 45.0 && theta_out == 0.0) || (theta_in == 0.0 && theta_out == 45.0);
            s.geometry.geometry = usual ? MeasuredGeometry::d45_0 : MeasuredGeometry::directions;
            s.geometry.mu_in = cosine_of(theta_in);
            s.mu_out = cosine_of(theta_out);
        } else if (geometry.first_child()) {
            s.words = std::string(bare(geometry.first_child())) + ", not understood";
        }
        const pugi::xml_node range = below(node, "WavelengthRange");
        if (range) {
            s.start_nm = number(range, range.attribute("StartWL").value());
            s.increment_nm = number(range, range.attribute("Increment").value());
        }
        s.type = below(node, "MeasurementType").child_value();
        const std::string id = node.attribute("Id").value();
        const pugi::xml_node light = below(node, "TristimulusSpec");
        if (light) {
            list_.facts.emplace_back("light of " + id,
                                     fmt::format("{}, {}", child(light, "Illuminant").child_value(),
                                                 child(light, "Observer").child_value()));
        }
        specifications_[id] = s;
    }

    void read_object(const pugi::xml_node& object) {
        const std::string name = object.attribute("Name").value();
        std::size_t same = 0;
        const pugi::xml_node colors = child(object, "ColorValues");
        for (const pugi::xml_node color : colors.children()) {
            const std::string id = color.attribute("ColorSpecification").value();
            const CxfSpecification& s = specifications_[id];
            const std::string_view kind = bare(color);
            const std::string sample =
                name + (same == 0 ? "" : fmt::format(" {}", id.empty() ? "again" : id));
            if (!kind.ends_with("Spectrum")) continue;
            if (const auto meaning = meaning_of(color, kind, s)) {
                add(color, sample, s, *meaning);
                ++same;
            }
        }
        for (const pugi::xml_node color : colors.children()) {
            if (bare(color) != "ColorCIELab") continue;
            if (same++ == 0) list_.samples.push_back(name);
            add_lab(color, specifications_[color.attribute("ColorSpecification").value()]);
        }
    }

    /// Custom spectra say what they are in attributes or in their specification. Nothing: not read,
    /// which is said.
    std::optional<ValueMeaning> meaning_of(const pugi::xml_node& node, std::string_view kind,
                                           const CxfSpecification& s) {
        std::string words(kind.substr(0, kind.size() - std::string_view("Spectrum").size()));
        if (words == "Custom") {
            words = s.type;
            for (const pugi::xml_attribute& attribute : node.attributes()) {
                if (auto meaning = value_meaning(attribute.value())) return meaning;
            }
        }
        std::replace(words.begin(), words.end(), '_', ' ');
        auto meaning = value_meaning(words);
        if (meaning && (meaning->refused.empty() || !options_.quantity.empty())) return meaning;
        list_.doubts.push_back(
            fmt::format("{}:{}: {} '{}' is not read: {}", file_.path, line_at(node.offset_debug()),
                        std::string(kind), words,
                        meaning ? meaning->refused : "neither reflectance nor transmittance"));
        return std::nullopt;
    }

    void add(const pugi::xml_node& node, const std::string& sample, const CxfSpecification& s,
             const ValueMeaning& meaning) {
        const bool transmitted = meaning.kind.quantity == MeasuredQuantity::transmittance;
        const pugi::xml_attribute start = node.attribute("StartWL");
        const pugi::xml_attribute step = node.attribute("Increment");
        const double first = start ? number(node, start.value()) : s.start_nm;
        double increment = step ? number(node, step.value()) : s.increment_nm;
        const int line = line_at(node.offset_debug());
        std::vector<double> values, nm;
        for (const std::string_view word : materials::split_words(node.child_value(), " \t\r\n"))
            values.push_back(number(node, word));
        if (std::isnan(increment)) {
            // The schema puts it into the specification; files without one have 10 nm.
            increment = 10.0;
            if (!assumed_) {
                list_.doubts.push_back(
                    fmt::format("{}:{}: no increment of wavelength; taken as 10 "
                                "nm",
                                file_.path, line));
            }
            assumed_ = true;
        }
        if (values.empty() || !(first > 0.0) || !(increment > 0.0)) {
            refuse(file_, line,
                   fmt::format("a spectrum of {} values from {} nm in steps of {} nm",
                               values.size(), first, increment));
        }
        for (std::size_t i = 0; i < values.size(); ++i) nm.push_back(first + increment * double(i));
        for (double& value : values) value = converted(value, meaning.conversion);
        MeasuredKind kind{MeasuredQuantity::reflectance, s.geometry.geometry};
        if (kind.geometry == MeasuredGeometry::d45_0 ||
            kind.geometry == MeasuredGeometry::directions)
            kind.quantity = MeasuredQuantity::reflectance_factor;
        if (transmitted) kind = {MeasuredQuantity::transmittance, MeasuredGeometry::unknown};
        const std::size_t before = list_.values.size();
        add_spectrum(list_, sample, kind, s.geometry.mu_in, nm, values,
                     std::vector<int>(nm.size(), line));
        for (std::size_t i = before; i < list_.values.size() && !transmitted; ++i)
            list_.values[i].mu_out = s.mu_out;
    }

    void add_lab(const pugi::xml_node& node, const CxfSpecification& s) {
        const auto part = [&](const char* letter) {
            const pugi::xml_node inner = child(node, letter);
            return number(node, inner.child_value());
        };
        measured::add_lab(list_, s.geometry.geometry, {part("L"), part("A"), part("B")},
                          line_at(node.offset_debug()));
    }

    const MeasuredFile& file_;
    const MeasuredOptions& options_;
    std::vector<std::size_t> line_ends_;
    pugi::xml_document document_;
    std::map<std::string, CxfSpecification> specifications_;
    bool assumed_ = false;
    Measurements list_;
};

bool looks_like_cxf(const MeasuredFile& file) {
    const std::string_view start = file.content.substr(0, 4000);
    return start.find("colorexchangeformat.com/CxF3") != std::string_view::npos ||
           start.find("<CxF") != std::string_view::npos ||
           start.find(":CxF") != std::string_view::npos;
}

Measurements read_cxf(const MeasuredFile& file, const MeasuredOptions& options) {
    return CxfReader(file, options).read();
}

}  // namespace

extern const Reader kCxf;
constinit const Reader kCxf{{"cxf", "CxF3 (.cxf)"}, looks_like_cxf, read_cxf};

}  // namespace miebrdf::measured
