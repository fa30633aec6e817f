// Units in which optical constants are tabulated, and their conversion to vacuum wavelength.
#pragma once

#include <optional>
#include <string_view>

#include <miebrdf/index.h>

namespace miebrdf::materials {

/// h c in eV nm, the value the tables in circulation were converted with (CODATA 2018 has
/// 1239.84198433; the two differ by 3e-10).
inline constexpr double kPlanckTimesLightEvNm = 1239.841984;
/// Speed of light in nm THz (exact).
inline constexpr double kLightNmThz = 299792.458;

/// Reads a unit as people write it, in any case: also "A", "micron", "wavenumber", "1/cm", ...
std::optional<Unit> parse_unit(std::string_view text);

/// True for eV, cm-1 and THz, where a larger number is a shorter wavelength.
bool is_reciprocal(Unit unit);

/// The number that `to_nm` turns into exactly this wavelength: conversion there and back rounds
/// twice, so the neighbours of `from_nm` are tried. Where doubles in the unit are coarser than in
/// nm no such number may exist; then the nearest is returned.
double from_nm_exactly(double wavelength_nm, Unit unit);

/// A wavelength with its unit: "550", "550nm", "0.55 um", "5500A", "2.25eV", "18182cm-1", "545THz".
/// @throws UsageError  when it is no positive finite number with a known unit
double parse_wavelength_nm(std::string_view text, Unit without_unit = Unit::nanometre);

/// The whole text as a number in any locale, or nothing.
std::optional<double> parse_number(std::string_view text);

}  // namespace miebrdf::materials
