#include "tools/miebrdf/render_options.h"

namespace miebrdf::program {
namespace {

void add_material_options(CLI::App& command, RenderArguments& a) {
    auto* group = command.add_option_group("Materials and regions");
    group
        ->add_option("--material", a.materials,
                     "scene options of one material in one string without their dashes, instead of "
                     "--base; repeat for several regions; numbers of hg: and the like may be lists "
                     "a/b/c, one value for each wavelength")
        ->type_name("'base=MEDIUM coat=MEDIUM@DEPTH roughness=A ...'")
        ->allow_extra_args(false);
    group
        ->add_option("--split", a.split,
                     "first material left, second right of this share of the object's width")
        ->type_name("SHARE");
    group
        ->add_option("--mask", a.mask,
                     "grey levels choose materials: black the first, white the last")
        ->type_name("FILE.png");
    group->add_option("--mask-projection", a.mask_projection, "front or uv")->capture_default_str();
    group->add_option("--component", a.component, "total, subsurface or surface")
        ->capture_default_str();
    group
        ->add_option("--table", a.table, "cosines and azimuths of the table of multiple scattering")
        ->type_name("N,N")
        ->capture_default_str();
    group->add_flag("--measure-interpolation", a.measure_interpolation,
                    "compare the table with the solver between its nodes");
}

void add_picture_options(CLI::App& command, RenderArguments& a) {
    auto* group = command.add_option_group("Picture");
    group->add_option("--object", a.object, "sphere, knot, plaque or FILE.obj")
        ->capture_default_str();
    group
        ->add_option("--light", a.lights,
                     "directional:ELEVATION,AZIMUTH[,IRRADIANCE], area:ELEVATION,AZIMUTH,SIZE"
                     "[,IRRADIANCE], uniform:RADIANCE, sky:ELEVATION,AZIMUTH[,SCALE] or "
                     "map:FILE[,SCALE] (.exr, .hdr); degrees, azimuth from the front to the right; "
                     "repeat for more")
        ->type_name("LIGHT")
        ->allow_extra_args(false)
        ->capture_default_str();
    group
        ->add_option(
            "--light-spectrum", a.light_spectrum,
            "of directional, area and uniform light: white (D65), equal or blackbody:KELVIN")
        ->capture_default_str();
    group->add_option("--camera", a.camera, "elevation and azimuth of the camera in degrees")
        ->type_name("ELEVATION,AZIMUTH")
        ->capture_default_str();
    group->add_option("--field-of-view", a.field_of_view_deg, "degrees; 0: parallel rays")
        ->capture_default_str();
    group->add_option("--zoom", a.zoom, "1: the object's bounding sphere touches the edges")
        ->capture_default_str();
    group->add_option("--size", a.size, "of the picture in pixels")
        ->type_name("WIDTH,HEIGHT")
        ->capture_default_str();
    group->add_option("--samples", a.options.samples, "paths for each pixel")
        ->capture_default_str();
    group->add_option("--bounces", a.options.bounces, "most reflections of a path; 1: direct light")
        ->capture_default_str();
    group->add_option("--seed", a.options.seed, "of the samples")->capture_default_str();
    group->add_option("--exposure", a.exposure, "brightens the PNG by powers of two")
        ->capture_default_str();
    group
        ->add_option("--background", a.background,
                     "of the PNG: linear R,G,B in [0, 1], transparent or environment")
        ->capture_default_str();
    group->add_option("--exr", a.exr, "write linear RGB and every wavelength to FILE")
        ->type_name("FILE");
}

}  // namespace

void add_render_options(CLI::App& command, RenderArguments& a) {
    add_material_options(command, a);
    add_picture_options(command, a);
}

}  // namespace miebrdf::program
