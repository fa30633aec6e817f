// Small matrices side by side: element (i, j) of four or eight of them in one register. What keeps
// a product of 12 x 12 from the processor's peak (tails of rows, copies into the order that loops
// want) is then gone. Only where the compiler is told of registers that hold four or eight doubles.
#pragma once

#if defined(__AVX__)
#define MIEBRDF_HAS_FOUR_DOUBLES
#endif
#if defined(__AVX512F__)
#define MIEBRDF_HAS_EIGHT_DOUBLES
#endif

#ifdef MIEBRDF_HAS_FOUR_DOUBLES

#include <type_traits>

namespace miebrdf::math {

typedef double FourDoubles __attribute__((vector_size(32)));
#ifdef MIEBRDF_HAS_EIGHT_DOUBLES
typedef double EightDoubles __attribute__((vector_size(64)));
#endif

/// How many matrices go side by side.
template <typename Doubles>
inline constexpr int kLanes = int(sizeof(Doubles) / sizeof(double));

template <typename Doubles>
inline Doubles absolute(Doubles x) {
    return x < 0.0 ? -x : x;
}
template <typename Doubles>
inline Doubles larger(Doubles x, Doubles y) {
    return x > y ? x : y;
}

/// Matrices stored by columns: elements (i, j) at data[i + j * stride].
template <typename Doubles>
struct Columns {
    const Doubles* data;
    int stride;
};

/// Matrices stored in any order: elements (i, j) at data[i * down + j * right].
template <typename Doubles>
struct Strided {
    const Doubles* data;
    int down, right;
};

/// A tile of `rows` x `columns` of target = A B or target += A B, in registers.
template <int rows, int columns, bool add, typename Doubles>
inline void set_tile(const Columns<Doubles>& A, const Strided<Doubles>& B, int inner,
                     Doubles* target, int stride) {
    Doubles sum[rows][columns];
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) sum[i][j] = add ? target[i + j * stride] : Doubles{};
    const Doubles *a = A.data, *b = B.data;
    for (int k = 0; k < inner; ++k, a += A.stride, b += B.down)
        for (int j = 0; j < columns; ++j)
            for (int i = 0; i < rows; ++i) sum[i][j] += a[i] * b[j * B.right];
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) target[i + j * stride] = sum[i][j];
}

template <int columns, bool add, typename Doubles>
inline void set_tiles(Columns<Doubles> A, const Strided<Doubles>& B, int inner, Doubles* target,
                      int rows, int stride) {
    for (; rows >= 4; rows -= 4, A.data += 4, target += 4)
        set_tile<4, columns, add>(A, B, inner, target, stride);
    if (rows == 3) set_tile<3, columns, add>(A, B, inner, target, stride);
    if (rows == 2) set_tile<2, columns, add>(A, B, inner, target, stride);
    if (rows == 1) set_tile<1, columns, add>(A, B, inner, target, stride);
}

/// Columns of a tile of four rows: all its sums and what they are made of fit 16 registers, or 32.
#if defined(__AVX512VL__)
inline constexpr int kTileColumns = 4;
#else
inline constexpr int kTileColumns = 3;
#endif

/// Which elements of a product are wanted.
enum class Part { all, lower };

/// target = A B or target += A B, A being rows x inner and B inner x columns. The target is stored
/// by columns, element (i, j) at target[i + j * stride], and overlaps neither. Of `Part::lower`
/// some above the diagonal are set, too.
template <bool add, Part part = Part::all, typename Doubles>
void multiply_each(Columns<Doubles> A, Strided<Doubles> B, Doubles* target, int rows, int inner,
                   int columns, int stride) {
    const auto next_columns = [&]<int width>(std::integral_constant<int, width>) {
        set_tiles<width, add>(A, B, inner, target, rows, stride);
        columns -= width;
        B.data += width * B.right;
        target += width * stride;
        if (part == Part::all) return;
        A.data += width;
        target += width;
        rows -= width;
    };
    // A last column by itself would wait for each of its sums.
    while (columns >= kTileColumns && columns != kTileColumns + 1)
        next_columns(std::integral_constant<int, kTileColumns>{});
    while (columns >= 2) next_columns(std::integral_constant<int, 2>{});
    if (columns == 1) next_columns(std::integral_constant<int, 1>{});
}

/// The same of matrices that are all stored by columns.
template <bool add, typename Doubles>
void multiply_each(const Doubles* A, const Doubles* B, Doubles* target, int rows, int inner,
                   int columns) {
    multiply_each<add>(Columns<Doubles>{A, rows}, Strided<Doubles>{B, 1, inner}, target, rows,
                       inner, columns, rows);
}

