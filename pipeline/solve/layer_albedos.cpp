// Many layers of analytic media in one call.
#include <miebrdf/layer_albedos.h>

#include <fmt/format.h>
#include <miebrdf/error.h>
#include <miebrdf/optics.h>
#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "pipeline/solve/parallel.h"
#include "rte/stack/layered_reflection.h"

namespace miebrdf {
namespace {

/// Layers that one thread takes at a time.
constexpr std::size_t kBlock = 64;

struct BatchField {
    const char* name;
    std::span<const double> values;
    bool (*is_allowed)(double);
    const char* allowed;

    double at(std::size_t layer) const { return values[values.size() == 1 ? 0 : layer]; }
};

using BatchFields = std::array<BatchField, 5>;
enum BatchColumn { kAlbedo, kAsymmetry, kDepth, kIndex, kGround };

BatchFields fields_of(const LayerBatch& layers) {
    const auto share = [](double x) { return x >= 0.0 && x <= 1.0; };
    return {
        {{"single_scattering_albedo", layers.single_scattering_albedo, share, "[0, 1]"},
         {"asymmetry", layers.asymmetry, [](double x) { return std::abs(x) < 1.0; }, "(-1, 1)"},
         {"optical_depth", layers.optical_depth, [](double x) { return x >= 0.0; },
          ">= 0; infinite: a half-space"},
         {"host_index", layers.host_index, [](double x) { return x >= 1.0 && x <= 3.0; }, "[1, 3]"},
         {"ground_albedo", layers.ground_albedo, share, "[0, 1]"}}};
}

/// @throws UsageError  where lists do not fit, or a value is out of range
std::size_t count_layers(const BatchFields& fields) {
    std::size_t count = 1;
    for (const BatchField& field : fields) {
        if (field.values.size() == 1) continue;
        if (count != 1 && field.values.size() != count) {
            throw UsageError(
                fmt::format("{}: {} values, where another list has {}; allowed: one for each "
                            "layer, or one for all",
                            field.name, field.values.size(), count));
        }
        count = field.values.size();
        if (count == 0) break;
    }
    for (const BatchField& field : fields) {
        const auto bad =
            std::find_if_not(field.values.begin(), field.values.end(), field.is_allowed);
        if (bad == field.values.end()) continue;
        throw UsageError(fmt::format("{}[{}]", field.name, bad - field.values.begin()), *bad,
                         field.allowed);
    }
    return count;
}

/// One thread's layers, one after the other: moments are kept as long as g stays.
class LayerSolver {
  public:
    LayerSolver(const BatchFields& fields, std::span<const double> mu_in,
                const rte::SolverOptions& options)
        : fields_(fields), mu_in_(mu_in.begin(), mu_in.end()), options_(options) {}

    void solve(std::size_t layer, LayerAlbedos& all) {
        rte::albedo(stack_of(layer), mu_in_, options_, {}, memory_, table_);
        const auto first = std::ptrdiff_t(layer * mu_in_.size());
        std::copy(table_.plane_albedo.begin(), table_.plane_albedo.end(),
                  all.plane_albedo.begin() + first);
        if (!table_.transmittance.empty()) {
            std::copy_n(table_.transmittance.begin(), mu_in_.size(),
                        all.plane_transmittance.begin() + first);
        }
        all.spherical_albedo[layer] = table_.spherical_albedo;
        all.error_estimate[layer] = table_.report.error_estimate;
        all.converged[layer] = table_.report.converged ? 1 : 0;
    }

  private:
    const rte::Stack& stack_of(std::size_t layer) {
        const double g = fields_[kAsymmetry].at(layer), albedo = fields_[kAlbedo].at(layer);
        if (asymmetry_ != g) {
            medium_ = rte::henyey_greenstein_optics(albedo, g);
            medium_.phase = nullptr;  // no light scattered once is wanted
            asymmetry_ = g;
        }
        medium_.single_scattering_albedo = albedo;
        medium_.one_minus_albedo = 1.0 - albedo;
        const double depth = fields_[kDepth].at(layer), index = fields_[kIndex].at(layer);
        rte::Stack& stack = std::isinf(depth) ? half_space_ : on_ground_;
        stack.base_index = index;
        stack.boundary = index == 1.0 ? std::optional<rte::Boundary>{} : rte::Boundary{};
        if (std::isinf(depth)) {
            stack.base = medium_;
        } else {
            stack.ground_albedo = fields_[kGround].at(layer);
            rte::Coat& coat = stack.coats.front();
            coat.optics = medium_;
            coat.optical_depth = depth;
            coat.index = index;
        }
        return stack;
    }

    const BatchFields& fields_;
    std::vector<double> mu_in_;
    rte::SolverOptions options_;
    std::optional<double> asymmetry_;
    rte::Optics medium_;
    rte::Stack half_space_;
    rte::Stack on_ground_{.coats = {rte::Coat{}}, .base_kind = rte::BaseKind::lambertian};
    rte::SolutionMemory memory_;
    rte::AlbedoTable table_;
};

}  // namespace

LayerAlbedos layer_albedos(const LayerBatch& layers, const rte::SolverOptions& options,
                           const Control& control) {
    const BatchFields fields = fields_of(layers);
    const std::size_t count = count_layers(fields);
    rte::validate(options);
    rte::validate(rte::Directions{{layers.mu_in.begin(), layers.mu_in.end()}, {}, {}});
    LayerAlbedos all;
    all.plane_albedo.resize(count * layers.mu_in.size());
    all.plane_transmittance.resize(all.plane_albedo.size());
    all.spherical_albedo.resize(count);
    all.error_estimate.resize(count);
    all.converged.resize(count);
    tbb::enumerable_thread_specific<LayerSolver> solvers(
        [&] { return LayerSolver(fields, layers.mu_in, options); });
    run_parallel("layers", (count + kBlock - 1) / kBlock, control, [&](std::size_t block) {
        LayerSolver& solver = solvers.local();
        const std::size_t end = std::min(count, (block + 1) * kBlock);
        for (std::size_t layer = block * kBlock; layer < end; ++layer) solver.solve(layer, all);
    });
    return all;
}

}  // namespace miebrdf
