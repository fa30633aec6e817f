// Puts the rules to one request, step by step.
#pragma once

#include <miebrdf/plan.h>

#include <string>
#include <vector>

#include "pipeline/plan/cost_model.h"
#include "pipeline/solve/distinct_directions.h"
#include "pipeline/solve/layers.h"

namespace miebrdf {

/// "1 coat", "3 coats": how plans count.
std::string counted(std::size_t count, const std::string& thing);

class Planner {
  public:
    /// @param quantity  what is wanted of the layers
    Planner(const Brdf& brdf, const Directions& directions, const BrdfParts& parts,
            LayerQuantity quantity, EarlierWork& earlier);
    Plan plan();

  private:
    /// Wavelengths that need work, each job once.
    void list_jobs();
    void leave_out_layer(const Layer& layer);
    /// Removes what lies below a layer that hides it, as far as that is known before computing.
    void hide_layers();
    void single_scattering();
    void leave_out_phase_functions(const std::vector<const ResolvedSpecies*>& computed);

    void radiative_transfer();  ///< plan_transfer.cpp
    void polarisation();
    void leave_out_orders();
    void leave_out_solutions();
    void boundary();
    void surface();

    bool is_albedo() const { return request_.quantity != LayerQuantity::reflection; }
    double jobs() const { return static_cast<double>(jobs_.size()); }
    /// Media that show: lowest_, ..., the uppermost.
    std::size_t layers() const { return scene_.media.size() - lowest_; }
    bool shows_substrate() const { return scene_.substrate && lowest_ == scene_.first_medium(); }
    std::size_t coats() const { return layers() - (shows_substrate() ? 0 : 1); }
    std::size_t cosines() const;
    /// Fourier orders of one solution under the rules, and without them.
    int orders() const;
    int all_orders() const;

    /// Memory that results and single scattering take.
    double memory_bytes() const;

    double mie_cost(std::size_t medium, std::size_t w) const;
    double mie_cost(const ResolvedSpecies& species, std::size_t w, bool whole) const;
    /// The cost for particles as the scene has them where a medium says nothing.
    double typical_mie_cost(std::size_t w) const;
    /// demand_, with scattering matrices where they are needed.
    OpticsDemand demand_at(std::size_t w) const;
    double mie_cost(std::size_t medium) const;  ///< at all the jobs' wavelengths
    /// Mie theory for all the layers at the first wavelength, each different medium once.
    double scene_mie_cost() const;
    double transfer_cost(int orders, std::size_t layers) const;

    void leave_out(const std::string& rule, const std::string& reason, double saved_s);

    const ResolvedScene& scene_;
    SolverOptions solver_;
    BrdfParts parts_;
    std::shared_ptr<ResultCache> cache_;
    EarlierWork& earlier_;
    DistinctDirections distinct_;
    LayerRequest request_;  ///< without repeated directions
    OpticsDemand demand_;
    bool needs_layers_ = true;
    std::size_t lowest_;  ///< index of the lowest medium that shows
    TransferSize size_;
    std::vector<LayerJob> jobs_;  ///< that need work
    Plan plan_;
};

}  // namespace miebrdf
