// Optics of an ensemble of spheres, or of spheroids in random orientation: Mie theory, or the
// T-matrix, averaged over a size distribution, for unpolarised light and as the whole scattering
// matrix.
// Symbols, signs and normalisation: docs/conventions.md.
#pragma once

#include <miebrdf/matrix_expansion.h>
#include <miebrdf/sizes.h>

#include <complex>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf::mie {

/// Calls job(0) ... job(count - 1), each once, in any order or at the same time, and returns when
/// all are done. Pieces never depend on the executor and their results are merged in order, so that
/// every executor gives the same bits.
using Executor = std::function<void(int count, const std::function<void(int)>& job)>;

inline void run_in_order(int count, const std::function<void(int)>& job) {  ///< by this thread
    for (int i = 0; i < count; ++i) job(i);
}

/// A coating of the particles: as thick on every core, as a share of the core's radius, or both.
struct ParticleCoating {
    std::complex<double> refractive_index;  ///< n + ik, k >= 0
    double thickness_um = 0;                ///< >= 0
    double share_of_radius = 0;             ///< >= 0
};

/// The wishes of a caller: only what is asked for is computed.
struct EnsembleRequest {
    SizeDistribution sizes = {};                 ///< of the particles, or of their cores
    std::complex<double> refractive_index = {};  ///< of the particles, n + ik, k >= 0
    std::vector<ParticleCoating> coatings = {};  ///< of the particles, from inside out
    /// Spheroids in random orientation: the equatorial axis over the axis of rotation, above 1
    /// oblate, kLeastSpheroidAspect to kMostSpheroidAspect. Sizes are radii of spheres of the same
    /// volume, and so are the cross-sections that efficiencies are relative to. Empty: spheres.
    std::optional<double> aspect = {};
    double host_index = 1.0;                 ///< real index of the medium between them
    double wavelength_nm = 550.0;            ///< in vacuum
    int highest_moment = -1;                 ///< chi_0 ... chi_L; -1: no moments
    std::vector<double> angles_deg = {};     ///< scattering angles for the phase function, 0 to 180
    double tolerance = 1e-4;                 ///< relative, of albedo, q_ext and moments
    double phase_tolerance = 1e-2;           ///< relative, of P at each angle listed, and rms over
                                             ///< each panel of a phase table; points of P need many
                                             ///< more sizes than moments do
    std::vector<double> phase_allowed = {};  ///< absolute, at each angle listed, in place of
                                             ///< phase_tolerance; empty: that
    /// The most that a level of sizes for P at angles may cost: sizes times partial waves times
    /// nodes (eight for each panel with angles). Where that does not reach the tolerance, the error
    /// says so.
    double phase_work = std::numeric_limits<double>::infinity();
    /// A phase table for radiative transfer: P below this is resolved relative to this, because dim
    /// angles do not matter beside light that is scattered many times. Where the medium absorbs
    /// there is less of that: the floor is for a half-space that returns everything, and both it
    /// and the tolerances fall with what a half-space of the medium returns. 0: no such use.
    double phase_floor = 0;
    bool with_phase_table = false;  ///< P at every angle, as a PhaseTable
    double table_tolerance = 1e-3;  ///< of its interpolation, relative within each panel
};

/// P(cos Theta) of an ensemble as polynomials on panels of the scattering angle.
///
/// Panels are narrow forward and backward, where diffraction and glory have the scale pi / x, and
/// grow towards the sides; those whose polynomial does not converge are halved. Copies and calls
/// from several threads are safe; usable as std::function<double(double)>.
class PhaseTable {
  public:
    static constexpr int kPanelNodes = 8;  ///< Chebyshev points with both ends, in each panel

    /// The content of a table, to be stored and made into a table again.
    struct Parts {
        std::vector<double> edges;         ///< radians, ascending from 0 to pi
        std::vector<double> coefficients;  ///< Chebyshev, kPanelNodes of each panel, panel by panel
        double mean = 1;                   ///< of P over the sphere; 1 but for the errors of P
        /// Relative to the largest P of the panel, the worst panel.
        double interpolation_error = 0;
        /// Relative to P, from its finite number of sizes, the worst node.
        double size_error = 0;
        /// Error of each panel by its sizes, rms over its nodes, relative to max(P, noise_floor);
        /// empty: 0.
        std::vector<double> noise;
        double noise_floor = 0;  ///< P, >= 0
        /// The moments given beside it are its own: they share its errors.
        bool gave_moments = false;
    };

