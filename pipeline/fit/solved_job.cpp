#include "pipeline/fit/solved_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>

#include <miebrdf/colour.h>
#include <miebrdf/error.h>
#include <miebrdf/value_derivatives.h>
#include "pipeline/fit/derived.h"
#include "pipeline/fit/problem.h"

namespace miebrdf::fitting {
namespace {

/// A colour, or what a sphere reads, is differentiated along the derivative of what it is made of
/// by a step of this share: half the digits of a smooth formula.
constexpr double kSlopeStep = 1e-5;

std::vector<double> spectrum_at(const AlbedoValues& values, std::size_t in) {
    std::vector<double> spectrum;
    for (const std::vector<double>& at : values.plane_albedo) spectrum.push_back(at[in]);
    return spectrum;
}

double of_lab(MeasuredQuantity quantity, const Lab& lab) {
    if (quantity == MeasuredQuantity::lab_l) return lab.l;
    return quantity == MeasuredQuantity::lab_a ? lab.a : lab.b;
}

double albedo_value(const AlbedoValues& values, MeasuredQuantity quantity,
                    MeasuredGeometry geometry, std::size_t w, std::size_t in) {
    const bool from_all_sides = geometry == MeasuredGeometry::hemispherical;
    if (quantity == MeasuredQuantity::transmittance) {
        if (values.plane_transmittance.empty())
            throw UsageError("a transmittance needs layers on a substrate: none, black, lambert:A");
        if (geometry == MeasuredGeometry::unscattered)
            return values.unscattered_transmittance[w][in];
        return from_all_sides ? values.spherical_transmittance[w]
                              : values.plane_transmittance[w][in];
    }
    if (from_all_sides) return values.spherical_albedo[w];
    const double albedo = values.plane_albedo[w][in];
    const bool has_mirror = !values.mirror_reflectance.empty();
    return geometry == MeasuredGeometry::d8_sce && has_mirror
               ? albedo - values.mirror_reflectance[w][in]
               : albedo;
}

/// What a sphere sees of a sample.
SlabLight slab_light(const AlbedoValues& values, std::size_t w, std::size_t in) {
    const bool passes = !values.plane_transmittance.empty();
    const bool mirrors = !values.mirror_reflectance.empty();
    return {.r_direct = values.plane_albedo[w][in],
            .t_direct = passes ? values.plane_transmittance[w][in] : 0.0,
            .r_unscattered = mirrors ? values.mirror_reflectance[w][in] : 0.0,
            .t_unscattered = passes ? values.unscattered_transmittance[w][in] : 0.0,
            .r_diffuse = values.spherical_albedo[w],
            .t_diffuse = passes ? values.spherical_transmittance[w] : 0.0};
}

void take_off(const LostLight& lost, SlabLight& light) {
    light.r_direct -= lost.r_direct;
    light.t_direct -= lost.t_direct;
    light.r_diffuse -= lost.r_diffuse;
    light.t_diffuse -= lost.t_diffuse;
}

/// The values of a job, one kind of them after the other.
class JobSolver {
  public:
    JobSolver(const Job& job, const Request& request, const Control& control,
              const std::vector<std::string>& names)
        : job_(job),
          request_(request),
          names_(names),
          brdf_(solve(request.scene, job.wavelength_nm, request.solver, control)) {}

    SolvedJob solved() {
        switch (job_.kind) {
            case Kind::albedo:
                add_albedos();
                break;
            case Kind::lab:
                add_colours();
                break;
            case Kind::brdf:
            case Kind::hdrf:
                add_reflectances();
                break;
        }
        return std::move(solved_);
    }

  private:
    /// Of the values and of each derivative alike.
    template <typename Values, typename ValueIn>
    void fill(const WithDerivatives<Values>& with, const ValueIn& value_in) {
        const auto column = [&](const Values& values) {
            std::vector<double> all;
            for (const Job::Use& use : job_.uses) all.push_back(value_in(values, use));
            return all;
        };
        solved_.values = column(with.values);
        for (const Values& derivative : with.derivatives)
            solved_.derivatives.push_back(column(derivative));
        count_effort(with.values);
    }

