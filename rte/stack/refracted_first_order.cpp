#include "rte/stack/refracted_first_order.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "rte/boundary/facet_lobes.h"
#include "rte/boundary/rough_top.h"
#include "rte/boundary/smooth_boundary.h"
#include "rte/grid/refraction_grid.h"

namespace miebrdf::rte {
namespace {

// r + (1 - r)^2 s / (1 - r s): a boundary over what returns s.
double with_boundary(double r, double s) { return r + (1.0 - r) * (1.0 - r) * s / (1.0 - r * s); }

// A beam in one medium, without being scattered.
struct MediumReturns {
    double mu, attenuation;
    double step;      // reflectance of the boundary at its bottom
    double returned;  // by that and all below it
};

// What comes back of a beam at the top of the topmost medium. `see` is shown each medium, from the
// bottom up.
// @param cosine_in  of the beam in a medium, by its index; 0: it does not get there
template <typename CosineIn, typename See>
double returned_by_media(const ScaledStack& stack, const CosineIn& cosine_in, const See& see) {
    double below_index = stack.ground_index;
    double from_below = 0.0;
    if (stack.base == BaseKind::mirror) {
        from_below = boundary_reflectance(below_index, stack.mirror_index, cosine_in(below_index));
    }
    for (const ScaledMedium& medium : stack.media) {
        MediumReturns beam;
        beam.mu = cosine_in(medium.index);
        beam.attenuation = beam.mu > 0.0 ? std::exp(-medium.scaled_optical_depth / beam.mu) : 0.0;
        beam.step = medium.index == below_index
                        ? 0.0
                        : boundary_reflectance(medium.index, below_index, beam.mu);
        beam.returned = with_boundary(beam.step, from_below);
        from_below = beam.attenuation * beam.attenuation * beam.returned;
        below_index = medium.index;
        see(beam);
    }
    return from_below;
}

}  // namespace

std::vector<Beam> beams_of(const ScaledStack& stack, double mu_air) {
    std::vector<MediumReturns> returns;
    const double top = returned_by_media(
        stack, [=](double index) { return refracted_cosine(index, mu_air); },
        [&](const MediumReturns& medium) { returns.push_back(medium); });
    std::vector<Beam> beams(stack.media.size());
    const double r = boundary_reflectance(1.0, stack.top_index, mu_air);
    double down = (1.0 - r) / (1.0 - r * top);
    for (std::size_t i = beams.size(); i-- > 0;) {
        const MediumReturns& here = returns[i];
        beams[i] = {here.mu, down, down * here.attenuation * here.returned};
        down *= here.attenuation;
        if (i == 0) break;
        const MediumReturns& below = returns[i - 1];
        const double seen = below.attenuation * below.attenuation * below.returned;
        down *= (1.0 - here.step) / (1.0 - here.step * seen);
    }
    return beams;
}

double mirror_reflectance(const ScaledStack& stack, double mu_air) {
    return with_boundary(boundary_reflectance(1.0, stack.top_index, mu_air),
                         returned_by_media(
                             stack, [=](double index) { return refracted_cosine(index, mu_air); },
                             [](const MediumReturns&) {}));
}

double unscattered_return(const ScaledStack& stack, double mu) {
    const double q = stack.top_index * std::sqrt((1.0 - mu) * (1.0 + mu));
    const auto cosine_in = [&](double index) {
        if (index == stack.top_index) return mu;
        return q < index ? std::sqrt((index - q) * (index + q)) / index : 0.0;
    };
    return returned_by_media(stack, cosine_in, [](const MediumReturns&) {});
}

FirstOrderPaths first_order_paths(const ScaledMedium& medium, const Beam& in, const Beam& out) {
    const double tau = medium.scaled_optical_depth;
    const double n2 = medium.index * medium.index;
    FirstOrderPaths paths{in.mu, out.mu, 0.0, 0.0};
    paths.back = (in.down * out.down + in.up * out.up) *
                 -std::expm1(-tau * (1.0 / in.mu + 1.0 / out.mu)) / (4.0 * n2 * (in.mu + out.mu));
    const double turned = in.down * out.up + in.up * out.down;
    if (turned > 0.0) paths.forward = turned * forward_quotient(tau, in.mu, out.mu) / (4.0 * n2);
    return paths;
}

double forward_quotient(double tau, double mu, double other) {
    if (std::isinf(tau)) return 0.0;
    const double a = tau / std::max(mu, other), b = tau / std::min(mu, other);
    const double x = b - a;
    const double mean = x > 0.0 ? -std::expm1(-x) / x : 1.0;
    return std::exp(-a) * mean * tau / (mu * other);
}

double cos_forward_angle(double mu_in, double mu_out, double cos_azimuth) {
    const double sines = std::sqrt((1.0 - mu_in) * (1.0 + mu_in) * (1.0 - mu_out) * (1.0 + mu_out));
    return std::clamp(mu_in * mu_out + sines * cos_azimuth, -1.0, 1.0);
}

bool has_straight_paths(const ScaledStack& stack) { return !stack.has_mirrors(); }

double straight_paths_factor(double n, double mu_in_air, double mu_out_air) {
    if (n == 1.0) return 1.0;
    return (1.0 - boundary_reflectance(1.0, n, mu_in_air)) *
           (1.0 - boundary_reflectance(1.0, n, mu_out_air)) / (n * n);
}

SurfaceLobe outer_lobe(const Boundary& boundary, double index) {
    return {index, {.beckmann_alpha = boundary.roughness, .distribution = boundary.distribution}};
}

void StackFirstOrder::add_outer_lobe(std::vector<double>& reflection,
                                     const ScaledStack& stack) const {
    const SurfaceLobe lobe = outer_lobe(*stack.boundary, stack.top_index);
    const auto scale_at = [&](const std::vector<double>& cosines) -> Eigen::VectorXd {
        return outer_lobe_scale(
            stack.top_index, *stack.boundary,
            Eigen::Map<const Eigen::VectorXd>(cosines.data(), Eigen::Index(cosines.size())));
    };
    const Eigen::VectorXd in = scale_at(directions_.mu_in), out = scale_at(directions_.mu_out);
    std::size_t next = 0;
    for (std::size_t i = 0; i < directions_.mu_in.size(); ++i) {
        for (std::size_t o = 0; o < directions_.mu_out.size(); ++o) {
            const double scale = std::numbers::pi * in[Eigen::Index(i)] * out[Eigen::Index(o)];
            for (const double azimuth : directions_.azimuth_deg)
                reflection[next++] +=
                    scale * lobe.brdf(directions_.mu_in[i], directions_.mu_out[o], azimuth);
        }
    }
}

int mirrored_lobe_orders(const ScaledStack& stack) {
    // A passage turns light by (n - 1) times the slope of its facet, and GGX slopes of alpha give
    // orders that fall like exp(-alpha (n - 1) m).
    constexpr double fall = 9.0;
    const double orders = fall / (stack.boundary->roughness * (stack.top_index - 1.0));
    return int(std::clamp(orders, 12.0, double(kMostBoundaryOrders)));
}

void add_mirrored_lobe(std::vector<double>& reflection, const Directions& directions,
                       const ScaledStack& stack) {
    const Boundary& boundary = *stack.boundary;
    const MirroredLobe lobe(stack.top_index, {boundary.roughness, boundary.distribution},
                            [&](double mu) { return unscattered_return(stack, mu); });
    const auto scale_at = [&](const std::vector<double>& cosines) {
        return facet_compensation(
            stack.top_index, boundary,
            Eigen::Map<const Eigen::VectorXd>(cosines.data(), Eigen::Index(cosines.size())));
    };
    lobe.add_to(reflection, directions, scale_at(directions.mu_in), scale_at(directions.mu_out));
}

void StackFirstOrder::add_to(std::vector<double>& reflection, const ScaledStack& stack,
                             std::vector<double>* unresolved) {
    if (stack.boundary && stack.boundary->is_rough()) {
        add_outer_lobe(reflection, stack);
        if (stack.has_mirrors()) add_mirrored_lobe(reflection, directions_, stack);
        return;
    }
    if (has_straight_paths(stack)) {
        add_straight(reflection, stack, unresolved);
    } else {
        add_all_paths(reflection, stack);
    }
}

void StackFirstOrder::add_straight(std::vector<double>& reflection, const ScaledStack& stack,
                                   std::vector<double>* unresolved) {
    if (straight_ == nullptr) {
        inside_ = refracted(directions_, stack.top_index);
        straight_ = std::make_unique<FirstOrderSum>(inside_, options_);
    }
    if (stack.top_index == 1.0) {
        straight_->add_to(reflection, stack.media, unresolved);
        return;
    }
    std::vector<double> inside(reflection.size(), 0.0);
    straight_->add_to(inside, stack.media, unresolved);
    std::size_t next = 0;
    for (const double mu_in : directions_.mu_in) {
        for (const double mu_out : directions_.mu_out) {
            const double factor = straight_paths_factor(stack.top_index, mu_in, mu_out);
            for (std::size_t a = 0; a < directions_.azimuth_deg.size(); ++a, ++next) {
                reflection[next] += factor * inside[next];
                if (unresolved != nullptr && !unresolved->empty()) (*unresolved)[next] *= factor;
            }
        }
    }
}

void StackFirstOrder::add_all_paths(std::vector<double>& reflection,
                                    const ScaledStack& stack) const {
    const bool exact = options_.single_scattering_correction;
    const auto beams_at = [&](const std::vector<double>& cosines) {
        std::vector<std::vector<Beam>> beams;
        for (const double mu : cosines) beams.push_back(beams_of(stack, mu));
        return beams;
    };
    const auto in = beams_at(directions_.mu_in), out = beams_at(directions_.mu_out);
    std::size_t first = 0;
    for (const auto& from : in) {
        for (const auto& to : out) {
            for (std::size_t k = 0; k < stack.media.size(); ++k) {
                const ScaledMedium& medium = stack.media[k];
                const FirstOrderPaths paths = first_order_paths(medium, from[k], to[k]);
                for (std::size_t a = 0; a < directions_.azimuth_deg.size(); ++a) {
                    const double cosine =
                        std::cos(directions_.azimuth_deg[a] * (std::numbers::pi / 180.0));
                    double& value = reflection[first + a];
                    if (paths.back > 0.0) {
                        value += paths.back *
                                 first_order_strength(
                                     medium, exact,
                                     cos_scattering_angle(paths.mu_in, paths.mu_out, cosine));
                    }
                    if (paths.forward > 0.0) {
                        value += paths.forward *
                                 first_order_strength(
                                     medium, exact,
                                     cos_forward_angle(paths.mu_in, paths.mu_out, cosine));
                    }
                }
            }
            first += directions_.azimuth_deg.size();
        }
    }
}

}  // namespace miebrdf::rte