    PhaseTable() = default;
    /// @throws UsageError  when edges and panels do not fit
    explicit PhaseTable(Parts parts);

    /// @param cos_theta  cosine of the scattering angle, taken as +-1 outside [-1, 1]
    double operator()(double cos_theta) const;
    /// The error that P there is expected to have by its finite number of sizes and interpolation
    /// (rms, absolute).
    double noise(double cos_theta) const;

    /// P averaged over the sphere: 1 but for the errors of the table. P is relative to all
    /// scattered light and not to its own integral: noise at wide angles, where half of the light
    /// is, would else change the forward peak.
    double mean() const { return parts_.mean; }
    /// Relative to P at each angle.
    double interpolation_error() const { return parts_.interpolation_error; }
    /// Likewise, of the quadrature over sizes.
    double size_error() const { return parts_.size_error; }
    /// How many angles it is stored at.
    int angle_count() const { return kPanelNodes * (static_cast<int>(parts_.edges.size()) - 1); }
    const Parts& parts() const { return parts_; }  ///< to store it

    /// chi_0 = mean() ... chi_highest: integrals of the polynomials against P_l by Gauss rules
    /// dense enough for order l. Absolute error about that of the table times the share of the
    /// light that it concerns; cost: highest_moment^2 steps of a recurrence, 8 at once.
    /// @param highest_moment  >= 0
    std::vector<double> moments(int highest_moment, const Executor& run = run_in_order) const;

  private:
    std::size_t panel_at(double theta) const;
    double at_angle(double theta) const;

    Parts parts_;
};

/// Averages by cross-section: albedo = \<C_sca>/\<C_ext>, chi_l = \<C_sca chi_l>/\<C_sca>.
struct EnsembleOptics {
    double single_scattering_albedo = 0.0;  ///< in [0, 1]; exactly 1 for k = 0
    double one_minus_albedo = 1.0;          ///< absorption / extinction, summed, never a difference
    double q_ext = 0.0;                     ///< \<C_ext> / <pi r^2>, r the radius of the core
    double q_sca = 0.0;
    double q_abs = 0.0;
    double asymmetry = 0.0;                         ///< g = chi_1
    std::vector<double> chi;                        ///< chi_0 = 1 ... chi_highest_moment
    std::vector<double> phase;                      ///< P at angles_deg; mean over the sphere = 1
    std::shared_ptr<const PhaseTable> phase_table;  ///< null unless asked for
    double error_estimate = 0.0;                    ///< relative, of albedo, q_ext and moments
    std::vector<double> phase_error;                ///< of each, as PhaseValues::error
    double phase_error_estimate = 0.0;              ///< relative, largest over angles_deg
    int size_nodes = 0;                             ///< spheres that were averaged, how many
    /// Both estimates within their tolerances, that of the moments for those of the band: moments
    /// from the phase table (hundreds asked) are as good as its sizes allow, and are in
    /// error_estimate only.
    bool converged = false;
};

/// Averages Mie theory over the sizes.
///
/// @throws UsageError  for an index, wavelength, angle or distribution out of range,
///         with the value and what is allowed. Not reaching the tolerance is an outcome: read
///         `converged`.
/// @param run  runs pieces of the work; the result does not depend on it, bit for bit
EnsembleOptics average_over_sizes(const EnsembleRequest& request,
                                  const Executor& run = run_in_order);

/// Refuses what average_over_sizes would refuse before its first sphere. @throws UsageError
void require_average(const EnsembleRequest& request);
/// Likewise of average_matrix.
void require_matrix(const EnsembleRequest& request);

/// How far two averages are apart as error_estimate counts it: the largest change of q_ext, albedo
/// (relative), g (as 1 - g), ln(1 - albedo) (by what it changes of a half-space) and moments.
/// Moments that one of them lacks count as 0 there.
double difference_between(const EnsembleOptics& a, const EnsembleOptics& b);

/// P at single angles.
struct PhaseValues {
    std::vector<double> phase;  ///< mean over the sphere = 1
    /// Absolute, estimated; a tenth of what is allowed at least.
    std::vector<double> error;
};

