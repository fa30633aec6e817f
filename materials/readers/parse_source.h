// From a file's bytes to a dataset that knows where it came from.
#pragma once

#include "materials/database/import.h"
#include "materials/readers/source_file.h"

namespace miebrdf::materials {

/// @throws ImportError
Dataset parse_source(Format format, const SourceFile& source, const ImportOptions& options);

/// File, checksum, key, label and material, as far as the file itself did not say them; what the
/// options give comes first.
void fill_origin(Dataset& dataset, const SourceFile& source, const ImportOptions& options);

}  // namespace miebrdf::materials
