#include "tools/miebrdf/scene_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"

namespace miebrdf::program {
namespace {

/// Looks a word up in a table of words; the message lists them.
template <typename Value>
Value one_of(const std::map<std::string, Value>& words, const std::string& word,
             const std::string& what) {
    const auto found = words.find(word);
    if (found != words.end()) return found->second;
    std::string allowed;
    for (const auto& [name, value] : words) allowed += (allowed.empty() ? "" : ", ") + name;
    throw UsageError(fmt::format("unknown {} '{}'; allowed: {}", what, word, allowed));
}

/// "power-law, effective radius 50 um, effective variance 0.2"
std::string sizes_text(const mie::SizeDistribution& sizes) {
    std::string text =
        fmt::format("{}, effective radius {} um", name_of(sizes.kind), sizes.effective_radius_um);
    if (has_variance(sizes.kind))
        text += fmt::format(", effective variance {}", sizes.effective_variance);
    return text;
}

}  // namespace

std::complex<double> parse_index(const std::string& text, const std::string& what) {
    const auto parts = split_list(text);
    if (parts.empty() || parts.size() > 2) {
        throw UsageError(fmt::format("{}: write N,K, e.g. 1.5,0; found '{}'", what, text));
    }
    const double n = parse_number(parts[0], what);
    const double k = parts.size() == 2 ? parse_number(parts[1], what) : 0.0;
    if (!(n > 0.0 && k >= 0.0)) {
        throw UsageError(
            fmt::format("{}: {} + {}i is out of range; allowed: n > 0, k >= 0", what, n, k));
    }
    return {n, k};
}

void ParticleArguments::add_to(CLI::App& command) {
    auto* group = command.add_option_group("Particles (media that go through Mie theory)");
    group
        ->add_option("--effective-radius", options_.sizes.effective_radius_um,
                     "effective radius <r^3>/<r^2> in um, of media that say none themselves")
        ->capture_default_str();
    group
        ->add_option("--effective-variance", options_.sizes.effective_variance,
                     "effective variance")
        ->capture_default_str();
    std::string laws;
    for (const auto& form : mie::size_distribution_forms()) {
        laws += (laws.empty() ? "" : ", ") + form.name;
    }
    group->add_option("--size-distribution", distribution_, laws)->capture_default_str();
    group
        ->add_option("--host-index", options_.host_index,
                     "refractive index of the medium between the particles")
        ->capture_default_str();
    group->add_option("--k-floor", options_.k_floor, "raise a smaller k of the material to this")
        ->capture_default_str();
    group
        ->add_option("--mie-tolerance", options_.tolerance,
                     "relative error of the size average; 0: a fifth of --tolerance")
        ->capture_default_str();
}

ParticleOptions ParticleArguments::parse() const {
    ParticleOptions options = options_;
    options.sizes.kind = mie::parse_size_distribution(distribution_);
    return options;
}

std::string describe_particles(const ParticleOptions& particles) {
    return fmt::format("{}, in a host of index {}", sizes_text(particles.sizes),
                       particles.host_index);
}

std::string describe_particles(const Scene& scene) {
    std::vector<std::pair<std::string, std::string>> layers;  // name, sizes
    const auto add = [&](const std::string& place, const Medium& medium) {
        if (!needs_mie(medium)) return;
        layers.emplace_back(place + " " + describe(with_sizes(medium, {})),
                            sizes_text(particles_of(medium, scene.particles).sizes));
    };
    add("base", scene.base);
    for (std::size_t c = 0; c < scene.coats.size(); ++c)
        add(fmt::format("coat {}", c + 1), scene.coats[c].medium);
    if (layers.empty()) return "";
    const auto& first = layers.front().second;
    const bool one = std::all_of(layers.begin(), layers.end(),
                                 [&](const auto& layer) { return layer.second == first; });
    std::string text = one ? first + ", " : "";
    for (const auto& [name, sizes] : layers) {
        if (!one) text += fmt::format("{}: {}; ", name, sizes);
    }
    return text + fmt::format("in a host of index {}", scene.particles.host_index);
}

void MaterialArguments::add_to(CLI::App& command, const std::string& default_wavelengths) {
    wavelengths_ = default_wavelengths;
    command
        .add_option("--wavelengths", wavelengths_,
                    "list or range first:last:step, in nm unless a unit is given: 450,550,650 or "
                    "400:700:10 or "
                    "0.55um or 2.25eV; rgb is 620,535,480")
        ->type_name("LIST")
        ->capture_default_str();
    command
        .add_option(
            "--database", database_,
            "the user's materials, over the embedded ones; default: $MIEBRDF_DATABASE, else "
            "$XDG_DATA_HOME/miebrdf/materials.sqlite")
        ->type_name("FILE");
}

std::vector<double> MaterialArguments::wavelengths_nm() const {
    return parse_wavelengths_nm(wavelengths_);
}

std::string MaterialArguments::database() const {
    if (!database_.empty()) return database_;
    const char* variable = std::getenv("MIEBRDF_DATABASE");
    return variable == nullptr ? "" : variable;
}

void SceneArguments::add_to(CLI::App& command, Base base, const std::string& default_wavelengths) {
    command
        .add_option("--base", base_,
                    "the semi-infinite base: a material's NAME, index:N,K, isotropic:ALBEDO, "
                    "rayleigh:ALBEDO, hg:ALBEDO,G or moments:FILE; spheres may have sizes of "
                    "their own: TiO2,radius=0.2,variance=0.1,distribution=gamma")
        ->type_name("MEDIUM")
        ->required(base == Base::required);
    command
        .add_option("--coat", coats_,
                    "a coat of paint, inf deep if nothing below may show; repeat it for more, "
                    "each on top of the last")
        ->type_name("MEDIUM@OPTICAL_DEPTH")
        ->allow_extra_args(false);
    materials_.add_to(command, default_wavelengths);
    add_surface_options(command);
    particles_.add_to(command);
    add_solver_options(command);
}

void SceneArguments::add_surface_options(CLI::App& command) {
    auto* group = command.add_option_group("Surface");
    roughness_option_ =
        group
            ->add_option("--roughness", roughness_,
                         "Beckmann slope parameter of a rough surface on top; 0: no surface lobe")
            ->capture_default_str();
    group
        ->add_option("--coupling", coupling_,
                     "how light enters and leaves: paper (eq. 5) or reciprocal")
        ->capture_default_str();
    group
        ->add_option("--surface-index", surface_index_,
                     "refractive index of the surface; default: that of the top medium")
        ->type_name("N,K");
}

void SceneArguments::add_solver_options(CLI::App& command) {
    auto* group = command.add_option_group("Method");
    group
        ->add_option("--tolerance", solver_.tolerance,
                     "wanted error, relative to the largest BRDF value at that incidence")
        ->capture_default_str();
    group->add_option("--streams", solver_.streams, "zenith nodes, 2 to 256; 0: from --tolerance")
        ->capture_default_str();
    group->add_option("--grid", grid_, "auto, gauss, mapped-gauss or paper")->capture_default_str();
    group->add_option("--half-space-method", half_space_method_, "auto, fixed-point or doubling")
        ->capture_default_str();
    group
        ->add_option("--coat-method", coat_method_,
                     "auto, first-order, first-order-patched or exponential")
        ->capture_default_str();
    group->add_option("--coat-substeps", solver_.coat_substeps, "steps of a stepwise coat method")
        ->capture_default_str();
    group->add_flag("--no-delta-m", no_delta_m_, "do not truncate the forward peak");
    group->add_flag("--no-single-scattering-correction", no_correction_,
                    "do not replace the first order of scattering by the exact one");
}

void SceneArguments::parse_surface(Scene& scene) const {
    static const std::map<std::string, rte::SurfaceCoupling> kCouplings = {
        {"paper", rte::SurfaceCoupling::paper}, {"reciprocal", rte::SurfaceCoupling::reciprocal}};
    scene.coupling = one_of(kCouplings, coupling_, "coupling");
    if (!(roughness_ >= 0.0 && roughness_ <= 2.0)) {
        throw UsageError(
            fmt::format("roughness: {} is out of range; allowed: 0 (no lobe) to 2", roughness_));
    }
    // A roughness of 0 that was typed is a choice, with the rest of the surface ready for another.
    if (!surface_index_.empty() && roughness_option_->count() == 0) {
        throw UsageError(
            "--surface-index belongs to a rough surface; give --roughness too, e.g. 0.3");
    }
    if (!surface_index_.empty()) scene.surface_index = parse_index(surface_index_, "surface index");
    if (roughness_ > 0.0) {
        scene.surface = rte::SurfaceOptions{};
        scene.surface->beckmann_alpha = roughness_;
    }
}

rte::CoatMethod parse_coat_method(const std::string& name) {
    static const std::map<std::string, rte::CoatMethod> kCoatMethods = {
        {"auto", rte::CoatMethod::automatic},
        {"first-order", rte::CoatMethod::first_order},
        {"first-order-patched", rte::CoatMethod::first_order_patched},
        {"exponential", rte::CoatMethod::exponential}};
    return one_of(kCoatMethods, name, "coat method");
}

Request SceneArguments::parse() const {
    static const std::map<std::string, rte::GridKind> kGrids = {
        {"auto", rte::GridKind::automatic},
        {"gauss", rte::GridKind::gauss},
        {"mapped-gauss", rte::GridKind::mapped_gauss},
        {"paper", rte::GridKind::paper}};
    static const std::map<std::string, rte::HalfSpaceMethod> kHalfSpaceMethods = {
        {"auto", rte::HalfSpaceMethod::automatic},
        {"fixed-point", rte::HalfSpaceMethod::fixed_point},
        {"doubling", rte::HalfSpaceMethod::doubling}};

    Request request;
    request.scene.base = parse_medium(base_);
    for (const std::string& coat : coats_) request.scene.coats.push_back(parse_coat(coat));
    request.scene.particles = particles_.parse();
    parse_surface(request.scene);
    request.wavelength_nm = materials_.wavelengths_nm();
    request.database = materials_.database();
    request.solver = solver_;
    request.solver.grid = one_of(kGrids, grid_, "grid");
    request.solver.half_space_method =
        one_of(kHalfSpaceMethods, half_space_method_, "half-space method");
    request.solver.coat_method = parse_coat_method(coat_method_);
    request.solver.delta_m = !no_delta_m_;
    request.solver.single_scattering_correction = !no_correction_;
    return request;
}

}  // namespace miebrdf::program
