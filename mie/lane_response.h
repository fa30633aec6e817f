// a_n and b_n of eight spheres from the parts of their fractions.
#pragma once

#include "mie/lanes.h"

namespace miebrdf::mie {

/// a_n or b_n: p / (p + i q), and 1 / |p + i q|^2 for the absorption.
struct Response {
    ComplexLanes value;
    Lanes inverse_norm;
};

/// Both at once: they share the one division.
inline void respond(const Lanes& pa, const Lanes& qa, const Lanes& pb, const Lanes& qb, Response& a,
                    Response& b) {
    const Lanes norm_a = pa * pa + qa * qa;
    const Lanes norm_b = pb * pb + qb * qb;
    const Lanes shared = 1 / (norm_a * norm_b);
    const Lanes factor_a = pa * norm_b * shared;
    const Lanes factor_b = pb * norm_a * shared;
    a.value = {pa * factor_a, -qa * factor_a};
    b.value = {pb * factor_b, -qb * factor_b};
}

inline void respond(const ComplexLanes& pa, const ComplexLanes& qa, const ComplexLanes& pb,
                    const ComplexLanes& qb, Response& a, Response& b) {
    const ComplexLanes da = {pa.re - qa.im, pa.im + qa.re};
    const ComplexLanes db = {pb.re - qb.im, pb.im + qb.re};
    const Lanes norm_a = norm(da);
    const Lanes norm_b = norm(db);
    const Lanes shared = 1 / (norm_a * norm_b);
    a.inverse_norm = norm_b * shared;
    b.inverse_norm = norm_a * shared;
    a.value = {(pa.re * da.re + pa.im * da.im) * a.inverse_norm,
               (pa.im * da.re - pa.re * da.im) * a.inverse_norm};
    b.value = {(pb.re * db.re + pb.im * db.im) * b.inverse_norm,
               (pb.im * db.re - pb.re * db.im) * b.inverse_norm};
}

}  // namespace miebrdf::mie
