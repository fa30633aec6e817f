// Radiance's BSDF XML, front reflection: which of its two kinds a file is.
#include <fmt/format.h>

#include <pugixml.hpp>

#include <miebrdf/error.h>
#include "pipeline/formats/readers/radiance_file.h"

namespace miebrdf::exports {

bool looks_like_radiance(std::string_view content) {
    return content.substr(0, 1 << 16).find("<WindowElement") != content.npos;
}

std::unique_ptr<BrdfFile> read_radiance(std::string content) {
    pugi::xml_document document;
    const std::size_t size = content.size();  // parsing in place writes into the content
    const auto result = document.load_buffer_inplace(content.data(), size);
    if (!result)
        throw InputError(
            fmt::format("radiance: {} at byte {}", result.description(), result.offset));
    const pugi::xml_node layer = document.child("WindowElement").child("Optical").child("Layer");
    const std::string_view structure =
        layer.child("DataDefinition").child_value("IncidentDataStructure");
    if (structure == "Columns") return read_klems(layer);
    if (structure == "TensorTree3") return read_tensor_tree(layer, size);
    throw InputError(fmt::format(
        "radiance: incident data structure '{}'; known: Columns, TensorTree3", structure));
}

}  // namespace miebrdf::exports