    void count_effort(const ResultReport& report) {
        for (const WavelengthReport& at : report.wavelengths) {
            solved_.streams = std::max(solved_.streams, at.solver.streams);
            solved_.components = std::max(solved_.components, at.stokes);
        }
    }

    WithDerivatives<AlbedoValues> albedo(const std::vector<double>& mu_in) const {
        return names_.empty() ? WithDerivatives<AlbedoValues>{brdf_.albedo(mu_in), {}, {}}
                              : brdf_.derivatives(names_).albedo(mu_in);
    }

    void add_albedos() {
        const auto with = albedo(job_.directions.mu_in);
        fill(with, [&](const AlbedoValues& values, const Job::Use& use) {
            const double value =
                albedo_value(values, use.quantity, use.geometry, use.wavelength, use.in);
            if (use.of_spheres == nullptr) return value;
            const double nm = job_.wavelength_nm[use.wavelength];
            const SphereMeasurement spheres = use.of_spheres->spheres->at(nm);
            const SlabLight slope = slab_light(values, use.wavelength, use.in);
            SlabLight light = slab_light(with.values, use.wavelength, use.in);
            take_off(use.lost, light);
            const auto reading = [&](double step) {
                SlabLight at = light;
                for (const auto part :
                     {&SlabLight::r_direct, &SlabLight::t_direct, &SlabLight::r_unscattered,
                      &SlabLight::t_unscattered, &SlabLight::r_diffuse, &SlabLight::t_diffuse})
                    at.*part += step * slope.*part;
                return sphere_reading(spheres, use.quantity == MeasuredQuantity::transmittance, at);
            };
            if (&values == &with.values) return reading(0.0);
            const double largest = std::max(std::abs(slope.r_direct), std::abs(slope.t_direct));
            if (largest == 0.0) return 0.0;
            const double step = kSlopeStep / largest;
            return (reading(step) - reading(-step)) / (2.0 * step);
        });
    }

    void add_colours() {
        const Colorimeter colorimeter(job_.wavelength_nm, job_.viewing);
        const auto with = albedo(job_.directions.mu_in);
        fill(with, [&](const AlbedoValues& values, const Job::Use& use) {
            std::vector<double> spectrum = spectrum_at(with.values, use.in);
            if (&values == &with.values) return of_lab(use.quantity, colorimeter(spectrum).lab);
            const std::vector<double> slope = spectrum_at(values, use.in);
            const auto moved = [&](double step) {
                std::vector<double> at = spectrum;
                for (std::size_t w = 0; w < at.size(); ++w) at[w] += step * slope[w];
                return of_lab(use.quantity, colorimeter(at).lab);
            };
            double largest = 0.0;
            for (const double each : slope) largest = std::max(largest, std::abs(each));
            if (largest == 0.0) return 0.0;
            const double step = kSlopeStep / largest;
            return (moved(step) - moved(-step)) / (2.0 * step);
        });
    }

