#include "pipeline/measured/azimuth.h"

#include <fmt/format.h>

#include <algorithm>

namespace miebrdf::measured {
namespace {

/// Lobes of glossy surfaces exceed the opposite side many times; back-scattering of soils and
/// regolith exceeds the forward side two or three times at most (their opposition surge doubles the
/// single scattering).
constexpr double kLobeRatio = 4.0;
/// Within this many degrees of the mirror angle a value is called near it.
constexpr double kNearMirrorDeg = 10.0;

double in_circle(double degrees) {
    const double inside = std::fmod(degrees, 360.0);
    return inside < 0.0 ? inside + 360.0 : inside;
}

/// The angle between two azimuths, in [0, 180].
double apart(double a, double b) {
    const double difference = in_circle(a - b);
    return std::min(difference, 360.0 - difference);
}

/// The azimuth as the file has it: relative, of the outgoing direction. A negative theta_out turns
/// it round.
double relative_azimuth(const RawDirection& d) {
    double phi = !std::isnan(d.phi) ? d.phi : std::isnan(d.phi_out) ? 0.0 : d.phi_out;
    if (d.theta_out < 0.0) phi += 180.0;
    return in_circle(phi);
}

/// How many times larger the values are near the mirror direction, were 0 the mirror side.
double lobe_ratio(const Measurements& list, const std::vector<RawDirection>& raw) {
    double front = 0.0, back = 0.0;
    for (const RawDirection& d : raw) {
        const double theta_in = std::abs(d.theta_in), theta_out = std::abs(d.theta_out);
        if (!(theta_in >= 20.0) || !(std::abs(theta_in - theta_out) <= kNearMirrorDeg)) continue;
        const double azimuth = relative_azimuth(d), value = list.values[d.value].value;
        if (apart(azimuth, 0.0) <= kNearMirrorDeg) front = std::max(front, value);
        if (apart(azimuth, 180.0) <= kNearMirrorDeg) back = std::max(back, value);
    }
    return back > 0.0 && front > 0.0 ? front / back : 1.0;
}

enum class Zero { mirror, back, coordinates };

Zero zero_of(Measurements& list, const std::vector<RawDirection>& raw,
             const MeasuredOptions& options, const MeasuredFile& file) {
    const auto say = [&](const std::string& text) { list.facts.emplace_back("azimuth", text); };
    if (!options.azimuth_zero.empty()) {
        const bool mirror = options.azimuth_zero == "mirror";
        if (!mirror && options.azimuth_zero != "back")
            throw UsageError("azimuth_zero", options.azimuth_zero, "mirror, back");
        say(fmt::format("0 = {}, as asked for", mirror ? "mirror side" : "back to the source"));
        return mirror ? Zero::mirror : Zero::back;
    }
    const auto any = [&](auto is) { return std::any_of(raw.begin(), raw.end(), is); };
    const bool both =
        any([](const auto& d) { return !std::isnan(d.phi_in) && !std::isnan(d.phi_out); });
    const bool turned = any([](const auto& d) { return d.theta_in < 0.0; });
    if (both || turned) {
        say(fmt::format("coordinates on the sample ({}): equal ones are back to the source",
                        both ? "both azimuths are there" : "theta_in is negative"));
        return Zero::coordinates;
    }
    // Along the normal there is no azimuth.
    const bool matters = any([&](const auto& d) {
        const bool in =
            std::isnan(d.theta_in) ? !(list.values[d.value].mu_in >= 1.0) : d.theta_in != 0.0;
        const bool out =
            std::isnan(d.theta_out) ? !(list.values[d.value].mu_out >= 1.0) : d.theta_out != 0.0;
        return in && out;
    });
    const bool known = any([&](const auto& d) {
        return !std::isnan(d.phi) || !std::isnan(d.phi_out) || d.theta_out < 0.0;
    });
    if (!matters || !known) return Zero::mirror;
    const double ratio = lobe_ratio(list, raw);
    if (ratio >= kLobeRatio || ratio <= 1.0 / kLobeRatio) {
        say(fmt::format(
            "0 = {}: values near the mirror direction there are {:.3g} times those "
            "opposite",
            ratio > 1.0 ? "mirror side" : "back to the source", std::max(ratio, 1.0 / ratio)));
        return ratio > 1.0 ? Zero::mirror : Zero::back;
    }
    refuse(file, 0,
           "what is azimuth 0: the mirror side, or back towards the source? The file does not say "
           "it and has no lobe that would show it; give the option azimuth-zero: mirror or back");
}

}  // namespace

void set_directions(Measurements& list, const std::vector<RawDirection>& raw,
                    const MeasuredOptions& options, const MeasuredFile& file) {
    for (const RawDirection& d : raw) {
        MeasuredValue& value = list.values[d.value];
        const auto check = [&](double theta, const char* name) {
            if (std::isnan(theta) || std::abs(theta) < 90.0) return;
            refuse(
                file, value.line,
                fmt::format("{} {} degrees; allowed: less than 90 from the normal", name, theta));
        };
        check(d.theta_in, "theta_in");
        check(d.theta_out, "theta_out");
        if (!std::isnan(d.theta_in)) value.mu_in = cosine_of(d.theta_in);
        if (!std::isnan(d.theta_out)) value.mu_out = cosine_of(d.theta_out);
        if (d.times_mu_out) value.value /= value.mu_out;
        if (!std::isnan(value.mu_out) && value.geometry == MeasuredGeometry::unknown)
            value.geometry = MeasuredGeometry::directions;
    }
    const bool has_azimuth = std::any_of(raw.begin(), raw.end(), [&](const auto& d) {
        return std::isnan(list.values[d.value].azimuth_deg) && !std::isnan(d.theta_out);
    });
    const bool turned = std::any_of(raw.begin(), raw.end(), [](const auto& d) {
        return d.theta_out < 0.0 || d.theta_in < 0.0;
    });
    if (!has_azimuth && !turned) return;
    const Zero zero = has_azimuth ? zero_of(list, raw, options, file) : Zero::mirror;
    // A positive theta_out without any azimuth lies where 0 is, if others are negative.
    const bool signed_plane =
        std::any_of(raw.begin(), raw.end(), [](const auto& d) { return d.theta_out < 0.0; });
    for (const RawDirection& d : raw) {
        MeasuredValue& value = list.values[d.value];
        const bool there = !std::isnan(d.phi) || !std::isnan(d.phi_out) || d.theta_out < 0.0 ||
                           d.theta_in < 0.0 || value.mu_in >= 1.0 || value.mu_out >= 1.0;
        if (!std::isnan(value.azimuth_deg)) {
            // A negative angle lies on the other side of the normal.
            if ((d.theta_out < 0.0) != (d.theta_in < 0.0))
                value.azimuth_deg = in_circle(value.azimuth_deg + 180.0);
            continue;
        }
        if (std::isnan(d.theta_out)) continue;
        double azimuth = relative_azimuth(d);
        if (zero == Zero::coordinates) {
            double phi_in = std::isnan(d.phi_in) ? 0.0 : d.phi_in;
            if (d.theta_in < 0.0) phi_in += 180.0;
            azimuth -= phi_in;
        }
        if (zero != Zero::mirror) azimuth = 180.0 - azimuth;
        if (there || signed_plane) value.azimuth_deg = in_circle(azimuth);
    }
}

}  // namespace miebrdf::measured
