// Averages over sizes by passes of more and more of them.
#pragma once

#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/size_sums.h"
#include "mie/sizes/size_nodes.h"

namespace miebrdf::mie {

/// Which sizes are computed, pass after pass, what they sum to, and how far the sums may be
/// trusted.
class SizePasses {
  public:
    /// single: one size. smooth: Gauss nodes in ln r, each pass instead of the last. even: equally
    /// spaced sizes, each pass between the sizes of all passes before.
    enum class Rule { single, smooth, even };

    /// @param ensemble  must outlive this
    explicit SizePasses(const Ensemble& ensemble);

    Rule rule() const { return rule_; }
    int sizes_so_far() const { return sizes_so_far_; }
    /// So many there will be, before the first pass, when an error is known.
    int sizes_of_first_estimate() const {
        return rule_ == Rule::single ? 1 : sizes_so_far_ << (rule_ == Rule::even ? 2 : 1);
    }

    /// Sums over the sizes of the present pass, together with those of the passes before.
    const SizeSums& add(const SizeSumOptions& options, const Executor& run);
    /// Goes to the next pass; false when there are no more.
    bool refine();

    /// q_ext of ensembles with ripple by exact_extinction(), after the first pass; 0: not known.
    double exact_q_ext() const { return exact_q_ext_; }

    /// The error of the averages after a pass, relative.
    /// @param change         by this pass, of all that counts
    /// @param missed         what extinction differs from the exact one, where that is known
    /// @param share          of the change that is believed to be left, where there is ripple
    /// @param lasting        part of the error that two levels of ripple may agree about by chance:
    ///                       it is not believed to fall by more than half
    /// @param least          no estimate is below this
    double error(double change, double missed, double share, double lasting, double least);
    /// The part of the last change of any average that is expected to be left as its error.
    double share_left() const { return share_left_; }
    bool is_first() const { return pass_ == 0; }
    /// Whether the next pass would be the first by the even rule, after Gauss rules.
    bool ends_smooth() const;

  private:
    /// Passes of the even rule before an error is known.
    static constexpr int kFewestEven = 3;
    void take(SizeNodes nodes);
    void start_even();

    const Ensemble& ensemble_;
    Rule rule_;
    SizeNodes nodes_;
    int pass_ = 0, sizes_so_far_ = 0, first_count_ = 0;
    SizeSums total_ = {};  // over all passes that count
    double exact_q_ext_ = 0;
    double change_before_ = 0, lasting_before_ = 0, share_left_ = 1;
};

}  // namespace miebrdf::mie
