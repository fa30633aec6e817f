// IMD / Luxpop .nk: ';' comments, then wavelength in Angstrom, n, k.
#include <fmt/format.h>

#include "materials/readers/file_format.h"
#include "materials/readers/text.h"

namespace miebrdf::materials {
namespace {

constexpr const char* kColumnsRemark = "wavelength (A), n, k";

char first_character(std::string_view text) {
    const std::string_view start = without_blanks(text);
    return start.empty() ? '\0' : start.front();
}

bool looks_like_imd(std::string_view text) {
    return first_character(text) == ';' && first_row_has(text, ';', 3);
}

Dataset read_imd(const SourceFile& source, const ReadOptions& options) {
    Dataset dataset;
    dataset.format = "imd";
    read_bare_columns(dataset, source.text,
                      {.comment = ';', .unit = Unit::angstrom, .usual_remark = kColumnsRemark},
                      source.path.string(), options);
    return dataset;
}

std::vector<ExportFile> write_imd(const Dataset& d, const ExportOptions& options) {
    return {{".nk", remarks(d, "; ") + fmt::format("; {}\n", kColumnsRemark) +
                        bare_columns(joint_table(d, "imd", options), Unit::angstrom)}};
}

}  // namespace

extern const FileFormat kImd;
constinit const FileFormat kImd{
    .name = "imd",
    .title = "IMD/Luxpop",
    .endings = {".nk"},
    .looks_like = looks_like_imd,
    .read = read_imd,
    .write = write_imd,
};

}  // namespace miebrdf::materials
