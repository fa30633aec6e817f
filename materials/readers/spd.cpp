// Mitsuba / pbrt .spd: lines of nm and value; n and k are a pair of files.
#include <fmt/format.h>

#include <iterator>
#include <string>
#include <utility>

#include "materials/readers/file_format.h"
#include "materials/readers/text.h"

namespace miebrdf::materials {
namespace {

bool looks_like_spd(std::string_view text) { return first_row_has(text, '#', 2); }

/// Two files of one material that have no wavelength in common are not in the same unit.
void require_overlap(const Dataset& d, const std::string& file) {
    if (!d.n || !d.k) return;
    if (d.n->shortest_nm <= d.k->longest_nm && d.k->shortest_nm <= d.n->longest_nm) return;
    throw ImportError(
        file, 0,
        fmt::format("n ({:g} to {:g} nm) and k ({:g} to {:g} nm) have no wavelength in common; "
                    "allowed: two files in nm; convert the one that is in another unit",
                    d.n->shortest_nm, d.n->longest_nm, d.k->shortest_nm, d.k->longest_nm));
}

Dataset read_spd(const SourceFile& source, const ReadOptions& options) {
    const std::string file = pair_base(source.path).string();
    Dataset dataset;
    dataset.format = "spd";
    const auto read = [&](std::string_view text, bool is_n) {
        if (text.empty()) return;
        read_bare_columns(
            dataset, text,
            {.has_n = is_n, .has_k = !is_n, .takes_remarks = is_n || source.text.empty()},
            file + (is_n ? ".eta.spd" : ".k.spd"), options);
    };
    read(source.text, true);
    read(source.second_text, false);
    if (!dataset.n && !dataset.k) throw ImportError(file, 0, "no data");
    require_overlap(dataset, file);
    return dataset;
}

std::vector<ExportFile> write_spd(const Dataset& d, const ExportOptions&) {
    std::vector<ExportFile> files;
    const auto add = [&](const std::optional<Series>& series, const char* suffix) {
        if (!series) return;
        if (!series->tabulated())
            refuse_export(d, "spd", "n is a formula; only yaml keeps formulas");
        std::string text = remarks(d, "# ");
        for (std::size_t i = 0; i < series->x.size(); ++i) {
            fmt::format_to(std::back_inserter(text), "{} {}\n",
                           in_unit(*series, i, Unit::nanometre), series->y[i]);
        }
        files.push_back({suffix, std::move(text)});
    };
    add(d.n, ".eta.spd");
    add(d.k, ".k.spd");
    return files;
}

}  // namespace

extern const FileFormat kSpd;
constinit const FileFormat kSpd{
    .name = "spd",
    .title = "spd",
    .endings = {".eta.spd", ".k.spd"},
    .looks_like = looks_like_spd,
    .read = read_spd,
    .write = write_spd,
};

}  // namespace miebrdf::materials
