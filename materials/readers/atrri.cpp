// AsToRia refractive index, atrri(5) of the htrdr renderers: wavelength in nm, n, k; '#' begins a
// comment.
#include <fmt/format.h>

#include <iterator>
#include <utility>

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
    const JointTable table = joint_table(d, "atrri", options);
    std::string text = remarks(d, "# ");
    for (std::size_t i = 0; i < table.n.x.size(); ++i) {
        fmt::format_to(std::back_inserter(text), "{} {} {}\n", in_unit(table.n, i, Unit::nanometre),
                       table.n.y[i], table.k[i]);
    }
    return {{".atrri", std::move(text)}};
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
