#include "pipeline/sweep/sweep.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>
#include <numeric>
#include <set>

#include "pipeline/solve/scene_optics.h"
#include "pipeline/sweep/eradiate.h"
#include "pipeline/sweep/layout.h"

namespace miebrdf::sweep {
namespace {

bool starts_with_theta(const Axis& axis) { return axis.name.rfind("theta", 0) == 0; }

std::vector<double> cosines_of(const Axis& axis) {
    std::vector<double> cosines = axis.numbers;
    if (!starts_with_theta(axis)) {
        // Only Eradiate's layout has a 0, at its start.
        if (cosines.size() > 1 && cosines[0] == 0.0) cosines[0] = kGrazingStep * cosines[1];
        return cosines;
    }
    for (double& value : cosines) value = std::cos(value * std::numbers::pi / 180.0);
    return cosines;
}

/// The text of an axis at this place.
std::string word_at(const Sweep& sweep, const std::vector<std::size_t>& place,
                    const std::string& name) {
    for (std::size_t d = 0; d < sweep.dimensions.size(); ++d) {
        for (const Axis& axis : sweep.dimensions[d].axes) {
            if (axis.name == name) return axis.words[place[d]];
        }
    }
    throw UsageError(fmt::format("there is no axis '{0}' for {{{0}}}", name));
}

std::size_t scene_at(const Sweep& sweep, const std::vector<std::size_t>& place) {
    std::size_t scene = 0;
    for (std::size_t d = 0; d < place.size(); ++d)
        scene = scene * sweep.dimensions[d].size() + place[d];
    return scene;
}

/// The scene at the start of all dimensions but one.
std::size_t neighbour(const Sweep& sweep, std::size_t dimension, std::size_t index) {
    std::vector<std::size_t> place(sweep.dimensions.size(), 0);
    place[dimension] = index;
    return scene_at(sweep, place);
}

void require_scene(const Sweep& sweep, std::size_t scene) {
    const Request request = request_of(sweep, scene);
    validate(request.scene);
    resolve(request.scene, sweep.wavelength.numbers);
}

/// Names of everything that goes through Mie theory in a scene.
std::set<std::string> mie_jobs(const Sweep& sweep, std::size_t scene) {
    std::set<std::string> jobs;
    const ResolvedScene resolved =
        resolve(request_of(sweep, scene).scene, sweep.wavelength.numbers);
    const auto add = [&](const ResolvedMedium& medium) {
        for (const ResolvedSpecies& species : medium.species)
            jobs.insert(species.key.begin(), species.key.end());
    };
    for (const ResolvedMedium& medium : resolved.present_media()) add(medium);
    for (const ResolvedDepth& depth : resolved.depths) {
        if (depth.reference) add(*depth.reference);
    }
    return jobs;
}

/// Whether scenes along this dimension need other optics; where a scene cannot be looked up, they
/// are taken to.
bool is_optical(const Sweep& sweep, std::size_t dimension) {
    const std::size_t last = sweep.dimensions[dimension].size() - 1;
    try {
        const std::set<std::string> first = mie_jobs(sweep, 0);
        for (const std::size_t index : {std::min<std::size_t>(1, last), last}) {
            if (mie_jobs(sweep, neighbour(sweep, dimension, index)) != first) return true;
        }
        return false;
    } catch (const Error&) {
        return true;
    }
}

}  // namespace

std::size_t Sweep::scenes() const {
    std::size_t product = 1;
    for (const Dimension& dimension : dimensions) product *= dimension.size();
    return product;
}

std::size_t Sweep::scenes_per_group() const {
    std::size_t product = 1;
    for (std::size_t d = optical_dimensions; d < dimensions.size(); ++d)
        product *= dimensions[d].size();
    return product;
}

bool Sweep::wants(Output output) const {
    return std::find(outputs.begin(), outputs.end(), output) != outputs.end();
}

bool Sweep::wants_albedos() const {
    return std::any_of(outputs.begin(), outputs.end(), [](Output output) {
        return output != Output::brdf && output != Output::mueller && output != Output::hdrf;
    });
}

const Axis* Sweep::find_axis(const std::string& name) const {
    for (const Dimension& dimension : dimensions) {
        for (const Axis& axis : dimension.axes) {
            if (axis.name == name) return &axis;
        }
    }
    for (const Axis* axis : {&wavelength, &incidence, &reflection, &azimuth}) {
        if (axis->size() > 0 && axis->name == name) return axis;
    }
    return nullptr;
}

Directions Sweep::directions() const {
    return {cosines_of(incidence), cosines_of(reflection), azimuth.numbers};
}

const char* name_of(Output output) {
    switch (output) {
        case Output::brdf:
            return "brdf";
        case Output::plane_albedo:
            return "plane_albedo";
        case Output::spherical_albedo:
            return "spherical_albedo";
        case Output::plane_transmittance:
            return "plane_transmittance";
        case Output::spherical_transmittance:
            return "spherical_transmittance";
        case Output::colour:
            return "colour";
        case Output::contrast_ratio:
            return "contrast_ratio";
        case Output::mueller:
            return "mueller";
        case Output::hdrf:
            return "hdrf";
        case Output::emissivity:
            return "emissivity";
    }
    return "";
}

std::vector<std::size_t> place_of(const Sweep& sweep, std::size_t scene) {
    std::vector<std::size_t> place(sweep.dimensions.size());
    for (std::size_t d = place.size(); d-- > 0;) {
        place[d] = scene % sweep.dimensions[d].size();
        scene /= sweep.dimensions[d].size();
    }
    return place;
}

Request request_of(const Sweep& sweep, std::size_t scene) {
    const std::vector<std::size_t> place = place_of(sweep, scene);
    Request request;
    const auto word_of = [&](const std::string& axis) {
        const std::string word = word_at(sweep, place, axis);
        const bool is_named = std::find(sweep.derivatives.begin(), sweep.derivatives.end(), axis) !=
                              sweep.derivatives.end();
        return is_named ? fmt::format("{{{}={}}}", axis, word) : word;
    };
    for (const TemplateWord& word : sweep.words) apply(word, word_of, request, sweep.folder);
    return request;
}

void use_wavelengths(const std::vector<std::size_t>& places,
                     const std::function<void(const std::vector<std::size_t>&)>& use,
                     const std::function<void(std::size_t place, const Error&)>& refuse) {
    if (places.empty()) return;
    try {
        return use(places);
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& error) {
        if (places.size() == 1) return refuse(places.front(), error);
    }
    const auto middle = places.begin() + std::ptrdiff_t(places.size() / 2);
    use_wavelengths({places.begin(), middle}, use, refuse);
    use_wavelengths({middle, places.end()}, use, refuse);
}

std::vector<double> wavelengths_at(const Sweep& sweep, const std::vector<std::size_t>& places) {
    std::vector<double> wavelength_nm;
    wavelength_nm.reserve(places.size());
    for (const std::size_t place : places) wavelength_nm.push_back(sweep.wavelength.numbers[place]);
    return wavelength_nm;
}

std::string describe_wavelengths(const Sweep& sweep, const std::vector<std::size_t>& places) {
    constexpr std::size_t kNamed = 5;
    std::vector<double> some = wavelengths_at(sweep, places);
    some.resize(std::min(some.size(), kNamed));
    return places.size() > kNamed
               ? fmt::format("{}, ... nm ({} wavelengths)", fmt::join(some, ", "), places.size())
               : fmt::format("{} nm", fmt::join(some, ", "));
}

SceneLookUp look_up(const Sweep& sweep, std::size_t scene, NamedIndexMemo* memo) {
    SceneLookUp found;
    std::vector<std::size_t> all(sweep.wavelength.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    try {
        found.request = request_of(sweep, scene);
        validate(found.request.scene);
        require_transmittance(sweep, found.request);
    } catch (const Error& error) {
        found.refusals.push_back({all, error.what()});
        return found;
    }
    const auto refuse = [&](std::size_t place, const Error& error) {
        if (found.refusals.empty() || found.refusals.back().reason != error.what())
            found.refusals.push_back({{}, error.what()});
        found.refusals.back().wavelengths.push_back(place);
    };
    use_wavelengths(
        all,
        [&](const std::vector<std::size_t>& places) {
            found.parts.push_back(
                resolve(found.request.scene, wavelengths_at(sweep, places), memo));
            for (std::size_t w = 0; w < places.size(); ++w) {
                try {
                    require_computable(found.parts.back(), found.request.solver, w);
                    found.wavelengths.push_back(places[w]);
                } catch (const Error& error) {
                    refuse(places[w], error);
                }
            }
        },
        refuse);
    return found;
}

void order_for_sharing(Sweep& sweep) {
    std::vector<Dimension> optical, others;
    for (std::size_t d = 0; d < sweep.dimensions.size(); ++d)
        (is_optical(sweep, d) ? optical : others).push_back(sweep.dimensions[d]);
    sweep.optical_dimensions = optical.size();
    sweep.dimensions = std::move(optical);
    sweep.dimensions.insert(sweep.dimensions.end(), others.begin(), others.end());
}

void check_names(const Sweep& sweep) {
    std::exception_ptr reason;
    try {
        require_scene(sweep, 0);
    } catch (const Error&) {
        reason = std::current_exception();
    }
    for (std::size_t d = 0; d < sweep.dimensions.size(); ++d) {
        const Dimension& dimension = sweep.dimensions[d];
        const bool has_text = std::any_of(dimension.axes.begin(), dimension.axes.end(),
                                          [](const Axis& axis) { return axis.is_text(); });
        // Numbers along one dimension fail together or at an end.
        std::vector<std::size_t> tried = {dimension.size() - 1};
        for (std::size_t i = 0; has_text && i + 1 < dimension.size(); ++i) tried.push_back(i);
        for (const std::size_t index : tried) {
            try {
                require_scene(sweep, neighbour(sweep, d, index));
                reason = nullptr;
            } catch (const Error&) {
                if (has_text) throw;
            }
        }
    }
    if (reason) std::rethrow_exception(reason);
}

}  // namespace miebrdf::sweep
