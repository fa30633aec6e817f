// Everything: from names of materials to a spectral BRDF and the files made of it.
//
//     const auto brdf = miebrdf::solve({.base = miebrdf::medium("TiO2,radius=0.2")}, {550});
//     brdf.evaluate({{0.5}, {0.3, 0.9}, {0, 180}}).at(0, 0, 1, 0);   // 1/sr
//
// "docs/..." in comments is share/doc/miebrdf/docs of an installation. What a version promises:
// docs/versions.md.
#pragma once

#include <miebrdf/brdf.h>
#include <miebrdf/brdf_source.h>
#include <miebrdf/colour.h>
#include <miebrdf/control.h>
#include <miebrdf/database.h>
#include <miebrdf/ensemble.h>
#include <miebrdf/error.h>
#include <miebrdf/fit.h>
#include <miebrdf/formats.h>
#include <miebrdf/index.h>
#include <miebrdf/language.h>
#include <miebrdf/layer_albedos.h>
#include <miebrdf/matrix_expansion.h>
#include <miebrdf/measured.h>
#include <miebrdf/optics.h>
#include <miebrdf/plan.h>
#include <miebrdf/processor_path.h>
#include <miebrdf/sampling.h>
#include <miebrdf/scene.h>
#include <miebrdf/sizes.h>
#include <miebrdf/solver.h>
#include <miebrdf/sphere.h>
#include <miebrdf/surface.h>
#include <miebrdf/table1.h>
#include <miebrdf/transfer.h>
#include <miebrdf/value_derivatives.h>
#include <miebrdf/version.h>
