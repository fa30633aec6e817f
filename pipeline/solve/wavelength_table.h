// A scene at one wavelength, solved once and then evaluated at any directions: the parts of a
// BrdfTable.
#pragma once

#include <miebrdf/brdf.h>

#include <optional>
#include <vector>

#include <miebrdf/surface.h>
#include "pipeline/solve/first_order.h"
#include "pipeline/solve/mueller_part.h"
#include "pipeline/solve/polarisation.h"
#include "pipeline/solve/scene_optics.h"
#include "pipeline/solve/smooth_part.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf {

/// Directions of all kinds: where streams and moments of a BRDF are chosen that is solved once and
/// then asked anywhere, and where its error is estimated. Directions at the very horizon would ask
/// for many more streams.
const Directions& probe_directions();

/// Light scattered more than once is smooth and comes from a table (SmoothPart). What has sharp
/// features, the first order of scattering (FirstOrder) and the surface lobe, is evaluated exactly
/// at every direction. The BRDF is the sum of all.
class WavelengthTable {
  public:
    /// @param optics  the visible layers; not looked at for BrdfPart::surface
    /// @param w       index of the wavelength
    /// @param light   its components: of several, the BRDF is element 11 of the Mueller matrix
    /// @param whole_matrix  the other elements are wanted too
    WavelengthTable(const ResolvedScene& scene, std::size_t w, const SceneOptics& optics,
                    const SolverOptions& solver, BrdfPart part, const LightChoice& light,
                    bool whole_matrix);

    /// The surface's transmission included.
    const SmoothPart& smooth() const { return smooth_; }
    /// What scatters light once, without the surface; empty for the surface alone.
    const std::vector<rte::ScaledMedium>& media() const { return stack_.media; }
    const rte::ScaledStack& stack() const { return stack_; }
    /// Of polarised light: the media as light scattered once sees them (media_of_first_order);
    /// otherwise empty.
    const std::vector<rte::Optics>& seen_once() const { return seen_once_; }
    /// Whether light scattered once needs more than the media: boundaries, mirrors.
    bool has_optical_steps() const { return stack_.refracts() || stack_.has_mirrors(); }

    /// The surface lobe's BRDF; 0 without one.
    double lobe(const Direction& direction) const;
    /// What the surface lets through of light from below; 1 without one.
    double transmitted(double mu_in, double mu_out) const;
    /// By which a rough boundary's lobe of one facet is raised at a cosine.
    double lobe_scale(double mu) const;
    bool has_surface() const { return lobe_.has_value(); }

    const WavelengthReport& report() const { return report_; }
    /// Null: only the BRDF is known.
    const MuellerPart* mueller() const { return mueller_ ? &*mueller_ : nullptr; }

  private:
    void solve(const SceneOptics& optics, const SolverOptions& solver, int components,
               bool whole_matrix);

    rte::ScaledStack stack_;
    std::vector<rte::Optics> seen_once_;
    SmoothPart smooth_;
    std::optional<MuellerPart> mueller_;
    std::optional<rte::SurfaceLobe> lobe_;
    std::vector<double> lobe_scale_;              ///< of a rough boundary, at the nodes
    std::vector<double> factor_in_, factor_out_;  ///< of the surface, at the nodes
    WavelengthReport report_;
};

/// Memory of one evaluation that the next one can use.
struct EvaluationScratch {
    std::vector<double> cos_azimuth, sharp, series;
    FirstOrder::Scratch first_order;
};

/// The first order of scattering, as far as a surface lets it through, and the surface lobe, of
/// some wavelengths.
class SharpPart {
  public:
    /// Wavelengths that share their tables: few enough that parts can be made in parallel.
    static constexpr std::size_t kMostWavelengths = 16;

    /// @param tables  at most kMostWavelengths; must outlive this
    SharpPart(std::span<const WavelengthTable> tables, const SolverOptions& solver);

    std::size_t wavelengths() const { return tables_.size(); }
    const WavelengthTable& table(std::size_t w) const { return tables_[w]; }

    /// BRDF at directions that share their cosines (set_cosines): values[d * wavelengths() + w].
    void evaluate(std::span<const Direction> directions, std::span<double> values,
                  EvaluationScratch& scratch) const;

    /// R of light scattered once at one wavelength with boundaries or mirrors; none below a rough
    /// boundary, which lets no beam through.
    void scattered_once(std::size_t w, double mu_in, double mu_out,
                        std::span<const double> cos_azimuth, std::span<double> reflection,
                        FirstOrder::Scratch& scratch) const;

  private:
    std::span<const WavelengthTable> tables_;
    /// Of all wavelengths together, or one for each where boundaries bend light by wavelength.
    std::vector<FirstOrder> first_order_;
};

/// Sets scratch.cos_azimuth, which the following two need, for directions that share their cosines.
void set_cosines(std::span<const Direction> directions, EvaluationScratch& scratch);

/// Adds smooth parts to values of the BRDF at directions that share their cosines.
class SmoothSum {
  public:
    explicit SmoothSum(const Direction& first)
        : in_(first.mu_in), out_(first.mu_out), mu_sum_(first.mu_in + first.mu_out) {}

    /// @param values  values[d * stride] for direction d
    void add(const SmoothPart& smooth, double* values, std::size_t stride,
             EvaluationScratch& scratch) const;

  private:
    NodeStencil in_, out_;
    double mu_sum_;
};

/// What a BrdfTable holds.
struct BrdfTable::State {
    ResolvedScene scene;
    SolverOptions solver;
    BrdfPart part = BrdfPart::total;
    std::vector<std::string> channels;
    Provenance provenance;
    std::vector<WavelengthTable> tables;
    std::vector<SharpPart> sharp;  ///< of the tables in their order, some at a time
    int components = 1;            ///< of the Mueller matrices that are known; 1: none
    ResultReport report;
};

}  // namespace miebrdf
