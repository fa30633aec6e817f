// Every export format behind one function: writes, reads back, and refuses what came out too
// coarse.
#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/formats/deviation.h"
#include "pipeline/formats/merl_writer.h"
#include "pipeline/formats/table_grid.h"
#include "pipeline/solve/rgb_source.h"

namespace miebrdf::exports {

struct ExportOptions {
    std::string format;
    /// Format-specific fineness; 0: the format's default. pbrt: intervals of cosine; rgl: half
    /// vectors per side; ssdd, astm: directions per quarter turn; radiance: levels of the tree.
    int resolution = 0;
    int incident_angles = 24;  ///< rgl only
    TableGrid grid;            ///< csv, json, npz, exr; empty lists: the default directions
    MerlSample merl_sample = MerlSample::lower_edge;
    RgbWeights rgb;  ///< empty weights: the nearest single wavelengths
    /// Largest root mean square relative error, at mu > 0.2 and near the mirror direction, with
    /// which a file is still written; 0: the format's default.
    double largest_error = 0.0;
};

struct ExportedFile {
    std::filesystem::path path;
    std::uintmax_t bytes = 0;  ///< 0: a pipe or device
    std::optional<Deviation>
        deviation;  ///< read back; empty for tables, exact where they are given
};

/// A file that its own reader cannot tell from the BRDF well enough. Nothing was written.
class TooCoarse : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// @return  the files written; rgl writes two, <stem>_spec and <stem>_rgb
/// @throws UsageError  for an unknown format or options out of range; InputError when a file cannot
///         be written; TooCoarse with the error and a resolution that would do; Cancelled
std::vector<ExportedFile> export_brdf(const BrdfSource& source, const ExportOptions& options,
                                      const std::filesystem::path& path,
                                      const RunControl& control = {});

/// The error (of ExportOptions::largest_error) with which a format is written by default; of
/// tables, which are not read back, that of a careful format.
double accepted_error(const std::string& format);

/// Names that export_brdf knows.
const std::vector<std::string>& export_formats();

}  // namespace miebrdf::exports
