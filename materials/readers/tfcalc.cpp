// TFCalc .MAT: lines of fields between asterisks; wavelengths in nm.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "materials/index/units.h"
#include "materials/readers/file_format.h"
#include "materials/readers/text.h"

namespace miebrdf::materials {
namespace {

// "DATA1*1*206.6*0.91*2.28*" -> {"DATA1", "1", "206.6", "0.91", "2.28"}; the last '*' may be
// missing.
std::vector<std::string_view> fields_of(std::string_view line) {
    std::vector<std::string_view> fields;
    while (!line.empty()) {
        const std::size_t end = std::min(line.find('*'), line.size());
        fields.push_back(without_blanks(line.substr(0, end)));
        line.remove_prefix(std::min(end + 1, line.size()));
    }
    return fields;
}

bool looks_like_tfcalc(std::string_view text) {
    const std::string_view start = without_blanks(text.substr(0, 200));
    return start.starts_with("VERSION*") || start.starts_with("FORMAT*") ||
           start.starts_with("POINTS*");
}

Dataset read_tfcalc(const SourceFile& source, const ReadOptions& options) {
    const std::string file = source.path.string();
    Dataset dataset;
    dataset.format = "tfcalc";
    RawTable table;
    table.unit = Unit::nanometre;
    std::optional<double> announced;
    bool ended = false;
    std::vector<std::string> remarks;
    BadRows bad;
    int line = 0;
    std::size_t rows = 0;
    for (const std::string_view raw : split_lines(source.text)) {
        ++line;
        const auto fields = fields_of(without_blanks(raw.substr(0, raw.find('\x1a'))));
        if (fields.empty() || ended) continue;
        if (fields[0] == "DATA1") {
            ++rows;
            bad.try_row(options, [&] {
                if (fields.size() < 5)
                    throw ImportError(file, line, "DATA1 needs index, wavelength, n, k");
                table.rows.push_back({require_number(fields[2], file, line),
                                      require_number(fields[3], file, line),
                                      require_number(fields[4], file, line), line});
            });
        } else if (fields[0] == "POINTS" && fields.size() > 1) {
            announced = require_number(fields[1], file, line);
        } else if (fields[0] == "FORMAT" && fields.size() > 1 && fields[1] != "1") {
            throw ImportError(file, line,
                              fmt::format("TFCalc format {}; only 1 is known", fields[1]));
        } else if (fields[0] == "COMMENT" && fields.size() > 1) {
            remarks.emplace_back(fields[1]);
        } else if (fields[0] == "EOF") {
            ended = true;
        }
    }
    if (announced && *announced != static_cast<double>(rows)) {
        throw ImportError(file, 0, fmt::format("announces {} points and has {}", *announced, rows));
    }
    take_remarks(dataset, remarks);
    bad.record(dataset, table.rows.size());
    if (!ended) dataset.corrections.push_back("no EOF line at the end of the file");
    add_table(dataset, std::move(table), file, options);
    return dataset;
}

std::vector<ExportFile> write_tfcalc(const Dataset& d, const ExportOptions& options) {
    const JointTable table = joint_table(d, "tfcalc", options);
    std::string text = fmt::format("VERSION*1*\nFORMAT*1*\nPOINTS*{}*\n", table.n.x.size());
    for (std::size_t i = 0; i < table.n.x.size(); ++i) {
        fmt::format_to(std::back_inserter(text), "DATA1*{}*{}*{}*{}*\n", i + 1,
                       in_unit(table.n, i, Unit::nanometre), table.n.y[i], table.k[i]);
    }
    for (std::string remark : provenance_lines(d)) {
        std::replace(remark.begin(), remark.end(), '*', ' ');
        fmt::format_to(std::back_inserter(text), "COMMENT*{}*\n", remark);
    }
    return {{".MAT", text + "EOF*\n"}};
}

}  // namespace

extern const FileFormat kTfcalc;
constinit const FileFormat kTfcalc{
    .name = "tfcalc",
    .title = "TFCalc",
    .endings = {".MAT"},
    .looks_like = looks_like_tfcalc,
    .read = read_tfcalc,
    .write = write_tfcalc,
};

}  // namespace miebrdf::materials
