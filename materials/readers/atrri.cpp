// AsToRia refractive index, atrri(5) of the htrdr renderers: wavelength in nm, n, k; '#' begins a
// comment.
#include "materials/readers/file_format.h"

namespace miebrdf::materials {
namespace {

// Never recognised by content, since three bare columns could be anything: it must be named.
bool never(std::string_view) { return false; }

Dataset read_atrri(const SourceFile& source, const ReadOptions& options) {
    Dataset dataset;
    dataset.format = "atrri";
    read_bare_columns(dataset, source.text, {}, source.path.string(), options);
    return dataset;
}

std::vector<ExportFile> write_atrri(const Dataset& d, const ExportOptions& options) {
    return {{".atrri",
             remarks(d, "# ") + bare_columns(joint_table(d, "atrri", options), Unit::nanometre)}};
}

}  // namespace

extern const FileFormat kAtrri;
constinit const FileFormat kAtrri{
    .name = "atrri",
    .title = "atrri",
    .endings = {".atrri"},
    .looks_like = never,
    .read = read_atrri,
    .write = write_atrri,
};

}  // namespace miebrdf::materials
