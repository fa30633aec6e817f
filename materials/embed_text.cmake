# cmake -DINPUT=schema.sql -DOUTPUT=schema_sql.h -DNAME=schema_sql -P embed_text.cmake
file(READ "${INPUT}" text)
file(WRITE "${OUTPUT}" "// Generated from a text file while building.\n#pragma once\n
namespace miebrdf::materials {
inline constexpr char ${NAME}[] = R\"---(${text})---\";
}  // namespace miebrdf::materials\n")
