#include "mie/ensemble/changed_sums.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace miebrdf::mie {
namespace {

void subtract(SphereSums& from, const SphereSums& other) {
    from.scattered -= other.scattered;
    from.absorbed -= other.absorbed;
    from.asymmetric -= other.asymmetric;
}

/// Adds a * one + b * other, order by order, with the columns times factors of their own.
template <typename Scalar, typename From>
void put_sum(double a, const SphereBlockOf<From>& one, double b, const SphereBlockOf<From>& other,
             const Eigen::ArrayXd& factors, SphereBlockOf<Scalar>& to) {
    to.make_room(std::max(one.terms, other.terms), one.size);
    for (std::size_t i = 0; i < to.orders.size(); ++i)
        to.orders[i].last = std::max(one.orders[i].last, other.orders[i].last);
    const Eigen::RowVectorXd all = factors.matrix().transpose();
    const auto put = [&](const auto& x, const auto& y, auto& sum) {
        for (int n = 1; n <= to.terms; ++n) {
            for (const auto& [from, at] :
                 {std::pair(0, 0), std::pair(one.imaginary, to.imaginary)}) {
                Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(to.size);
                if (n <= one.terms)
                    row += a * x.row(n).segment(from, to.size).template cast<double>();
                if (n <= other.terms)
                    row += b * y.row(n).segment(from, to.size).template cast<double>();
                sum.row(n).segment(at, to.size) = row.cwiseProduct(all).template cast<Scalar>();
            }
        }
    };
    put(one.U, other.U, to.U);
    put(one.V, other.V, to.V);
}

/// One block of sizes after the other, with sums of its own.
template <typename Scalar>
class ChangedPart {
  public:
    ChangedPart(const std::vector<double>& radius_um, const SpheresAtRadii& middle,
                const std::vector<SpheresChange>& changes, const SizeSumOptions& options,
                const AngularFunctionsOf<Scalar>* angles)
        : radius_um_(radius_um),
          middle_(middle),
          changes_(changes),
          options_(options),
          angles_(angles),
          sums_{empty(), std::vector<SizeSums>(changes.size(), empty())},
          taken_away_(changes.size(), empty().covariance) {}

    void add(SizeChunks::Block sizes) {
        first_ = std::size_t(sizes.first);
        count_ = std::size_t(sizes.count);
        take_shares();
        const bool with_waves = options_.band_width >= 0 || angles_ != nullptr;
        sums_.middle.spheres.add(counted(middle_, with_waves ? &waves_ : nullptr));
        if (with_waves) {
            padded_ = Eigen::ArrayXd::Zero(waves_.size);
            add_waves(counted_ / shares_, sums_.middle.covariance);
            if (angles_ != nullptr) {
                put_sum(1.0, waves_, 0.0, waves_, ones(), block_);
                amplitudes_ = angles_->amplitudes(block_);
                add_products(amplitudes_, counted_ / shares_, sums_.middle);
            }
        }
        for (std::size_t c = 0; c < changes_.size(); ++c) {
            add_other_shares(c, with_waves);
            if (changes_[c].spheres_differ) add_other_spheres(c, with_waves);
        }
    }

    ChangedSums finished() {
        for (std::size_t c = 0; c < changes_.size() && options_.band_width >= 0; ++c) {
            taken_away_[c].scale(-1.0);
            sums_.differences[c].covariance.add(taken_away_[c]);
        }
        return std::move(sums_);
    }

  private:
    SizeSums empty() const {
        SizeSums sums;
        if (options_.band_width >= 0)
            sums.covariance = BandCovariance(options_.terms, options_.band_width);
        if (angles_ != nullptr)
            sums.products =
                Eigen::ArrayXXd::Zero(angles_->angle_count(), options_.with_matrix ? 4 : 2);
        return sums;
    }

    Eigen::ArrayXd of_block(const std::vector<double>& all) const {
        return Eigen::Map<const Eigen::ArrayXd>(all.data() + first_, Eigen::Index(count_));
    }

    Eigen::ArrayXd padded(const Eigen::ArrayXd& factors) const {
        Eigen::ArrayXd all = padded_;
        all.head(factors.size()) = factors;
        return all;
    }

    Eigen::ArrayXd ones() const { return padded(Eigen::ArrayXd::Ones(shares_.size())); }

    /// Sizes beyond the ends of a law count in changes alone.
    void take_shares() {
        counted_ = shares_ = of_block(middle_.area_share);
        for (const SpheresChange& change : changes_) {
            const Eigen::ArrayXd other =
                (of_block(change.plus.area_share) - of_block(change.minus.area_share)).abs();
            shares_ = (counted_ > 0).select(shares_, shares_.max(other));
        }
        shares_ = (shares_ > 0).select(shares_, 1.0);
    }

    SphereSums spheres(const SpheresAtRadii& of, const Eigen::ArrayXd& shares,
                       SphereBlock* block) const {
        std::vector<double> x(count_), weight(count_);
        for (std::size_t i = 0; i < count_; ++i) {
            x[i] = of.x_per_um * radius_um_[first_ + i];
            weight[i] = shares[Eigen::Index(i)] / (x[i] * x[i]);
        }
        return compute_spheres(of.scatterer, x, weight, block);
    }

    /// Sums over the sizes of the law; waves of all.
    SphereSums counted(const SpheresAtRadii& of, SphereBlock* block) const {
        const SphereSums all = spheres(of, shares_, block);
        return (counted_ == shares_).all() ? all : spheres(of, counted_, nullptr);
    }

