#include "tools/python/brdf_table.h"

#include <miebrdf/brdf_source.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include <pybind11/stl.h>

namespace miebrdf::python {
namespace {

/// Directions that are brought into an order together: some for each cell of the table.
constexpr py::ssize_t kOrdered = 8192;
/// Directions at a time: few enough for their values to stay in the processor's cache.
constexpr py::ssize_t kChunk = 256;
/// Fewer directions than this are done before a thread of their own would have started.
constexpr py::ssize_t kShortCall = 20000;

/// Steps through arrays of one shape in C order, whatever their strides.
class Walk {
  public:
    explicit Walk(std::initializer_list<const NumberArray*> arrays) {
        const NumberArray& first = **arrays.begin();
        shape_.assign(first.shape(), first.shape() + first.ndim());
        at_.assign(shape_.size(), 0);
        for (const NumberArray* array : arrays) {
            if (array->ndim() != first.ndim() ||
                !std::equal(shape_.begin(), shape_.end(), array->shape()))
                throw UsageError("the arrays of directions differ in shape");
            place_.push_back(reinterpret_cast<const char*>(array->data()));
            strides_.emplace_back(array->strides(), array->strides() + array->ndim());
        }
    }

    py::ssize_t count() const {
        py::ssize_t product = 1;
        for (const py::ssize_t length : shape_) product *= length;
        return product;
    }

    double operator[](std::size_t array) const {
        double value;
        std::memcpy(&value, place_[array], sizeof value);  // may not be aligned
        return value;
    }

    void next() {
        for (std::size_t d = shape_.size(); d-- > 0;) {
            ++at_[d];
            for (std::size_t a = 0; a < place_.size(); ++a) place_[a] += strides_[a][d];
            if (at_[d] < shape_[d]) return;
            for (std::size_t a = 0; a < place_.size(); ++a) place_[a] -= strides_[a][d] * shape_[d];
            at_[d] = 0;
        }
    }

  private:
    std::vector<py::ssize_t> shape_, at_;
    std::vector<const char*> place_;
    std::vector<std::vector<py::ssize_t>> strides_;
};

/// Runs at once, or watched when it takes longer.
void run_for(py::ssize_t count, const CallOptions& options,
             const std::function<void(const Control&)>& work) {
    if (count < kShortCall) {
        const py::gil_scoped_release unlocked;
        work({});
        return;
    }
    LongCall call(options);
    call.run([&] {
        work(call.control());
        return true;
    });
}

/// Directions in an order in which those of near cosines follow each other: a table of many
/// azimuthal orders is larger than the nearest caches, and neighbours share most of what they read.
class NearOrder {
  public:
    /// Keeps the order of directions that share their cosines mostly: they are evaluated together.
    void arrange(std::span<const Direction> directions) {
        const std::size_t count = directions.size();
        std::size_t changes = 0;
        for (std::size_t i = 1; i < count; ++i)
            changes += directions[i].mu_in != directions[i - 1].mu_in ||
                       directions[i].mu_out != directions[i - 1].mu_out;
        order.resize(count);
        if (2 * changes < count) {
            std::iota(order.begin(), order.end(), 0U);
            return;
        }
        cell_.resize(count);
        std::array<std::uint32_t, kCells + 1> start = {};
        for (std::size_t i = 0; i < count; ++i) {
            cell_[i] = step_of(directions[i].mu_in) * kSteps + step_of(directions[i].mu_out);
            ++start[cell_[i] + 1];
        }
        std::partial_sum(start.begin(), start.end(), start.begin());
        for (std::size_t i = 0; i < count; ++i)
            order[start[cell_[i]]++] = static_cast<std::uint32_t>(i);
    }

    std::vector<std::uint32_t> order;

  private:
    static constexpr std::size_t kSteps = 32;
    static constexpr std::size_t kCells = kSteps * kSteps;
    static std::size_t step_of(double mu) {
        return std::min(static_cast<std::size_t>(mu * kSteps), kSteps - 1);
    }

