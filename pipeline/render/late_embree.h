// Embree's functions, loaded when they are called first (materials/libraries/late_library.h): its
// tables for every kind of processor take the loader longer than all that other commands need.
#pragma once

#include <embree3/rtcore.h>

#include "materials/libraries/late_library.h"

namespace miebrdf::render {

inline const LateLibrary& libembree() {
    static const LateLibrary library(MIEBRDF_LATE_EMBREE);
    return library;
}

}  // namespace miebrdf::render

// clang-format off
#define rtcAttachGeometryByID(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcAttachGeometryByID)(__VA_ARGS__)
#define rtcCommitGeometry(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcCommitGeometry)(__VA_ARGS__)
#define rtcCommitScene(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcCommitScene)(__VA_ARGS__)
#define rtcGetDeviceError(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcGetDeviceError)(__VA_ARGS__)
#define rtcGetGeometry(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcGetGeometry)(__VA_ARGS__)
#define rtcInterpolate(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcInterpolate)(__VA_ARGS__)
#define rtcIntersect1(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcIntersect1)(__VA_ARGS__)
#define rtcNewDevice(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcNewDevice)(__VA_ARGS__)
#define rtcNewGeometry(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcNewGeometry)(__VA_ARGS__)
#define rtcNewScene(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcNewScene)(__VA_ARGS__)
#define rtcOccluded1(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcOccluded1)(__VA_ARGS__)
#define rtcReleaseDevice(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcReleaseDevice)(__VA_ARGS__)
#define rtcReleaseGeometry(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcReleaseGeometry)(__VA_ARGS__)
#define rtcReleaseScene(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcReleaseScene)(__VA_ARGS__)
#define rtcSetGeometryVertexAttributeCount(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcSetGeometryVertexAttributeCount)(__VA_ARGS__)
#define rtcSetNewGeometryBuffer(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcSetNewGeometryBuffer)(__VA_ARGS__)
#define rtcSetSceneFlags(...) MIEBRDF_LATE(::miebrdf::render::libembree(), rtcSetSceneFlags)(__VA_ARGS__)
// clang-format on
