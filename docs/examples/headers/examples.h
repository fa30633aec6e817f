// One function for each public header.
#pragma once

#include <array>
#include <utility>

void show_brdf();
void show_brdf_source();
void show_colour();
void show_control();
void show_database();
void show_ensemble();
void show_error();
void show_fit();
void show_formats();
void show_index();
void show_layer_albedos();
void show_match();
void show_measured();
void show_optics();
void show_plan();
void show_sampling();
void show_scene();
void show_sizes();
void show_sphere();
void show_surface();
void show_table1();
void show_transfer();
void show_value_derivatives();

inline constexpr std::array<std::pair<const char*, void (*)()>, 23> kExamples = {{
    {"brdf.h", show_brdf},
    {"brdf_source.h", show_brdf_source},
    {"colour.h", show_colour},
    {"control.h", show_control},
    {"database.h", show_database},
    {"ensemble.h", show_ensemble},
    {"error.h", show_error},
    {"fit.h", show_fit},
    {"formats.h", show_formats},
    {"index.h", show_index},
    {"layer_albedos.h", show_layer_albedos},
    {"fit.h, match", show_match},
    {"measured.h", show_measured},
    {"optics.h", show_optics},
    {"plan.h", show_plan},
    {"sampling.h", show_sampling},
    {"scene.h", show_scene},
    {"sizes.h", show_sizes},
    {"sphere.h", show_sphere},
    {"surface.h", show_surface},
    {"table1.h", show_table1},
    {"transfer.h", show_transfer},
    {"value_derivatives.h", show_value_derivatives},
}};
