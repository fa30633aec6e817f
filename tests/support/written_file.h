// A file of an export format in memory, as it is written: not read back, not refused.
#pragma once

#include <sstream>
#include <string>

#include "pipeline/formats/common/export_job.h"

namespace miebrdf::support {

/// @param part  which of the files that the format writes
inline std::string written_file(const std::string& format, const BrdfSource& source,
                                const ExportOptions& options = {}, std::size_t part = 0) {
    const Format& known = find_format(format);
    std::ostringstream out;
    write_format(known, known.files.at(part), source, options, out);
    return std::move(out).str();
}

}  // namespace miebrdf::support
