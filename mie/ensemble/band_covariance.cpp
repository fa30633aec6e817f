#include "mie/ensemble/band_covariance.h"

#include <algorithm>

namespace miebrdf::mie {
namespace {

// Rows of a tile: products of tile x (tile + width) blocks waste half a tile squared each, but
// narrower ones run slower.
constexpr int tile_rows = 32;

template <typename Waves>
void add_band(const Waves& waves, int terms, int columns, BandCovariance::Matrix& band) {
    const int width = static_cast<int>(band.cols()) - 1;
    Waves tile;
    for (int n = 1; n <= terms; n += tile_rows) {
        const int rows = std::min(tile_rows, terms - n + 1);
        const int reach = std::min(rows + width, terms - n + 1);
        tile.noalias() =
            waves.block(n, 0, rows, columns) * waves.block(n, 0, reach, columns).transpose();
        for (int i = 0; i < rows; ++i) {
            const int count = std::min(width + 1, reach - i);
            band.row(n + i).head(count) += tile.row(i).segment(i, count).template cast<double>();
        }
    }
}

}  // namespace

BandCovariance::BandCovariance(int terms, int width)
    : plus_(Matrix::Zero(terms + 1, width + 1)), minus_(plus_) {}

template <typename Scalar>
void BandCovariance::add(const SphereBlockOf<Scalar>& block) {
    const int columns = 2 * block.size;
    add_band(block.U, block.terms, columns, plus_);
    add_band(block.V, block.terms, columns, minus_);
}

template void BandCovariance::add(const SphereBlockOf<float>&);
template void BandCovariance::add(const SphereBlockOf<double>&);

void BandCovariance::add(const BandCovariance& other) {
    plus_ += other.plus_;
    minus_ += other.minus_;
}

void BandCovariance::scale(double factor) {
    plus_ *= factor;
    minus_ *= factor;
}

}  // namespace miebrdf::mie
