#include <miebrdf/processor_path.h>

#include "rte/math/compiled_for.h"

namespace miebrdf {

std::string_view processor_path() { return kCompiledFor; }

}  // namespace miebrdf
