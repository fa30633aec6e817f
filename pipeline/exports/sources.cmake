# Sources of the pipeline's exports, included by pipeline/CMakeLists.txt.
find_package(PkgConfig REQUIRED)
pkg_check_modules(libzip REQUIRED libzip>=1.7)  # linked by name: its CMake package asks for its tools too
find_package(OpenEXR 3.1 CONFIG REQUIRED)
find_package(pugixml REQUIRED)
set(miebrdf_export_libraries zip OpenEXR::OpenEXR pugixml::pugixml)
set(miebrdf_export_sources
    exports/astm_writer.cpp
    exports/azimuth_series.cpp
    exports/brdf_export.cpp
    exports/brdf_source.cpp
    exports/deviation.cpp
    exports/exr_writer.cpp
    exports/file_check.cpp
    exports/first_order.cpp
    exports/half_vector_table.cpp
    exports/klems_writer.cpp
    exports/merl_writer.cpp
    exports/metadata.cpp
    exports/npz_writer.cpp
    exports/pbrt_writer.cpp
    exports/polar_grid.cpp
    exports/radiance_xml.cpp
    exports/readers/angle_table_reader.cpp
    exports/readers/bilinear_warp.cpp
    exports/readers/brdf_file.cpp
    exports/readers/catmull_rom.cpp
    exports/readers/exr_header.cpp
    exports/readers/exr_reader.cpp
    exports/readers/grid_file.cpp
    exports/readers/klems_reader.cpp
    exports/readers/merl_reader.cpp
    exports/readers/npz_reader.cpp
    exports/readers/pbrt_reader.cpp
    exports/readers/radiance_file.cpp
    exports/readers/radiance_reader.cpp
    exports/readers/rgl_reader.cpp
    exports/readers/rgl_tables.cpp
    exports/readers/scatfun_tables.cpp
    exports/readers/tensor_file_reader.cpp
    exports/readers/tensor_tree_reader.cpp
    exports/readers/text_table_reader.cpp
    exports/rgb_source.cpp
    exports/rgb_weights.cpp
    exports/rgl_writer.cpp
    exports/sampled_export.cpp
    exports/sharp_part.cpp
    exports/smooth_part.cpp
    exports/solved_source.cpp
    exports/spectrum_writer.cpp
    exports/ssdd_writer.cpp
    exports/table_check.cpp
    exports/table_grid.cpp
    exports/table_writer.cpp
    exports/tensor_tree_writer.cpp
    exports/tensor_file.cpp
    exports/wavelength_solution.cpp
    exports/zip_stream.cpp)

# What other programs may use; the rest of the headers are for these sources alone.
foreach(header brdf_export.h brdf_source.h deviation.h file_check.h first_order.h merl_writer.h readers/brdf_file.h
               rgb_source.h rgb_weights.h sharp_part.h smooth_part.h solved_source.h spectrum_writer.h
               table_check.h table_grid.h wavelength_solution.h)
    get_filename_component(folder "${header}" DIRECTORY)
    install(FILES "${CMAKE_CURRENT_LIST_DIR}/${header}"
            DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/miebrdf/pipeline/exports/${folder}")
endforeach()
