// The average over sizes in pieces, so that a caller with threads can share it out.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mie/angular_functions.h"
#include "mie/band_covariance.h"
#include "mie/ensemble.h"
#include "mie/phase_tabulation.h"
#include "mie/size_nodes.h"
#include "mie/sphere_block.h"

namespace miebrdf::mie {

/// What the sizes of one pass, or of a part of it, sum to.
struct EnsembleSums {
    SphereSums spheres;
    BandCovariance covariance;  ///< empty without moments
    Eigen::MatrixXd intensity;  ///< at the angles asked for, by halves of the sizes
    PhaseHalves table;          ///< of the passes that build the phase table

    void add(const EnsembleSums& other);
    void scale(double factor);
};

/// average_over_sizes, one pass of size nodes after the other; each pass falls into chunks that may
/// be computed at the same time. Chunks do not depend on the number of threads and are merged in
/// their order, so the result is the same to the last bit:
///
///     EnsembleAverage average(request);
///     do {
///         std::vector<EnsembleSums> sums(average.chunk_count());
///         for (int i = 0; i < average.chunk_count(); ++i) sums[i] = average.compute(i);  // in any
///         order for (const auto& s : sums) average.merge(s);                                   //
///         in this order
///     } while (average.finish_pass());
///     return average.optics();
class EnsembleAverage {
  public:
    /// @throws std::invalid_argument  as average_over_sizes
    explicit EnsembleAverage(const EnsembleRequest& request);

    int chunk_count() const;
    /// Sums over one chunk of the current pass; safe to call from several threads.
    EnsembleSums compute(int chunk) const;
    void merge(const EnsembleSums& chunk);
    /// Ends the pass: true if another one is needed.
    bool finish_pass();
    const EnsembleOptics& optics() const { return optics_; }

  private:
    enum class Rule { single, smooth, even };

    double size_parameter(double radius_um) const;
    Rule first_rule() const;
    void start_even_rule();
    void set_nodes(SizeNodes nodes);
    void refine();
    EnsembleOptics optics_of(const EnsembleSums& sums) const;
    double ripple_period() const;
    void estimate_errors(const EnsembleOptics& before);
    void put_exact_extinction();
    int band_width() const;
    bool wants_table() const { return request_.with_phase_table || moments_from_table_; }
    void start_tabulation();
    void finish_tabulation();

    EnsembleRequest request_;
    std::complex<double> relative_index_;
    RadiusRange range_;
    int terms_ = 0;
    AngularFunctions angular_;
    Rule rule_ = Rule::single;
    SizeNodes nodes_;  // of the current pass
    std::vector<double> parameters_, weights_;
    int pass_ = 0;                    // of the current rule
    int even_count_ = 0;              // grid of the current pass of the even rule
    EnsembleSums pass_sums_, total_;  // total: all passes so far
    double change_before_ = 0;
    bool moments_from_table_ = false;
    std::optional<PhaseTabulation> tabulation_;  // after the averages, when asked for
    double exact_q_ext_ = 0;                     // of the even rule
    EnsembleOptics optics_;
};

}  // namespace miebrdf::mie
