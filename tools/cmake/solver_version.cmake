# Writes a header with one hash over all sources that results depend on, so that no result of an
# older solver is ever taken for one of the newer: cmake -DROOT=... -DOUTPUT=... -P this
file(GLOB sources "${ROOT}/mie/*.cpp" "${ROOT}/mie/*.h" "${ROOT}/rte/*.cpp" "${ROOT}/rte/*.h"
                  "${ROOT}/rte/math/*.cpp" "${ROOT}/rte/math/*.h" "${ROOT}/pipeline/*optics.cpp"
                  "${ROOT}/pipeline/*layers.cpp"
                  "${ROOT}/pipeline/*_part.cpp")
list(SORT sources)
set(hashes "")
foreach(source IN LISTS sources)
    file(SHA256 "${source}" hash)
    string(APPEND hashes "${hash}")
endforeach()
string(SHA256 version "${hashes}")
file(WRITE "${OUTPUT}.new"
"// Generated: one hash over the sources of the solver (tools/cmake/solver_version.cmake).
#pragma once

namespace miebrdf {
inline constexpr char kSolverVersion[] = \"${version}\";
}  // namespace miebrdf
")
file(COPY_FILE "${OUTPUT}.new" "${OUTPUT}" ONLY_IF_DIFFERENT)
file(REMOVE "${OUTPUT}.new")