/// The inverses of symmetric positive definite matrices, in place: n x n, of which the lower
/// triangle is read; of Part::lower only that is set. Each step eliminates two rows (the last of an
/// odd number one) from two columns at a time, so that an element is read and written n / 2 times.
/// @param columns  memory for 2 n
template <Part part = Part::all, typename Doubles>
void invert_each(Doubles* A, int n, Doubles* columns) {
    Doubles *c = columns, *d = columns + n;
    int k = 0;
    for (; k + 2 <= n; k += 2) {
        for (int i = 0; i < k; ++i) {
            c[i] = A[k + i * n];
            d[i] = A[k + 1 + i * n];
        }
        for (int i = k; i < n; ++i) {
            c[i] = A[i + k * n];
            d[i] = A[i + (k + 1) * n];
        }
        const Doubles above = c[k], side = c[k + 1], below = d[k + 1];
        const Doubles over = 1.0 / (above * below - side * side);
        const Doubles p = below * over, q = -side * over, r = above * over;
        c[k] = d[k] = c[k + 1] = d[k + 1] = Doubles{};
        int j = 0;
        for (; j + 2 <= n; j += 2) {
            const Doubles e = c[j] * p + d[j] * q, f = c[j] * q + d[j] * r;
            const Doubles g = c[j + 1] * p + d[j + 1] * q, h = c[j + 1] * q + d[j + 1] * r;
            Doubles *column = A + j * n, *next = column + n;
            for (int i = j; i < n; ++i) {
                column[i] -= c[i] * e + d[i] * f;
                next[i] -= c[i] * g + d[i] * h;
            }
            if (j < k) {
                column[k] = e;
                column[k + 1] = f;
                next[k] = g;
                next[k + 1] = h;
            } else {
                A[j + k * n] = e;
                A[j + (k + 1) * n] = f;
                A[j + 1 + k * n] = g;
                A[j + 1 + (k + 1) * n] = h;
            }
        }
        if (j < n) {  // the last of an odd number, which comes after k
            const Doubles e = c[j] * p + d[j] * q, f = c[j] * q + d[j] * r;
            A[j + j * n] -= c[j] * e + d[j] * f;
            A[j + k * n] = e;
            A[j + (k + 1) * n] = f;
        }
        A[k + k * n] = -p;
        A[k + 1 + k * n] = -q;
        A[k + 1 + (k + 1) * n] = -r;
    }
    if (k < n) {
        for (int i = 0; i < k; ++i) c[i] = A[k + i * n];
        const Doubles over = 1.0 / A[k + k * n];
        for (int j = 0; j < k; ++j) {
            const Doubles e = c[j] * over;
            for (int i = j; i < k; ++i) A[i + j * n] -= c[i] * e;
            A[k + j * n] = e;
        }
        A[k + k * n] = -over;
    }
    for (int j = 0; j < n; ++j) {
        for (int i = j; i < n; ++i) {
            A[i + j * n] = -A[i + j * n];
            if (part == Part::all) A[j + i * n] = A[i + j * n];
        }
    }
}

/// Solves S y = y for symmetric positive definite S by eliminating two rows at a time; both are
/// overwritten.
/// @param S  n x n, of which the lower triangle is read
template <typename Doubles>
void solve_each(Doubles* S, Doubles* y, int n) {
    int k = 0;
    for (; k + 2 <= n; k += 2) {
        Doubles *c = S + k * n, *d = c + n;
        const Doubles over = 1.0 / (c[k] * d[k + 1] - c[k + 1] * c[k + 1]);
        const Doubles p = d[k + 1] * over, q = -c[k + 1] * over, r = c[k] * over;
        c[k] = p;
        c[k + 1] = q;
        d[k + 1] = r;
        const Doubles y_c = p * y[k] + q * y[k + 1], y_d = q * y[k] + r * y[k + 1];
        y[k] = y_c;
        y[k + 1] = y_d;
        for (int j = k + 2; j < n; ++j) {
            const Doubles e = c[j] * p + d[j] * q, f = c[j] * q + d[j] * r;
            Doubles* column = S + j * n;
            for (int i = j; i < n; ++i) column[i] -= c[i] * e + d[i] * f;
            y[j] -= c[j] * y_c + d[j] * y_d;
        }
    }
    if (k < n) y[k] /= S[k + k * n];
    // What is left of the pairs above: y_k -= P S_kj y_j, P the inverse of their diagonal block.
    for (k -= 2; k >= 0; k -= 2) {
        const Doubles *c = S + k * n, *d = c + n;
        Doubles from_c = {}, from_d = {};
        for (int j = k + 2; j < n; ++j) {
            from_c += c[j] * y[j];
            from_d += d[j] * y[j];
        }
        y[k] -= c[k] * from_c + c[k + 1] * from_d;
        y[k + 1] -= c[k + 1] * from_c + d[k + 1] * from_d;
    }
}

}  // namespace miebrdf::math

#endif
