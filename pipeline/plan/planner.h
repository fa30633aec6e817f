// Puts the rules to one request, step by step; plan.h is what comes of it.
#pragma once

#include <string>
#include <vector>

#include "pipeline/plan/plan.h"
#include "pipeline/solve/distinct_directions.h"
#include "pipeline/solve/layer_jobs.h"
#include "pipeline/solve/scene_optics.h"

namespace miebrdf {

class Planner {
  public:
    Planner(const Request& request, LayerQuantity quantity, ResultCache* cache,
            EarlierWork& earlier);
    Plan plan();

  private:
    /// Wavelengths that need work, each job once (planner.cpp).
    void list_jobs();
    void leave_out_coat(const CoatMedium& coat);
    /// Removes what lies below a coat that hides it, as far as that is known before computing.
    void hide_layers();

    void single_scattering();  ///< plan_single_scattering.cpp
    void leave_out_phase_functions(double saved_s);
    /// What phase functions at every angle add to Mie theory for a medium.
    double phase_function_cost(const Medium& medium) const;

    void radiative_transfer();  ///< plan_transfer.cpp
    void leave_out_orders();
    void leave_out_layers();
    void surface();

    bool is_albedo() const { return quantity_ != LayerQuantity::reflection; }
    double jobs() const { return static_cast<double>(jobs_nm_.size()); }
    std::size_t layers() const { return 1 + visible_.coats.size(); }
    std::size_t cosines() const;
    /// Orders of one solution under the rules, and without them.
    int orders() const;
    int all_orders() const;

    double mie_cost(const Medium& medium, double wavelength_nm) const;
    double mie_cost(const Medium& medium) const;  ///< at all the jobs' wavelengths
    /// Mie theory for all the layers at the first wavelength, each different medium once.
    double scene_mie_cost() const;
    double transfer_cost(int orders, std::size_t layers) const;

    void leave_out(const std::string& rule, const std::string& reason, double saved_s);

    const Request& request_;
    LayerQuantity quantity_;
    ResultCache* cache_;
    EarlierWork& earlier_;
    SceneMedia media_;
    DistinctDirections distinct_;
    Request reduced_;  ///< without repeated directions and coats of no depth
    bool whole_phase_ = false;
    bool needs_layers_ = true;
    int streams_ = 0;
    Scene visible_;
    std::vector<LayerJob> jobs_;  ///< that need work
    std::vector<double> jobs_nm_;
    Plan plan_;
};

}  // namespace miebrdf
