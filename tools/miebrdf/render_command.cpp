// miebrdf render: a lit object of one or several materials.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "pipeline/error.h"
#include "pipeline/number_list.h"
#include "pipeline/render/light_spectrum.h"
#include "pipeline/render/renderer.h"
#include "pipeline/version.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/render_materials.h"
#include "tools/miebrdf/render_scene.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {
namespace {

using Materials = std::vector<std::shared_ptr<const render::SolvedBrdf>>;

struct RenderArguments {
    SceneArguments scene;
    CLI::App* command = nullptr;
    std::vector<std::string> materials;
    std::string component = "total";
    std::string object = "sphere";
    std::optional<double> split;
    std::string mask;
    std::string mask_projection = "front";
    std::vector<std::string> lights = {"area:40,-40,25,2.2", "uniform:0.1"};
    std::string light_spectrum = "white";
    std::string camera = "0,0";
    double field_of_view_deg = 25.0;
    double zoom = 0.95;
    std::string size = "512,512";
    std::string background = "1,1,1";
    double exposure = 0.0;
    std::string exr;
    std::string table = "49,33";
    bool measure_interpolation = false;
    render::RenderOptions options;
};

/// Wavelengths of a picture that asks for none: where all bundled materials are known, and close
/// enough for the colours of smooth spectra.
constexpr char kDefaultWavelengths[] = "400:700:20";

class Stopwatch {
  public:
    double lap_s() {
        const auto now = std::chrono::steady_clock::now();
        const std::chrono::duration<double> lap = now - last_;
        last_ = now;
        return lap.count();
    }

