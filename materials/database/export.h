// Datasets as files in every format that can be imported.
#pragma once

#include <string>
#include <vector>

#include "materials/database/import.h"
#include "materials/index/dataset.h"

namespace miebrdf::materials {

struct ExportOptions {
    /// Formats that need k (SOPRA, TFCalc, IMD) write 0 for an unknown one instead of refusing.
    /// What is read back then has a known k = 0.
    bool unknown_k_as_zero = false;
};

struct ExportFile {
    std::string suffix;  ///< put after the file's base name: ".nk", ".eta.spd", ".k.spd"
    std::string text;
};

/// The dataset in a format, figures in the shortest decimals that read back to the same doubles.
///
/// CSV keeps the native unit and n and k on grids of their own; YAML keeps formulas. Both keep the
/// provenance. A format in another unit than the dataset's keeps n and k bit for bit and
/// wavelengths to the rounding of the conversion (one unit in the last place); SOPRA, which states
/// only the ends of its grid, to four times the rounding of the last. spd gives two files.
/// @throws std::invalid_argument  naming what the format cannot express: formulas (all but YAML), n
///         and k on different grids (SOPRA, TFCalc, IMD), a grid that is not uniform (SOPRA), no n
std::vector<ExportFile> export_dataset(const Dataset& dataset, Format format,
                                       const ExportOptions& options = {});

}  // namespace miebrdf::materials
