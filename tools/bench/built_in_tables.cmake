# cmake -DTABLES="a.csv;b.csv" -DFOLDER=tests/reference -DOUTPUT=x.cpp -P built_in_tables.cmake
file(WRITE "${OUTPUT}" "// Generated from tests/reference while building.\n#include \"tools/bench/truth.h\"\n
namespace miebrdf::bench {\n
const char* built_in_table(const std::string& name) {\n")
foreach(table IN LISTS TABLES)
    file(READ "${FOLDER}/${table}" text)
    file(APPEND "${OUTPUT}" "    if (name == \"${table}\") return R\"---(${text})---\";\n")
endforeach()
file(APPEND "${OUTPUT}" "    return nullptr;\n}\n\n}  // namespace miebrdf::bench\n")
