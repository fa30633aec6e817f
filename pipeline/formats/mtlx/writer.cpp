// mtlx: a MaterialX document with the OpenPBR surface nearest to the BRDF. docs/formats/mtlx.md
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>

#include "pipeline/formats/common/export_job.h"
#include "pipeline/formats/mtlx/openpbr.h"

namespace miebrdf {
namespace {

/// Six digits: more than any renderer shows.
std::string mtlx_text(const OpenPbr& surface, const OpenPbrParameter& one) {
    if (one.number != nullptr) return fmt::format("{:.6g}", surface.*one.number);
    const Colour3& c = surface.*one.colour;
    return fmt::format("{:.6g}, {:.6g}, {:.6g}", c[0], c[1], c[2]);
}

void write_mtlx(const ExportJob& job, std::ostream& out) {
    const OpenPbrFit fit = fit_openpbr(job.spectral, job.options, job.control);
    auto description = metadata(
        job.rgb,
        {.format = "mtlx", .cosine_included = false, .azimuth_zero = "", .colour = fit.colour});
    description["quantity"] = "OpenPBR surface fitted to a BRDF";
    description["wavelength_nm"] = job.spectral.wavelength_nm();
    description["model"] = "OpenPBR 1.1, MaterialX 1.39; subsurface_radius in mm";
    description["weights"] = fit.weights;
    for (const RegionDeviation& region : fit.deviation.regions) {
        description["residual"][region.name] = {{"rms", std::round(1e4 * region.rms) / 1e4},
                                                {"worst", std::round(1e4 * region.worst) / 1e4},
                                                {"mu_in", region.where.mu_in},
                                                {"mu_out", region.where.mu_out},
                                                {"azimuth", region.where.azimuth_deg}};
    }
    description.erase("left_out");
    const std::string left_out = left_out_of(find_format("mtlx"), job.spectral.provenance());
    if (!left_out.empty()) description["left_out"] = left_out;
    if (job.spectral.provenance().mirror_index > 0.0)
        description["mirror"] = "specular_roughness 0: the smooth boundary of specular_ior";
    out << "<?xml version=\"1.0\"?>\n<!--\n"
        << in_xml_comment(description.dump(1)) << "\n-->\n<materialx version=\"1.39\" colorspace=\""
        << fit.colour_space
        << "\">\n  <open_pbr_surface name=\"miebrdf_surface\" type=\"surfaceshader\">\n";
    for (const OpenPbrParameter& one : openpbr_parameters()) {
        out << fmt::format("    <input name=\"{}\" type=\"{}\" value=\"{}\" />\n", one.name,
                           one.number != nullptr ? "float" : "color3", mtlx_text(fit.surface, one));
    }
    out << "  </open_pbr_surface>\n  <surfacematerial name=\"miebrdf\" type=\"material\">\n"
           "    <input name=\"surfaceshader\" type=\"surfaceshader\" "
           "nodename=\"miebrdf_surface\" />\n  </surfacematerial>\n</materialx>\n";
}

// ---- Reading

/// Lobes that are not evaluated here: their weight must be 0 (geometry_opacity 1).
constexpr const char* kOtherLobes[] = {"base_metalness", "transmission_weight", "fuzz_weight",
                                       "thin_film_weight", "emission_luminance"};

double mtlx_number(std::string_view name, const char*& text) {
    char* after = nullptr;
    const double value = std::strtod(text, &after);
    if (after == text) throw InputError(fmt::format("mtlx: {} has no number", name));
    text = after;
    while (*text == ' ' || *text == ',') ++text;
    return value;
}

std::unique_ptr<BrdfFile> read_mtlx(std::string content) {
    pugi::xml_document document;
    const auto parsed = document.load_buffer_inplace(content.data(), content.size());
    const pugi::xml_node root = document.child("materialx");
    const pugi::xml_node node = root.child("open_pbr_surface");
    if (!parsed || !node) throw InputError("mtlx: no open_pbr_surface in a materialx document");
    const std::string space = root.attribute("colorspace").as_string("acescg");
    if (space != "acescg" && space != "lin_rec709")
        throw InputError(fmt::format("mtlx: colorspace '{}'; known: acescg, lin_rec709", space));
    OpenPbr surface;
    for (const pugi::xml_node input : node.children("input")) {
        const std::string_view name = input.attribute("name").as_string();
        if (!input.attribute("value"))
            throw InputError(fmt::format("mtlx: {} is no value, but connected", name));
        const char* text = input.attribute("value").as_string();
        for (const char* other : kOtherLobes) {
            if (name == other && mtlx_number(name, text) != 0.0)
                throw InputError(fmt::format("mtlx: {} is not 0: not evaluated here", name));
        }
        for (const OpenPbrParameter& one : openpbr_parameters()) {
            if (name != one.name) continue;
            if (one.number != nullptr) surface.*one.number = mtlx_number(name, text);
            for (std::size_t c = 0; one.colour != nullptr && c < 3; ++c)
                (surface.*one.colour)[c] = mtlx_number(name, text);
        }
    }
    try {
        return openpbr_file(surface, space);
    } catch (const UsageError& error) {
        throw InputError(fmt::format("mtlx: {}", error.what()));
    }
}

Recognised recognise_mtlx(std::string_view content) {
    return content.find("<open_pbr_surface") != content.npos ? Recognised::by_structure
                                                             : Recognised::no;
}

}  // namespace

Format mtlx_format() {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    return {.name = "mtlx",
            .readers = "MaterialX: Arnold, Houdini, Maya, Blender, USD renderers",
            .holds = "an OpenPBR surface fitted to the BRDF",
            .endings = {".mtlx"},
            .content = FormatContent::sampled,
            .resolution = {"surface", 1, 1, 1, 1},
            .takes_colours = true,
            .extra = {{.name = "acescg",
                       .help = "colours in ACEScg, in place of linear sRGB",
                       .is_switch = true},
                      {.name = "subsurface",
                       .help = "subsurface scattering in place of the diffuse base",
                       .is_switch = true}},
            .holds_mirror = true,
            // A model of few parameters is not refused unless an error is asked for.
            .accepted = {kAny, kAny, kAny},
            .files = {{.colours = true, .write = write_mtlx}},
            .reader = {recognise_mtlx, read_mtlx}};
}

}  // namespace miebrdf