    /// Adds the waves in the middle with these factors >= 0 of their squares.
    void add_waves(const Eigen::ArrayXd& factors, BandCovariance& to) {
        if (options_.band_width < 0 || !(factors > 0).any()) return;
        put_sum(1.0, waves_, 0.0, waves_, padded(factors.sqrt()), block_);
        to.add(block_);
    }

    using Amplitudes = typename AngularFunctionsOf<Scalar>::Amplitudes;
    void add_products(const Amplitudes& one, const Eigen::ArrayXd& factors, SizeSums& to) const {
        AngularFunctionsOf<Scalar>::add_products(
            one, amplitudes_, padded(factors).transpose().template cast<Scalar>(), to.products);
    }

    void add_other_shares(std::size_t c, bool with_waves) {
        const SpheresChange& change = changes_[c];
        const Eigen::ArrayXd more =
            of_block(change.plus.area_share) - of_block(change.minus.area_share);
        if (!(more != 0).any()) return;
        SizeSums& to = sums_.differences[c];
        const Eigen::ArrayXd gained = more.max(0.0), lost = (-more).max(0.0);
        if ((gained > 0).any()) to.spheres.add(spheres(middle_, gained, nullptr));
        if ((lost > 0).any()) subtract(to.spheres, spheres(middle_, lost, nullptr));
        if (!with_waves) return;
        add_waves(gained / shares_, to.covariance);
        add_waves(lost / shares_, taken_away_[c]);
        if (angles_ != nullptr) add_products(amplitudes_, more / shares_, to);
    }

    /// With M the waves in the middle and D their change: Q(M + s D) - Q(M - s D) is 2 s times as
    /// much as Q changes, for every s; one that makes both alike leaves little to rounding.
    void add_other_spheres(std::size_t c, bool with_waves) {
        SizeSums& to = sums_.differences[c];
        to.spheres.add(counted(changes_[c].plus, with_waves ? &plus_ : nullptr));
        subtract(to.spheres, counted(changes_[c].minus, with_waves ? &minus_ : nullptr));
        if (!with_waves) return;
        put_sum(1.0, plus_, -1.0, minus_, ones(), change_);
        const double all = norm(waves_), changed = norm(change_);
        if (!(changed > 0)) return;
        const double s = all / changed;
        if (options_.band_width >= 0) {
            const Eigen::ArrayXd factors = padded((counted_ / shares_ / (2 * s)).sqrt());
            put_sum(1.0, waves_, s, change_, factors, block_);
            to.covariance.add(block_);
            put_sum(1.0, waves_, -s, change_, factors, block_);
            taken_away_[c].add(block_);
        }
        if (angles_ == nullptr) return;
        put_sum(s, change_, 0.0, change_, ones(), block_);
        const Amplitudes amplitudes = angles_->amplitudes(block_);
        const Eigen::ArrayXd factors = counted_ / shares_ / s;
        add_products(amplitudes, factors, to);
        AngularFunctionsOf<Scalar>::add_products(
            amplitudes_, amplitudes, padded(factors).transpose().template cast<Scalar>(),
            to.products);
    }

    static double norm(const SphereBlock& block) {
        double squares = 0;
        for (int n = 1; n <= block.terms; ++n) {
            for (const int at : {0, block.imaginary})
                squares += block.U.row(n).segment(at, block.size).squaredNorm() +
                           block.V.row(n).segment(at, block.size).squaredNorm();
        }
        return std::sqrt(squares);
    }

    const std::vector<double>& radius_um_;
    const SpheresAtRadii& middle_;
    const std::vector<SpheresChange>& changes_;
    const SizeSumOptions& options_;
    const AngularFunctionsOf<Scalar>* angles_;
    ChangedSums sums_;
    std::vector<BandCovariance> taken_away_;
    std::size_t first_ = 0, count_ = 0;
    Eigen::ArrayXd counted_ = {}, shares_ = {}, padded_ = {};  // of this block
    SphereBlock waves_ = {}, plus_ = {}, minus_ = {}, change_ = {};
    SphereBlockOf<Scalar> block_ = {};
    Amplitudes amplitudes_ = {};
};

}  // namespace

template <typename Scalar>
ChangedSums sums_with_changes(const std::vector<double>& radius_um, const SpheresAtRadii& middle,
                              const std::vector<SpheresChange>& changes,
                              const SizeSumOptions& options,
                              const AngularFunctionsOf<Scalar>* angles, const Executor& run) {
    const SizeChunks chunks(int(radius_um.size()));
    std::vector<ChangedSums> parts(std::size_t(chunks.count()));
    run(chunks.count(), [&](int job) {
        const int chunk = chunk_of_job(job, chunks.count());
        ChangedPart<Scalar> part(radius_um, middle, changes, options, angles);
        for (const SizeChunks::Block& block : chunks.blocks(chunk)) part.add(block);
        parts[std::size_t(chunk)] = part.finished();
    });
    ChangedSums total = std::move(parts.front());
    for (std::size_t i = 1; i < parts.size(); ++i) {
        total.middle.add(parts[i].middle);
        for (std::size_t c = 0; c < changes.size(); ++c)
            total.differences[c].add(parts[i].differences[c]);
    }
    return total;
}

template ChangedSums sums_with_changes(const std::vector<double>&, const SpheresAtRadii&,
                                       const std::vector<SpheresChange>&, const SizeSumOptions&,
                                       const AngularFunctionsOf<float>*, const Executor&);
template ChangedSums sums_with_changes(const std::vector<double>&, const SpheresAtRadii&,
                                       const std::vector<SpheresChange>&, const SizeSumOptions&,
                                       const AngularFunctionsOf<double>*, const Executor&);

}  // namespace miebrdf::mie
