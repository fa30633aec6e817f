// Any bytes as a BRDF file of one format: an InputError or a file that can be evaluated.
#include <cstddef>
#include <cstdint>
#include <vector>

#include <miebrdf/brdf_source.h>
#include <miebrdf/formats.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace miebrdf;
    try {
        const auto file =
            find_format(MIEBRDF_FORMAT).reader.read({reinterpret_cast<const char*>(data), size});
        std::vector<double> values(file->channels().size());
        for (const double mu : {1e-9, 0.3, 1.0}) {
            file->evaluate({mu, 0.7, 200.0}, values);
            file->sample(mu, 0.5, 0.25);
            file->density({mu, 0.7, 200.0});
        }
    } catch (const InputError&) {
    }
    return 0;
}
