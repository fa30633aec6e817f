// Formats whose values their readers interpolate: written, read back, and refused when too coarse.
#pragma once

#include "pipeline/formats/brdf_export.h"
#include "pipeline/solve/rgb_source.h"

namespace miebrdf::exports {

/// What an export needs to know.
struct ExportJob {
    const BrdfSource& spectral;
    const RgbSource& rgb;
    const ExportOptions& options;
    const RunControl& control;
};

/// @return  the files of a format of this kind; empty when it is none
/// @throws UsageError, InputError, TooCoarse, Cancelled
std::vector<ExportedFile> export_sampled(const ExportJob& job, const std::filesystem::path& path);

}  // namespace miebrdf::exports