    std::vector<std::size_t> cell_;
};

void refuse_cancelled(const Control& control) {
    if (control.is_cancelled && control.is_cancelled()) throw Cancelled();
}

}  // namespace

void SolvedTable::evaluate(const NumberArray& mu_in, const NumberArray& mu_out,
                           const NumberArray& azimuth_deg, NumberArray out,
                           const CallOptions& options) const {
    const auto wavelengths = static_cast<py::ssize_t>(table_.channels().size());
    Walk walk({&mu_in, &mu_out, &azimuth_deg});
    const py::ssize_t count = walk.count();
    if (out.size() != wavelengths * count || (out.flags() & py::array::c_style) == 0 ||
        !out.writeable()) {
        throw UsageError("out: a writeable, C-contiguous array of " +
                         std::to_string(wavelengths * count) + " numbers is needed");
    }
    double* const target = out.mutable_data();
    run_for(count * wavelengths, options, [&](const Control& control) {
        std::vector<Direction> directions, storage, near;
        std::vector<double> values(static_cast<std::size_t>(kChunk * wavelengths));
        NearOrder near_order;
        const std::vector<std::uint32_t>& order = near_order.order;
        for (py::ssize_t first = 0; first < count; first += kOrdered) {
            refuse_cancelled(control);
            const py::ssize_t some = std::min(kOrdered, count - first);
            directions.clear();
            storage.clear();
            for (py::ssize_t d = 0; d < some; ++d, walk.next())
                directions.push_back({walk[0], walk[1], walk[2]});
            const auto valid = require_valid(directions, directions.size(), 1, storage);
            near_order.arrange(valid);
            for (std::size_t done = 0; done < order.size(); done += near.size()) {
                const auto chunk = std::span(order).subspan(done).first(
                    std::min<std::size_t>(kChunk, order.size() - done));
                near.clear();
                for (const std::uint32_t d : chunk) near.push_back(valid[d]);
                table_.evaluate(near,
                                std::span(values).first(near.size() * std::size_t(wavelengths)));
                for (py::ssize_t w = 0; w < wavelengths; ++w) {
                    double* const row = target + w * count + first;
                    for (std::size_t d = 0; d < chunk.size(); ++d)
                        row[chunk[d]] = values[d * std::size_t(wavelengths) + std::size_t(w)];
                }
            }
        }
    });
}

DirectionSampler SolvedTable::sampler(std::vector<double> weights,
                                      const CallOptions& options) const {
    LongCall call(options);
    return call.run(
        [&] { return DirectionSampler(table_, {.weights = std::move(weights)}, call.control()); });
}

namespace {

/// @returns  (mu_out, azimuth_deg, density), each of the shape of the arguments
py::tuple sample(const DirectionSampler& sampler, const NumberArray& mu_in, const NumberArray& u1,
                 const NumberArray& u2) {
    Walk walk({&mu_in, &u1, &u2});
    const std::vector<py::ssize_t> shape(mu_in.shape(), mu_in.shape() + mu_in.ndim());
    NumberArray mu_out(shape), azimuth_deg(shape), density(shape);
    double* const mu = mu_out.mutable_data();
    double* const azimuth = azimuth_deg.mutable_data();
    double* const pdf = density.mutable_data();
    run_for(walk.count(), {.threads = 1, .progress = py::none()}, [&](const Control& control) {
        const py::ssize_t count = walk.count();
        for (py::ssize_t i = 0; i < count; ++i, walk.next()) {
            if (i % kChunk == 0) refuse_cancelled(control);
            const SampledDirection drawn = sampler.sample(walk[0], walk[1], walk[2]);
            mu[i] = drawn.mu_out;
            azimuth[i] = drawn.azimuth_deg;
            pdf[i] = drawn.density;
        }
    });
    return py::make_tuple(mu_out, azimuth_deg, density);
}

NumberArray density_of(const DirectionSampler& sampler, const NumberArray& mu_in,
                       const NumberArray& mu_out, const NumberArray& azimuth_deg) {
    Walk walk({&mu_in, &mu_out, &azimuth_deg});
    NumberArray density(std::vector<py::ssize_t>(mu_in.shape(), mu_in.shape() + mu_in.ndim()));
    double* const pdf = density.mutable_data();
    run_for(walk.count(), {.threads = 1, .progress = py::none()}, [&](const Control& control) {
        const py::ssize_t count = walk.count();
        for (py::ssize_t i = 0; i < count; ++i, walk.next()) {
            if (i % kChunk == 0) refuse_cancelled(control);
            pdf[i] = sampler.density(walk[0], walk[1], walk[2]);
        }
    });
    return density;
}

}  // namespace

void bind_sampler(py::module_& module) {
    py::class_<DirectionSampler>(module, "DirectionSampler")
        .def("sample", &sample, py::arg("mu_in"), py::arg("u1"), py::arg("u2"))
        .def("density", &density_of, py::arg("mu_in"), py::arg("mu_out"), py::arg("azimuth_deg"));
}

}  // namespace miebrdf::python
