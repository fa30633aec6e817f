// Sums over partial waves at a few angles for a few spheres, in registers.
#pragma once

#include <cstddef>
#include <cstring>

#include "mie/sphere/vectors.h"

namespace miebrdf::mie {

/// Angles of one tile: with two registers of waves for each, all sums fit the machine's registers.
#if defined(__AVX512F__) || defined(__aarch64__)
constexpr int kAnglesPerTile = 12;
#else
constexpr int kAnglesPerTile = 6;
#endif
constexpr int kTileStep = 3;  // angles that a tile which is not full is rounded up to

/// Numbers in one register.
template <typename Scalar>
constexpr int kRegisterSize = kVectorSize* static_cast<int>(sizeof(double) / sizeof(Scalar));

template <typename Scalar>
struct RegisterOf;
template <>
struct RegisterOf<double> {
    using Type = Vector;
    using Half = double __attribute__((vector_size(kVectorSize * sizeof(double) / 2)));
};
template <>
struct RegisterOf<float> {
    using Type = float __attribute__((vector_size(kRegisterSize<float> * sizeof(float))));
    using Half = FloatVector;
};

/// Where a register of waves is at one order: whole registers of real and of imaginary parts, or
/// half of one each.
template <typename Scalar, bool kHalves>
struct WaveColumns {
    using Register = typename RegisterOf<Scalar>::Type;
    static constexpr int kRegisters = kHalves ? 1 : 2;
    static constexpr int kNumbers = kRegisters * kRegisterSize<Scalar>;  // of one order
    const Scalar *real, *imaginary;

    MIEBRDF_VECTOR void load(Register (&waves)[kRegisters]) const {
        if constexpr (kHalves) {
            typename RegisterOf<Scalar>::Half low, high;
            std::memcpy(&low, real, sizeof low);
            std::memcpy(&high, imaginary, sizeof high);
            waves[0] = joined<kRegisterSize<Scalar>>(low, high);
        } else {
            std::memcpy(&waves[0], real, sizeof(Register));
            std::memcpy(&waves[1], imaginary, sizeof(Register));
        }
    }
    MIEBRDF_VECTOR void advance(std::ptrdiff_t stride) {
        real += stride;
        imaginary += stride;
    }
    /// Puts `count` orders one behind the other.
    void copy(std::ptrdiff_t stride, int count, Scalar* to) const {
        WaveColumns from = *this;
        for (int n = 0; n < count; ++n, from.advance(stride), to += kNumbers) {
            Register waves[kRegisters];
            from.load(waves);
            std::memcpy(to, waves, sizeof waves);
        }
    }
};

/// Calls visit(angle, sums) for each angle of a tile: sum over `count` orders of functions times
/// waves, as many registers as `columns` has.
/// @param functions  of the tile, kAnglesPerTile for each order
/// @param stride     from the waves of one order to those of the next
template <int kAngles, typename Scalar, bool kHalves, typename Visit>
void visit_tile(const Scalar* functions, WaveColumns<Scalar, kHalves> columns,
                std::ptrdiff_t stride, int count, const Visit& visit) {
    using Columns = WaveColumns<Scalar, kHalves>;
    using Register = typename Columns::Register;
    Register sums[kAngles][Columns::kRegisters] = {};
    for (int n = 0; n < count; ++n) {
        Register waves[Columns::kRegisters];
        columns.load(waves);
        for (int angle = 0; angle < kAngles; ++angle) {
            for (int i = 0; i < Columns::kRegisters; ++i)
                sums[angle][i] += functions[angle] * waves[i];
        }
        functions += kAnglesPerTile;
        columns.advance(stride);
    }
    for (int angle = 0; angle < kAngles; ++angle) visit(angle, sums[angle]);
}

/// Calls visit() for the first `angles` of a tile, or a few more.
template <typename Scalar, bool kHalves, typename Visit>
void visit_angles(int angles, const Scalar* functions, const WaveColumns<Scalar, kHalves>& columns,
                  std::ptrdiff_t stride, int count, const Visit& visit) {
    if (angles <= kTileStep) {
        visit_tile<kTileStep>(functions, columns, stride, count, visit);
    } else if (kAnglesPerTile == 2 * kTileStep || angles <= 2 * kTileStep) {
        visit_tile<2 * kTileStep>(functions, columns, stride, count, visit);
    } else if (angles <= 3 * kTileStep) {
        visit_tile<3 * kTileStep>(functions, columns, stride, count, visit);
    } else {
        visit_tile<4 * kTileStep>(functions, columns, stride, count, visit);
    }
}

}  // namespace miebrdf::mie
