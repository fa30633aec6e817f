#include "rte/first_order/beams.h"

#include <cmath>

#include "rte/boundary/smooth_boundary.h"
#include "rte/grid/refraction_grid.h"

namespace miebrdf::rte {
namespace {

template <typename Light>
struct Fresnel;

template <>
struct Fresnel<double> {
    static constexpr double whole = 1.0;
    static double reflected(double here, std::complex<double> beyond, double mu) {
        return boundary_reflectance(here, beyond, mu);
    }
    static double passed(double reflected) { return 1.0 - reflected; }
};

template <>
struct Fresnel<FresnelMatrix> {
    inline static const FresnelMatrix whole = FresnelMatrix::identity();
    static FresnelMatrix reflected(double here, std::complex<double> beyond, double mu) {
        return fresnel_reflection(here, beyond, mu);
    }
    static FresnelMatrix passed(const FresnelMatrix& reflected) { return passing(reflected); }
};

template <typename Light>
Light reflected_between(double here, double beyond, double mu) {
    return here == beyond ? Light{} : Fresnel<Light>::reflected(here, beyond, mu);
}

// r + t^2 s / (1 - r s): a boundary over what returns s.
template <typename Light>
Light with_boundary(const Light& r, const Light& s) {
    const Light t = Fresnel<Light>::passed(r);
    return r + t * t * s / (Fresnel<Light>::whole - r * s);
}

// A beam in one medium and the light that comes back of it.
template <typename Light>
struct MediumReturns {
    double mu = 1.0, attenuation = 1.0;
    Light step = {};      // reflection by the boundary at its bottom
    Light returned = {};  // by that and all below it
    Light at_top() const { return returned * (attenuation * attenuation); }
};

template <typename Light>
Light of_mirror(const ScaledStack& stack, double mu) {
    return stack.base == BaseKind::mirror
               ? Fresnel<Light>::reflected(stack.ground_index, stack.mirror_index, mu)
               : Light{};
}

// From the bottom up.
// @param cosine_in  of the beam in a medium, by its index; 0: it does not get there
// @return what comes back at the top of the topmost medium
template <typename Light, typename CosineIn>
Light find_returns(const ScaledStack& stack, const CosineIn& cosine_in,
                   std::vector<MediumReturns<Light>>& returns) {
    double below_index = stack.ground_index;
    Light from_below = of_mirror<Light>(stack, cosine_in(below_index));
    returns.reserve(stack.media.size());
    for (const ScaledMedium& medium : stack.media) {
        MediumReturns<Light>& here = returns.emplace_back();
        here.mu = cosine_in(medium.index);
        here.attenuation = here.mu > 0.0 ? std::exp(-medium.scaled_optical_depth / here.mu) : 0.0;
        here.step = reflected_between<Light>(medium.index, below_index, here.mu);
        here.returned = with_boundary(here.step, from_below);
        from_below = here.at_top();
        below_index = medium.index;
    }
    return from_below;
}

auto from_air(double mu_air) {
    return [=](double index) { return refracted_cosine(index, mu_air); };
}

}  // namespace

double unscattered_return(const ScaledStack& stack, double mu) {
    const double q = stack.top_index * std::sqrt((1.0 - mu) * (1.0 + mu));
    const auto cosine_in = [&](double index) {
        if (index == stack.top_index) return mu;
        return q < index ? std::sqrt((index - q) * (index + q)) / index : 0.0;
    };
    std::vector<MediumReturns<double>> returns;
    return find_returns<double>(stack, cosine_in, returns);
}

template <typename Light>
std::vector<Beam<Light>> beams_of(const ScaledStack& stack, double mu_air) {
    const Light whole = Fresnel<Light>::whole;
    std::vector<MediumReturns<Light>> returns;
    const Light top = find_returns<Light>(stack, from_air(mu_air), returns);
    std::vector<Beam<Light>> beams(stack.media.size());
    const Light r = reflected_between<Light>(1.0, stack.top_index, mu_air);
    Light down = Fresnel<Light>::passed(r) / (whole - r * top);
    for (std::size_t i = beams.size(); i-- > 0;) {
        const MediumReturns<Light>& here = returns[i];
        beams[i] = {here.mu, down, down * here.returned * here.attenuation};
        down = down * here.attenuation;
        if (i == 0) break;
        down = down * Fresnel<Light>::passed(here.step) /
               (whole - here.step * returns[i - 1].at_top());
    }
    return beams;
}

template <typename Light>
Light mirror_reflection(const ScaledStack& stack, double mu_air) {
    std::vector<MediumReturns<Light>> returns;
    const Light below = find_returns<Light>(stack, from_air(mu_air), returns);
    return with_boundary(reflected_between<Light>(1.0, stack.top_index, mu_air), below);
}

template <typename Light>
Light straight_transmission(const ScaledStack& stack, double mu_air) {
    const Light whole = Fresnel<Light>::whole;
    std::vector<MediumReturns<Light>> returns;
    const Light top = find_returns<Light>(stack, from_air(mu_air), returns);
    const Light mirror = of_mirror<Light>(stack, refracted_cosine(stack.ground_index, mu_air));
    const Light r = reflected_between<Light>(1.0, stack.top_index, mu_air);
    Light down = Fresnel<Light>::passed(r) / (whole - r * top);
    for (std::size_t i = returns.size(); i-- > 0;) {
        const MediumReturns<Light>& here = returns[i];
        const Light below = i > 0 ? returns[i - 1].at_top() : mirror;
        down = down * here.attenuation * Fresnel<Light>::passed(here.step) /
               (whole - here.step * below);
    }
    return down * Fresnel<Light>::passed(mirror);
}

template std::vector<Beam<double>> beams_of(const ScaledStack&, double);
template std::vector<Beam<FresnelMatrix>> beams_of(const ScaledStack&, double);
template double mirror_reflection(const ScaledStack&, double);
template FresnelMatrix mirror_reflection(const ScaledStack&, double);
template double straight_transmission(const ScaledStack&, double);
template FresnelMatrix straight_transmission(const ScaledStack&, double);

}  // namespace miebrdf::rte