    void add_reflectances() {
        const double share = job_.kind == Kind::hdrf ? job_.diffuse_fraction : 0.0;
        if (share > 0.0 && !job_.is_scattered()) {
            const auto with = hdrf_derivatives(brdf_, names_, job_.directions, share, job_.sky);
            const std::size_t outs = job_.directions.mu_out.size(),
                              azimuths = job_.directions.azimuth_deg.size();
            fill(with, [&](const HdrfValues& values, const Job::Use& use) {
                return values
                    .hdrf[use.wavelength][(use.in * outs + use.out) * azimuths + use.azimuth];
            });
            return;
        }
        std::optional<AlbedoValues> sky;
        if (share > 0.0) {
            if (request_.scene.surface) brdf_.hdrf({{1.0}, {1.0}, {0.0}}, share);  // may refuse it
            sky = brdf_.albedo(job_.directions.mu_out);
        }
        const auto in_unit_of = [&](const Job::Use& use, double f) {
            if (use.quantity == MeasuredQuantity::brdf) return f;
            const double factor = std::numbers::pi * f;
            if (!sky) return factor;
            return (1.0 - share) * factor + share * sky->plane_albedo[use.wavelength][use.out];
        };
        if (job_.is_scattered()) {
            const BrdfTable table = brdf_.table();
            const std::size_t stride = job_.wavelength_nm.size();
            std::vector<double> values(job_.points.size() * stride);
            table.evaluate(job_.points, values);
            for (const Job::Use& use : job_.uses)
                solved_.values.push_back(
                    in_unit_of(use, values[use.point * stride + use.wavelength]));
            count_effort(table.report());
            return;
        }
        const BrdfParts whole{.subsurface = false, .surface = false, .total = true};
        const auto sun =
            names_.empty()
                ? WithDerivatives<BrdfValues>{brdf_.evaluate(job_.directions, whole), {}, {}}
                : brdf_.derivatives(names_).evaluate(job_.directions, whole);
        fill(sun, [&](const BrdfValues& values, const Job::Use& use) {
            return in_unit_of(use, values.at(use.wavelength, use.in, use.out, use.azimuth));
        });
    }

    const Job& job_;
    const Request& request_;
    const std::vector<std::string>& names_;
    Brdf brdf_;
    SolvedJob solved_;
};

}  // namespace

Request request_of(const FitProblem& problem, const std::vector<Slot>& slots, const Job& job,
                   std::span<const double> numbers, const std::vector<std::string>& names) {
    const auto number_of = [&](const std::string& name) {
        return numbers[slot_of(problem, slots, name, job.only_wavelength.value_or(0))];
    };
    const auto text_of = [&](const std::string& name) {
        if (const DerivedNumber* derived = find_derived(problem, name))
            return fmt::format("{}",
                               derived_number(*derived, job.wavelength_nm.front(), number_of));
        const double number = number_of(name);
        const bool is_named = std::find(names.begin(), names.end(), name) != names.end();
        return is_named ? fmt::format("{{{}={}}}", name, number) : fmt::format("{}", number);
    };
    Request request;
    request.solver.tolerance = tolerance_of(problem);
    for (const TemplateWord& word : job.words) apply(word, text_of, request);
    if (request.solver.streams == 0) request.solver.streams = job.streams;
    if (request.solver.stokes == 0 && job.takes_intensity_alone) request.solver.stokes = 1;
    return request;
}

double trace_lost_light(Job& job, const Request& request, const Control& control) {
    std::optional<Brdf> brdf;
    std::map<std::tuple<const FitData*, bool, std::size_t>, std::vector<LostLight>> traced;
    double change = 0.0;
    for (Job::Use& use : job.uses) {
        if (use.of_spheres == nullptr || !use.of_spheres->spheres->lost_light) continue;
        const SphereMeasurement& spheres = *use.of_spheres->spheres;
        const bool below = use.quantity == MeasuredQuantity::transmittance;
        const double port = spheres.above.sample_port_mm, other = spheres.below.sample_port_mm;
        if (!brdf) brdf = solve(request.scene, job.wavelength_nm, request.solver, control);
        std::vector<LostLight>& of_data = traced[{use.of_spheres, below, use.in}];
        if (of_data.empty())
            of_data = lost_light(*brdf, job.directions.mu_in[use.in],
                                 {.beam_mm = spheres.beam_mm,
                                  .above_mm = port,
                                  .below_mm = other,
                                  .flooded_mm = spheres.spheres == 0            ? 0.0
                                                : below && spheres.spheres == 1 ? other
                                                                                : port},
                                 control);
        const LostLight& lost = of_data[use.wavelength];
        for (const auto part : {&LostLight::r_direct, &LostLight::t_direct, &LostLight::r_diffuse,
                                &LostLight::t_diffuse})
            change = std::max(change, std::abs(lost.*part - use.lost.*part));
        use.lost = lost;
    }
    return change;
}

SolvedJob solve_job(const Job& job, const Request& request, const Control& control,
                    const std::vector<std::string>& names) {
    return JobSolver(job, request, control, names).solved();
}

}  // namespace miebrdf::fitting
