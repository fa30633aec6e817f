// A solved BRDF made small and fast: what pictures are rendered with and what report pages carry.
#pragma once

#include <miebrdf/brdf.h>

#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/solve/low_rank.h"
#include "pipeline/solve/smooth_part.h"

namespace miebrdf {

struct SolvedTable;

struct CompactOptions {
    /// Largest interpolation error that is aimed at, over the largest value at an incidence.
    double tolerance = 8e-4;
    int cosines = 0;  ///< of either direction, 6 to 49; 0: as few as the tolerance needs
    int orders = 0;   ///< at most so many azimuthal orders; 0: as many as the tolerance needs
    /// Nodes for light scattered once: the finest angles, 2^k + 1 of them (1025: 0.0004
    /// degrees apart at 0 and 180, 0.28 in the middle), and slants, 6 or more.
    int angles = 1025, slants = 33;
    bool is_measured = true;  ///< else nothing is known of the interpolation error
};

/// The low-rank encoding of a BrdfTable, a hundredth of its size.
///
/// Light scattered more than once: (mu_in + mu_out) R as Fourier series in azimuth at pairs of
/// cosines (half_sine_nodes), mu_in <= mu_out, because it is reciprocal. Light scattered once:
/// 4 (mu_in + mu_out) R as a table of the scattering angle and of q = 1/mu_in + 1/mu_out; under
/// boundaries and over mirrors it is in the series. Both keep few basis columns (LowRank). What a
/// surface lets in and out, and its lobe, are functions of cosines.
class CompactTable {
  public:
    /// Of log q, where more than one layer makes it matter.
    static constexpr double kFirstQ = 2.0, kLastQ = 2000.0;

    /// A function of a cosine at each wavelength: row = wavelength, column = node.
    using OfCosine = Eigen::MatrixXd;

    /// The lobe of a rough surface or boundary, taken apart: f = D(h) G F / (4 mu_in mu_out) s_in
    /// s_out.
    struct Lobe {
        bool ggx = false;    ///< else Beckmann
        double alpha = 0.3;  ///< slope parameter
        rte::Shadowing shadowing = rte::Shadowing::smith_correlated;
        std::vector<double> masking;  ///< mu / G1(mu) at the nodes
        OfCosine fresnel;             ///< of the cosine of incidence
        OfCosine scale;               ///< s; empty: 1
        /// It stands for the mirror reflection of a smooth boundary: in pictures only, no part of
        /// f.
        bool only_in_pictures = false;
    };
    enum class Lobes { of_brdf, of_pictures };

    /// @param tables  one, or several that differ in media and share their surface options; their
    ///                wavelengths are joined in order
    /// @throws UsageError  for options out of range and an empty list; InputError when a wavelength
    ///         has no physical solution; Cancelled
    CompactTable(std::span<const BrdfTable> tables, const CompactOptions& options,
                 const Control& control = {});

    std::size_t wavelengths() const { return wavelength_nm_.size(); }
    const std::vector<double>& wavelength_nm() const { return wavelength_nm_; }

    /// BRDF [1/sr] at each wavelength.
    /// @param brdf  wavelengths() values, overwritten
    void evaluate(double mu_in, double mu_out, double cos_azimuth, std::span<double> brdf,
                  Lobes lobes = Lobes::of_brdf) const;
    /// BRDF of the layers, without the lobe.
    void evaluate_layers(double mu_in, double mu_out, double cos_azimuth,
                         std::span<double> brdf) const;
    /// Share that a surface lets in.
    double let_in(std::size_t wavelength, double mu) const;
    /// Largest difference from the BRDF it was made of, over directions between the nodes, relative
    /// to the largest value at that incidence and wavelength.
    double interpolation_error() const { return error_; }

    // The encoding consists of these.
    int pair_cosines() const { return pair_cosines_; }
    /// Fourier orders of each pair (i, o >= i), in this order.
    const std::vector<int>& orders() const { return orders_; }
    const LowRank& multiple() const { return multiple_; }  ///< row = pair, order
    int angles() const { return angles_; }                 ///< 0: all is in the series
    int slants() const { return slants_; }                 ///< 1: q does not matter
    const LowRank& single_scattering() const {
        return single_scattering_;
    }  ///< column = slant * wavelengths() + wavelength
    /// Shares that a surface lets in and out; empty: all of it.
    const OfCosine& in() const { return in_; }
    const OfCosine& out() const { return out_; }
    const std::optional<Lobe>& lobe() const { return lobe_; }

  private:
    /// LowRank for sums of many rows, in lanes of single precision.
    struct Rows {
        using Lane = Eigen::Array<float, int(math::kSeriesLanes), 1>;
        Eigen::MatrixXf basis;  ///< column = row of the table, with its scale, filled up to lanes
        Eigen::MatrixXf coefficients;  ///< row = column of the table, with its scale

        void set(const LowRank& table);
        Eigen::Index lanes() const { return basis.rows() / Lane::SizeAtCompileTime; }
        Eigen::Map<const Lane> lane_of(Eigen::Index row, Eigen::Index lane) const {
            return Eigen::Map<const Lane>(basis.col(row).data() + lane * Lane::SizeAtCompileTime);
        }
    };
    using Tables = std::vector<const SolvedTable*>;
    // make_compact_table.cpp
    void add_surface(const Tables& tables);
    void add_boundary(const Tables& tables);
    void add_single_scattering(const Tables& tables, const CompactOptions& options,
                               const Control& control);
    void add_multiple(const Tables& tables, int cosines, const CompactOptions& options,
                      const Control& control);
    /// @param series  [wavelength][pair], (mu_in + mu_out) times the coefficients
    void keep_orders(const std::vector<std::vector<std::vector<double>>>& series, int cosines,
                     const CompactOptions& options);

    void add_lobe(double mu_in, double mu_out, double cos_azimuth, std::span<double> brdf) const;
    Eigen::VectorXf scattered_repeatedly(double mu_in, double mu_out, double cos_azimuth) const;
    Eigen::VectorXf scattered_singly(double mu_in, double mu_out, double cos_azimuth) const;
    double measure(std::span<const BrdfTable> tables) const;

    std::vector<double> wavelength_nm_;
    int pair_cosines_ = 0;
    std::vector<int> orders_, first_row_;
    LowRank multiple_;
    Rows multiple_rows_;
    int angles_ = 0, slants_ = 1;
    LowRank single_scattering_;
    Rows single_rows_;
    OfCosine in_, out_;
    std::optional<Lobe> lobe_;
    double error_ = 0.0;
};

}  // namespace miebrdf