  private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// The scene options themselves are the material, unless there are --material strings.
std::vector<std::vector<Request>> material_requests(const RenderArguments& arguments,
                                                    const std::vector<double>& wavelength_nm) {
    const bool has_base = arguments.command->get_option("--base")->count() > 0;
    if (has_base == !arguments.materials.empty()) {
        throw UsageError("a picture needs either --base (with its options) or --material strings");
    }
    std::vector<std::vector<Request>> all;
    for (const std::string& text : arguments.materials)
        all.push_back(parse_material(text, wavelength_nm));
    if (has_base) {
        Request request = arguments.scene.parse();
        request.wavelength_nm = wavelength_nm;
        all.push_back({request});
    }
    return all;
}

std::vector<double> wavelengths_of(const RenderArguments& arguments) {
    const auto* option = arguments.command->get_option("--wavelengths");
    return parse_wavelengths_nm(option->count() > 0 ? option->as<std::string>()
                                                    : kDefaultWavelengths);
}

Materials solve(const RenderArguments& arguments, const std::vector<std::vector<Request>>& requests,
                const Shell& shell) {
    const auto [cosines, azimuths] = parse_pair(arguments.table, "table");
    const render::Component component = parse_component(arguments.component);
    Materials materials;
    for (const auto& request : requests) {
        materials.push_back(
            render::solve_brdf(request, component, {int(cosines), int(azimuths)}, shell.control()));
        if (!arguments.measure_interpolation) continue;
        if (request.size() > 1 || component != render::Component::total) {
            throw UsageError("--measure-interpolation needs one request and the total component");
        }
        const auto error =
            render::interpolation_error(*materials.back(), request.front(), shell.control());
        shell.note(
            fmt::format("interpolation error relative to the largest value at each incidence: "
                        "median {:.1e}, largest {:.1e}",
                        error.median, error.largest));
    }
    return materials;
}

render::MaterialMap map_of(const RenderArguments& arguments, const render::RayScene& object,
                           std::size_t materials) {
    if (arguments.split && !arguments.mask.empty()) throw UsageError("--split or --mask, not both");
    const bool has_regions = arguments.split || !arguments.mask.empty();
    if (has_regions != (materials > 1) || (arguments.split && materials != 2)) {
        throw UsageError(
            fmt::format("{} materials; --split needs two, --mask two or more, and without "
                        "either there is one",
                        materials));
    }
    if (arguments.split) return render::MaterialMap::split(*arguments.split, object.bounds());
    if (arguments.mask.empty()) return {};
    const bool front = arguments.mask_projection == "front";
    if (!front && arguments.mask_projection != "uv") {
        throw UsageError(fmt::format("unknown mask projection '{}'; allowed: front, uv",
                                     arguments.mask_projection));
    }
    return render::MaterialMap::mask(
        render::read_grey_png(arguments.mask), materials,
        front ? render::MaskProjection::front : render::MaskProjection::uv, object, arguments.mask);
}

/// Linear RGB over the background, or with coverage as alpha.
render::Image compose(const RenderArguments& arguments, const render::SpectralPicture& picture,
                      const std::vector<double>& wavelength_nm) {
    const render::Image rgb = render::to_linear_srgb(picture.radiance, wavelength_nm);
    const bool transparent = arguments.background == "transparent";
    std::vector<double> behind(3, 0.0);
    if (!transparent && arguments.background != "environment") {
        behind = parse_number_list(arguments.background, "background", 0.0, 1.0);
        if (behind.size() != 3)
            throw UsageError("background: wanted: R,G,B, transparent or environment");
    }
    render::Image image(rgb.width, rgb.height, transparent ? 4 : 3);
    const auto gain = float(std::exp2(arguments.exposure));
    for (int y = 0; y < rgb.height; ++y) {
        for (int x = 0; x < rgb.width; ++x) {
            const float share = *picture.coverage.pixel(x, y);
            float* pixel = image.pixel(x, y);
            for (int c = 0; c < 3; ++c) {
                const float value = gain * rgb.pixel(x, y)[c];
                // PNG wants colours that are not yet multiplied by alpha.
                pixel[c] = transparent ? (share > 0.0F ? value / share : 0.0F)
                                       : value + (1.0F - share) * float(behind[std::size_t(c)]);
            }
            if (transparent) pixel[3] = share;
        }
    }
    return image;
}

/// Channels R, G, B, A, and one for each wavelength named as in spectral OpenEXR files
/// ("S0.550,000000nm"; Fichet et al. 2021).
void write_spectral_exr(const render::SpectralPicture& picture,
                        const std::vector<double>& wavelength_nm, const render::PictureNotes& notes,
                        const std::string& path) {
    const render::Image rgb = render::to_linear_srgb(picture.radiance, wavelength_nm);
    const int count = int(wavelength_nm.size());
    render::Image all(rgb.width, rgb.height, 4 + count);
    for (int y = 0; y < rgb.height; ++y) {
        for (int x = 0; x < rgb.width; ++x) {
            float* pixel = all.pixel(x, y);
            std::copy_n(rgb.pixel(x, y), 3, pixel);
            pixel[3] = *picture.coverage.pixel(x, y);
            std::copy_n(picture.radiance.pixel(x, y), count, pixel + 4);
        }
    }
    std::vector<std::string> names = {"R", "G", "B", "A"};
    for (const double wavelength : wavelength_nm) {
        std::string number = fmt::format("{:.6f}", wavelength);
        std::replace(number.begin(), number.end(), '.', ',');
        names.push_back(fmt::format("S0.{}nm", number));
    }
    render::write_exr(all, names, notes, path);
}

int run_render(const RenderArguments& arguments, const Shell& shell) {
    if (shell.common().output.empty() && arguments.exr.empty()) {
        throw UsageError("a picture needs -o FILE.png or --exr FILE.exr");
    }
    const std::vector<double> wavelength_nm = wavelengths_of(arguments);
    const auto [width, height] = parse_pair(arguments.size, "size");
    const auto [elevation, azimuth] = parse_pair(arguments.camera, "camera");
    const auto requests = material_requests(arguments, wavelength_nm);
    render::RayScene object = parse_object(arguments.object);
    render::MaterialMap map = map_of(arguments, object, requests.size());
    render::Lighting lighting =
        parse_lights(arguments.lights, arguments.light_spectrum, object.bounds(), wavelength_nm);
    const render::Camera camera(object.bounds(), render::direction_from_angles(elevation, azimuth),
                                arguments.field_of_view_deg, arguments.zoom, width / height);
    render::RenderOptions options = arguments.options;
    options.width = int(width);
    options.height = int(height);
    options.environment_visible = arguments.background == "environment";

    Stopwatch watch;
    const Materials materials = solve(arguments, requests, shell);
    const double solve_s = watch.lap_s();
    render::RenderScene scene{std::move(object), std::move(map), {}, std::move(lighting)};
    scene.materials.assign(materials.begin(), materials.end());
    const render::SpectralPicture picture =
        render::render_picture(scene, camera, options, shell.control());
    const double render_s = watch.lap_s();

    render::PictureNotes notes = {{"Software", fmt::format("miebrdf {}", kVersion)},
                                  {"Comment", shell.command_line()}};
    bool converged = true;
    for (const auto& material : materials) {
        converged = converged && material->converged();
        for (const std::string& source : material->sources()) notes.emplace_back("Source", source);
    }
    if (!arguments.exr.empty()) write_spectral_exr(picture, wavelength_nm, notes, arguments.exr);
    if (!shell.common().output.empty()) {
        render::write_png(compose(arguments, picture, wavelength_nm), notes, shell.common().output);
    }
    shell.note(
        fmt::format("{} wavelengths; solution {:.1f} s, picture {:.1f} s; noise {:.1e} of the mean "
                    "radiance; solver {}",
                    wavelength_nm.size(), solve_s, render_s, picture.noise,
                    converged ? "converged" : "NOT converged"));
    return converged ? kGood : kNotConverged;
}

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

void add_render_command(CLI::App& program, Shell& shell) {
    auto* command =
        program.add_subcommand("render", "a picture of a lit object of these materials");
    auto arguments = std::make_shared<RenderArguments>();
    arguments->command = command;
    arguments->scene.add_to(*command);
    command->get_option("--base")->required(false);
    add_material_options(*command, *arguments);
    add_picture_options(*command, *arguments);
    shell.add_common_options(*command);
    command->footer(
        "Example:\n  miebrdf render --base TiO2 --coat AlGaAs_70@0.1 --roughness 0.3 -o "
        "sphere.png");
    shell.on_run(*command, [arguments, &shell] { return run_render(*arguments, shell); });
}

}  // namespace miebrdf::program
