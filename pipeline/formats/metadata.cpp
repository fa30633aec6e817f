#include "pipeline/formats/metadata.h"

#include <nlohmann/json.hpp>

#include "pipeline/io/atomic_file.h"

namespace miebrdf::exports {

nlohmann::ordered_json metadata(const BrdfSource& source, const Conventions& conventions) {
    const Provenance& origin = source.provenance();
    nlohmann::ordered_json json;
    json["generator"] = origin.version;
    json["command"] = origin.command_line;
    json["title"] = origin.title;
    json["component"] = origin.component;
    json["format"] = conventions.format;
    json["quantity"] = "BRDF";
    json["units"] = "1/sr";
    json["cosine"] =
        conventions.cosine_included ? "stored values are BRDF times cosine" : "not included";
    json["azimuth_zero"] = conventions.azimuth_zero;
    json["isotropic"] = true;
    if (source.wavelength_nm().empty()) {
        json["channels"] = source.channels();
    } else {
        json["wavelength_nm"] = source.wavelength_nm();
    }
    if (!conventions.colour.empty()) json["colour"] = conventions.colour;
    if (!origin.accuracy.empty()) json["accuracy"] = origin.accuracy;
    json["sources"] = origin.sources;
    return json;
}

std::filesystem::path sidecar_path(const std::filesystem::path& file) {
    return file.string() + ".json";
}

void write_sidecar(const std::filesystem::path& file, const nlohmann::ordered_json& metadata) {
    AtomicFile sidecar(sidecar_path(file));
    sidecar.stream() << metadata.dump(1) << '\n';
    sidecar.commit();
}

}  // namespace miebrdf::exports
