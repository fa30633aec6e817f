// libFuzzer entry; MIEBRDF_FUZZ_READER names the reader.
#include <cstddef>
#include <cstdint>

#include "tests/materials/fuzz/fuzz_readers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    miebrdf::materials::fuzz::check(MIEBRDF_FUZZ_READER,
                                    {reinterpret_cast<const char*>(data), size});
    return 0;
}
