#include "pipeline/solve/packed_optics.h"

#include <miebrdf/ensemble.h>
#include "pipeline/cache/packed_numbers.h"

namespace miebrdf {
namespace {

void pack_table(const mie::PhaseTable::Parts& parts, NumberPacker& packer) {
    packer.add(parts.edges).add(parts.coefficients);
    packer.add(parts.mean).add(parts.interpolation_error).add(parts.size_error);
    packer.add(parts.noise).add(parts.noise_floor);
}

mie::PhaseTable unpack_table(NumberUnpacker& unpacker) {
    mie::PhaseTable::Parts parts;
    parts.edges = unpacker.list();
    parts.coefficients = unpacker.list();
    parts.mean = unpacker.number();
    parts.interpolation_error = unpacker.number();
    parts.size_error = unpacker.number();
    parts.noise = unpacker.list();
    parts.noise_floor = unpacker.number();
    return mie::PhaseTable(std::move(parts));
}

}  // namespace

std::vector<double> packed(const MediumOptics& optics) {
    const rte::Optics& o = optics.optics;
    NumberPacker packer;
    packer.add(optics.refractive_index ? 1 : 0);
    if (optics.refractive_index) {
        packer.add(optics.refractive_index->real()).add(optics.refractive_index->imag());
    }
    packer.add(o.single_scattering_albedo).add(o.one_minus_albedo).add(o.chi);
    packer.add(o.has_more_moments ? 1 : 0).add(optics.phase).add(optics.asymmetry);
    packer.add(optics.q_ext ? 1 : 0).add(optics.q_ext.value_or(0.0));
    packer.add(optics.error_estimate).add(optics.converged ? 1 : 0);
    const auto* table = o.phase.target<mie::PhaseTable>();
    packer.add(table != nullptr ? 1 : 0);
    if (table != nullptr) pack_table(table->parts(), packer);
    return packer.numbers();
}

MediumOptics unpacked_optics(const std::vector<double>& numbers) {
    NumberUnpacker unpacker(numbers);
    MediumOptics optics;
    if (unpacker.number() == 1) {
        const double n = unpacker.number();
        optics.refractive_index = {n, unpacker.number()};
    }
    rte::Optics& o = optics.optics;
    o.single_scattering_albedo = unpacker.number();
    o.one_minus_albedo = unpacker.number();
    o.chi = unpacker.list();
    o.has_more_moments = unpacker.number() == 1;
    optics.phase = unpacker.list();
    optics.asymmetry = unpacker.number();
    const bool has_extinction = unpacker.number() == 1;
    const double q_ext = unpacker.number();
    if (has_extinction) optics.q_ext = q_ext;
    optics.error_estimate = unpacker.number();
    optics.converged = unpacker.number() == 1;
    if (unpacker.number() == 1) o.phase = unpack_table(unpacker);
    return optics;
}

}  // namespace miebrdf
