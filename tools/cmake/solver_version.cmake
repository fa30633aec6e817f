# Writes a header with one hash over all sources that results depend on, so that no result of an
# older solver is ever taken for one of the newer:
# cmake -DROOT=... "-DAREAS=mie;rte;..." -DOUTPUT=... -P this
set(sources "")
foreach(area IN LISTS AREAS)
    file(GLOB_RECURSE found "${ROOT}/${area}/*.cpp" "${ROOT}/${area}/*.h")
    list(APPEND sources ${found})
endforeach()
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
