// Pass after pass of more sizes, until an average is good enough.
#pragma once

#include <complex>

#include "mie/sizes/size_nodes.h"

namespace miebrdf::mie {

/// Most sizes of one average; transparent spheres stop near 1e-6 there.
constexpr int node_limit = 1 << 16;

/// Distance in x after which the ripple of a transparent sphere repeats, atan(s)/s with
/// s^2 = n^2 - 1 (Chylek 1990, J. Opt. Soc. Am. A 7, 1609, eq. 1); 1 where there is none.
double ripple_period(double index);

/// Number of sizes of the coarsest even grid: 3.4 periods apart, so that its refinements are 1.7,
/// 0.85, 0.425 ... periods apart. A spacing just below a multiple of the period sees the same
/// resonances again and again; 0.85 times a power of two does not, and with 0.85 itself the error
/// drops about tenfold (docs/maths-mie.md).
/// @param width  largest minus smallest size parameter
int coarsest_even_count(double index, double width);

/// The sizes of one pass after the other.
class SizeRefinement {
  public:
    /// single: one size. smooth: Gauss nodes in ln r, each pass instead of the last. even: equally
    /// spaced, each pass between the sizes of all passes before.
    enum class Rule { single, smooth, even };

    SizeRefinement(const SizeDistribution& distribution, const RadiusRange& range,
                   std::complex<double> relative_index, double wave_number_per_um);

    Rule rule() const { return rule_; }
    int pass() const { return pass_; }  ///< of the current rule, from 0
    const SizeNodes& nodes() const { return nodes_; }
    /// The mean of this pass and of all before it is better than this pass.
    bool adds_to_passes_before() const { return rule_ == Rule::even && pass_ > 0; }
    int nodes_so_far() const { return nodes_so_far_; }
    int even_count() const { return even_count_; }  ///< of the current pass of the even rule

    /// Next pass; false when there are no more.
    bool refine();

  private:
    void take(SizeNodes nodes);
    void start_even();

    SizeDistribution distribution_;
    RadiusRange range_;
    double index_, width_;
    Rule rule_;
    SizeNodes nodes_;
    int pass_ = 0, nodes_so_far_ = 0, first_count_ = 0, even_count_ = 0;
};

}  // namespace miebrdf::mie
