// libyaml's functions, loaded when they are called first (materials/libraries/late_library.h).
#pragma once

#include <yaml.h>

#include "materials/libraries/late_library.h"

namespace miebrdf::materials {

inline const LateLibrary& libyaml() {
    static const LateLibrary library(MIEBRDF_LATE_YAML);
    return library;
}

}  // namespace miebrdf::materials

// clang-format off
#define yaml_event_delete(...) MIEBRDF_LATE(::miebrdf::materials::libyaml(), yaml_event_delete)(__VA_ARGS__)
#define yaml_parser_delete(...) MIEBRDF_LATE(::miebrdf::materials::libyaml(), yaml_parser_delete)(__VA_ARGS__)
#define yaml_parser_initialize(...) MIEBRDF_LATE(::miebrdf::materials::libyaml(), yaml_parser_initialize)(__VA_ARGS__)
#define yaml_parser_parse(...) MIEBRDF_LATE(::miebrdf::materials::libyaml(), yaml_parser_parse)(__VA_ARGS__)
#define yaml_parser_set_input_string(...) MIEBRDF_LATE(::miebrdf::materials::libyaml(), yaml_parser_set_input_string)(__VA_ARGS__)
// clang-format on
