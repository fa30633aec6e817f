// Input of a format's writer, and facts that every file states besides its numbers.
#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include <miebrdf/formats.h>
#include "pipeline/formats/common/rgb_source.h"

namespace miebrdf {

struct ExportJob {
    const BrdfSource& spectral;    ///< has wavelengths
    const RgbSource& rgb;          ///< the same as colours
    const ExportOptions& options;  ///< complete (ready_options)
    const Control& control;
};

/// The options with everything filled in that the format takes: the resolution, all of `extra`.
/// @throws UsageError  for a number out of range, or an extra that the format does not have
ExportOptions ready_options(const Format& format, const ExportOptions& options);

/// The source of a format's colours. @throws UsageError  also for a source without wavelengths
RgbWeights colours_of(const Format& format, const ExportOptions& options, const BrdfSource& source);

/// One file of a format as it is written, not read back.
/// @throws UsageError, Cancelled
void write_format(const Format& format, const FormatFile& file, const BrdfSource& source,
                  const ExportOptions& options, std::ostream& out, const Control& control = {});

/// Choices of a format for what all of them write.
struct Conventions {
    std::string format;            ///< name on the command line
    bool cosine_included = false;  ///< of stored values; what readers return is the BRDF
    std::string azimuth_zero;      ///< which side the format's azimuth 0 is
    std::string colour;            ///< primaries, illuminant, observer; empty: spectral
};

/// A file must say this besides its numbers: units, cosine, azimuth zero, wavelengths, colour,
/// version, command line, sources. Inside the file where the format has room for it, else in
/// FILE.json.
nlohmann::ordered_json metadata(const BrdfSource& source, const Conventions& conventions);

/// Without line breaks.
std::string one_line(std::string text);
/// Without the two hyphens that end an XML comment.
std::string in_xml_comment(std::string text);

}  // namespace miebrdf
