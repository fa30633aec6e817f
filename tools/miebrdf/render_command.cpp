// miebrdf render: a lit object of one or several materials.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <miebrdf/error.h>
#include <miebrdf/version.h>
#include "pipeline/render/image.h"
#include "pipeline/render/lighting.h"
#include "pipeline/render/renderer.h"
#include "pipeline/render/solved_material.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/render_options.h"
#include "tools/miebrdf/render_scene.h"

namespace miebrdf::program {
namespace {

void check_ending(const std::string& path, const std::string& option, const std::string& wanted) {
    if (path.empty()) return;
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    if (ending != wanted) {
        throw UsageError(fmt::format("picture '{}': unknown ending '{}'; allowed: {} with {}", path,
                                     ending, wanted, option));
    }
}

/// Refuses names whose ending says another format, before anything is computed. Empty: no such
/// picture. @throws UsageError
void check_picture_paths(const std::string& png, const std::string& exr) {
    check_ending(png, "-o", ".png");
    check_ending(exr, "--exr", ".exr");
}

/// Linear RGB over the background, or with coverage as alpha.
/// @param background  "R,G,B", "transparent" or "environment"
/// @param exposure    brightens by powers of two
/// @throws UsageError  for another background
render::Image compose(const render::SpectralPicture& picture,
                      const std::vector<double>& wavelength_nm, const std::string& background,
                      double exposure) {
    const render::Image rgb = render::to_linear_srgb(picture.radiance, wavelength_nm);
    const bool transparent = background == "transparent";
    std::vector<double> behind(3, 0.0);
    if (!transparent && background != "environment") {
        behind = parse_number_list(background, "background", 0.0, 1.0);
        if (behind.size() != 3)
            throw UsageError("background: wanted: R,G,B, transparent or environment");
    }
    render::Image image(rgb.width, rgb.height, transparent ? 4 : 3);
    const auto gain = float(std::exp2(exposure));
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

/// A material of the picture: its BRDFs as tables, one, or one for each wavelength, and made fast.
struct Material {
    std::vector<BrdfTable> tables;
    std::shared_ptr<const render::SolvedMaterial> compact;
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
    const SceneArguments& scene = arguments.scene;
    const bool is_described =
        scene.given("base") || scene.given("substrate") || scene.given("coat");
    if (is_described == !arguments.materials.empty()) {
        throw UsageError(
            "a picture needs either --base, --substrate or --coat (with their options) or "
            "--material strings");
    }
    std::vector<std::vector<Request>> all;
    for (const std::string& text : arguments.materials)
        all.push_back(parse_material(text, wavelength_nm));
    if (is_described) all.push_back({arguments.scene.parse()});
    return all;
}

std::vector<Material> make_materials(const RenderArguments& arguments,
                                     const std::vector<std::vector<Request>>& requests,
                                     const Shell& shell) {
    const auto [cosines, orders] = parse_pair(arguments.table, "table");
    const BrdfPart part = parse_brdf_part(arguments.component);
    std::vector<Material> materials;
    for (const std::vector<Request>& request : requests) {
        Material& material = materials.emplace_back();
        for (const Request& one : request) {
            const Brdf brdf = solved(one, shell.control());
            material.tables.push_back(brdf.table(as_evaluated(brdf, part, shell)));
        }
        material.compact = std::make_shared<render::SolvedMaterial>(
            material.tables,
            CompactOptions{render::SolvedMaterial::kTolerance, int(cosines), int(orders)},
            shell.control());
        if (!arguments.measure_interpolation) continue;
        if (request.size() > 1 || part != BrdfPart::total) {
            throw UsageError("--measure-interpolation needs one request and the total component");
        }
        const auto error = render::interpolation_error(material.compact->table(),
                                                       solved(request.front(), shell.control()));
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

int run_render(const RenderArguments& arguments, const Shell& shell) {
    if (shell.common().output.empty() && arguments.exr.empty()) {
        throw UsageError("a picture needs -o FILE.png or --exr FILE.exr");
    }
    check_picture_paths(shell.common().output, arguments.exr);
    const std::vector<double> wavelength_nm = arguments.scene.parse().wavelength_nm;
    const auto [width, height] = parse_size(arguments.size);
    const auto [elevation, azimuth] = parse_pair(arguments.camera, "camera");
    const auto requests = material_requests(arguments, wavelength_nm);
    render::RayScene object = parse_object(arguments.object);
    render::MaterialMap map = map_of(arguments, object, requests.size());
    render::Lighting lighting =
        parse_lights(arguments.lights, arguments.light_spectrum, object.bounds(), wavelength_nm);
    const render::Camera camera(object.bounds(), render::direction_from_angles(elevation, azimuth),
                                arguments.field_of_view_deg, arguments.zoom,
                                static_cast<double>(width) / height);
    render::RenderOptions options = arguments.options;
    options.width = width;
    options.height = height;
    options.environment_visible = arguments.background == "environment";

    Stopwatch watch;
    const std::vector<Material> materials = make_materials(arguments, requests, shell);
    const double solve_s = watch.lap_s();
    render::RenderScene scene{std::move(object), std::move(map), {}, std::move(lighting)};
    for (const Material& material : materials) scene.materials.push_back(material.compact);
    const render::SpectralPicture picture =
        render::render_picture(scene, camera, options, shell.control());
    const double render_s = watch.lap_s();

    render::PictureNotes notes = {{"Software", fmt::format("miebrdf {}", kVersion)},
                                  {"Comment", shell.command_line()}};
    bool converged = true;
    for (const Material& material : materials) {
        for (const BrdfTable& table : material.tables) {
            converged = converged && table.report().converged();
            for (const std::string& source : table.provenance().sources) {
                if (std::find(notes.begin(), notes.end(),
                              std::pair<std::string, std::string>("Source", source)) == notes.end())
                    notes.emplace_back("Source", source);
            }
        }
    }
    if (!arguments.exr.empty()) write_spectral_exr(picture, wavelength_nm, notes, arguments.exr);
    if (!shell.common().output.empty()) {
        render::write_png(compose(picture, wavelength_nm, arguments.background, arguments.exposure),
                          notes, shell.common().output);
    }
    Table files{.facts = {{"noise", rounded(picture.noise, 3)},
                          {"clamped", rounded(picture.clamped, 3)},
                          {"converged", std::string(converged ? "yes" : "no")}},
                .columns = {"file"}};
    for (const std::string& file : {shell.common().output, arguments.exr}) {
        if (!file.empty()) files.rows.push_back({file});
    }
    shell.tell_written(std::move(files));
    shell.note(
        fmt::format("{} wavelength{}; solution {:.1f} s, picture {:.1f} s; noise {:.1e} of the "
                    "mean radiance{}; solver {}",
                    wavelength_nm.size(), wavelength_nm.size() == 1 ? "" : "s", solve_s, render_s,
                    picture.noise,
                    picture.clamped > 0.0
                        ? fmt::format(", --clamp took {:.2g} % of the light", 100 * picture.clamped)
                        : std::string(),
                    converged ? "converged" : "NOT converged"));
    return converged ? kGood : kNotConverged;
}

}  // namespace

void add_render(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<RenderArguments>();
    arguments->scene.add_to(command, shell, SceneArguments::Base::optional, kDefaultWavelengths);
    add_render_options(command, *arguments);
    finish(
        command, shell, arguments, run_render,
        "Example:\n  miebrdf render --base TiO2 --coat AlGaAs_70@0.1 --roughness 0.3 -o sphere.png",
        Writes::file);
}

}  // namespace miebrdf::program
