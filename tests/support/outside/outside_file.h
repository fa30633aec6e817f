// Our files as other programs see them. Each reader is written from the layout of the format alone,
// works with vectors as renderers do, and interpolates, clamps and divides like the program named;
// it shares no code with the writers nor with the readers of `miebrdf check`. Files are trusted:
// these readers are for tests.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace miebrdf::support {

/// Unit vectors away from the surface, z along its normal.
using Vector = Eigen::Vector3d;

class OutsideFile {
  public:
    virtual ~OutsideFile() = default;

    /// 1/sr, no cosine, in the order in which the file has its channels.
    virtual std::vector<double> brdf(const Vector& to_light, const Vector& to_viewer) const = 0;

    /// Importance sampling starts from one of the two vectors and draws the other.
    virtual bool starts_from_light() const { return false; }
    /// Empty where the program gives up on a sample.
    virtual std::optional<Vector> sample(const Vector&, double, double) const { return {}; }
    /// The density of `sample`, per solid angle, as the program states it.
    virtual double density(const Vector& /*fixed*/, const Vector& /*drawn*/) const { return 0.0; }
};

/// pbrt-v3's FourierBSDF (R, G, B or Y).
std::unique_ptr<OutsideFile> scatfun_file(const std::string& bytes);
/// powitacq, Mitsuba 3 and pbrt-v4 `measured`, isotropic files.
std::unique_ptr<OutsideFile> tensor_bsdf_file(const std::string& bytes);
/// libbsdf: linear in the three angles between the lower edges of bins.
std::unique_ptr<OutsideFile> merl_file(const std::string& bytes);
/// The code that came with the MERL database, and BRDF Explorer: the bin itself.
std::unique_ptr<OutsideFile> merl_bins_file(const std::string& bytes);
/// libbsdf: linear in the angles.
std::unique_ptr<OutsideFile> ssdd_file(const std::string& bytes);
std::unique_ptr<OutsideFile> astm_file(const std::string& bytes);
/// Radiance: constant over patches or cells. Channels are R, G, B.
std::unique_ptr<OutsideFile> klems_file(const std::string& bytes);
std::unique_ptr<OutsideFile> tensor_tree_file(const std::string& bytes);

/// Tables over lists of cosines and azimuths, read without NumPy and without OpenEXR.
struct OutsideTable {
    std::vector<double> wavelength_nm, mu_in, mu_out, azimuth_deg;
    std::vector<double> values;  ///< [wavelength][mu_in][mu_out][azimuth]
};
OutsideTable npz_table(const std::string& bytes);
OutsideTable exr_table(const std::string& bytes);

}  // namespace miebrdf::support