/// P at request.angles_deg alone, by as many sizes as each angle needs: no moments, no albedo.
/// @param q_sca  scattering efficiency of the average, by which resonances that the sizes have
///               missed show; 0: not known
PhaseValues phase_at_angles(const EnsembleRequest& request, double q_sca,
                            const Executor& run = run_in_order);

/// Degree of the last Legendre moment that is not zero within rounding: twice the number of partial
/// waves of the largest sphere.
int highest_moment_of(const EnsembleRequest& request);

/// Single scattering with its polarisation, averaged over sizes.
struct MatrixOptics {
    /// Albedo, efficiencies and g as average_over_sizes gives them, all chi_l = a1_l / (2l + 1),
    /// and P of the same spheres as a table. Errors, size_nodes and converged are those of both
    /// averages together.
    EnsembleOptics optics;
    /// As many degrees as chi. Spheres have a2 = a1 and a4 = a3 as functions of the angle.
    MatrixExpansion expansion;
};

/// The scattering matrix of an ensemble, averaged by cross-section, as a series.
///
/// Amplitudes S1 and S2 of all sizes at the nodes of a Gauss rule in cos Theta, whose products are
/// polynomials: a1 = (|S1|^2 + |S2|^2) / 2, b1 = (|S2|^2 - |S1|^2) / 2, a3 = Re S2 S1*, b2 =
/// Im S2 S1*. Sizes are refined as for moments, until the estimated error of every coefficient,
/// without its factor 2l + 1, is within the tolerance. Coefficients at the end of the series that
/// are rounding are left out.
///
/// Cost: sizes times partial waves times nodes; milliseconds where size parameters are up to some
/// tens, about a second for hundreds (docs/maths-mie.md).
///
/// @param request  of these: sizes, refractive_index, host_index, wavelength_nm, tolerance,
///                 phase_floor, highest_moment, the degree of the series (-1: all there is), and
///                 phase_tolerance where it is infinite: the error is that of the series alone
/// @param run  runs pieces of the work; the result does not depend on it, bit for bit
/// @throws UsageError  as average_over_sizes, and for spheres beyond kLargestMatrixSphere, with
///         the price. Not reaching the tolerance is an outcome: read `converged`.
MatrixOptics average_matrix(const EnsembleRequest& request, const Executor& run = run_in_order);

/// The difference of two averages that are taken over the same radii.
struct EnsembleDifference {
    double single_scattering_albedo = 0.0, one_minus_albedo = 0.0, q_ext = 0.0, asymmetry = 0.0;
    std::vector<double> chi;                        ///< as many as were asked for
    std::shared_ptr<const PhaseTable> phase_table;  ///< on the panels asked for; null: none
    MatrixExpansion expansion;                      ///< of the degree asked for, chi likewise
};

/// The parts of a difference that are wanted.
struct DifferenceDemand {
    int highest_moment = -1;                  ///< of chi; -1: none
    const PhaseTable* phase_table = nullptr;  ///< whose panels are taken; null: no phase function
    int matrix_degree = -1;                   ///< of the scattering matrix; -1: none
};

/// Two requests a little different from one in the middle in sizes, indices or host.
struct EnsembleChange {
    EnsembleRequest plus, minus;
};

/// `plus` minus `minus` of each change: the derivatives of one discrete average. Its radii are
/// those that `middle` asks for, so that differences are smooth however transparent spheres ripple.
/// Where only the law of sizes differs, the spheres in the middle have other weights, and what the
/// law gains at its moving ends is added, there spread over a few periods of ripple; where spheres
/// change, those of one size included, their waves are differenced.
/// Cost: one pass over the spheres, and one more for each change of them.
/// @throws UsageError  as average_over_sizes, and for spheroids
std::vector<EnsembleDifference> differences_of_averages(const EnsembleRequest& middle,
                                                        const std::vector<EnsembleChange>& changes,
                                                        const DifferenceDemand& demand,
                                                        const Executor& run = run_in_order);

/// Spheroids that averages take: the size parameter of the larger axis, and the aspect.
inline constexpr double kLargestSpheroid = 50;
inline constexpr double kLeastSpheroidAspect = 0.25, kMostSpheroidAspect = 4;

/// The largest size parameter of spheres that average_matrix takes.
inline constexpr double kLargestMatrixSphere = 1800;

/// The least time that average_matrix will take, in seconds of one thread (right to a factor of
/// three).
double matrix_seconds(const EnsembleRequest& request);

}  // namespace miebrdf::mie
#pragma GCC visibility pop
