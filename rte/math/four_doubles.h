// Small matrices side by side: element (i, j) of four of them in one register. What keeps a product
// of 12 x 12 from the processor's peak (tails of rows, copies into the order that loops want) is
// then gone. Only where registers hold four doubles.
#pragma once

#if defined(__AVX__)
#define MIEBRDF_HAS_FOUR_DOUBLES

namespace miebrdf::math {

typedef double FourDoubles __attribute__((vector_size(32)));

inline FourDoubles absolute(FourDoubles x) { return x < 0.0 ? -x : x; }
inline FourDoubles larger(FourDoubles x, FourDoubles y) { return x > y ? x : y; }

/// A tile of `rows` x `columns` of target = A B or target += A B, in registers.
template <int rows, int columns, bool add>
inline void set_tile(const FourDoubles* A, const FourDoubles* B, FourDoubles* target, int A_rows,
                     int B_rows) {
    FourDoubles sum[rows][columns];
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) sum[i][j] = add ? target[i + j * A_rows] : FourDoubles{};
    for (int k = 0; k < B_rows; ++k)
        for (int j = 0; j < columns; ++j)
            for (int i = 0; i < rows; ++i) sum[i][j] += A[i + k * A_rows] * B[k + j * B_rows];
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) target[i + j * A_rows] = sum[i][j];
}

template <int columns, bool add>
inline void set_tiles(const FourDoubles* A, const FourDoubles* B, FourDoubles* target, int A_rows,
                      int B_rows) {
    int i = 0;
    for (; i + 4 <= A_rows; i += 4) set_tile<4, columns, add>(A + i, B, target + i, A_rows, B_rows);
    switch (A_rows - i) {
        case 3:
            set_tile<3, columns, add>(A + i, B, target + i, A_rows, B_rows);
            break;
        case 2:
            set_tile<2, columns, add>(A + i, B, target + i, A_rows, B_rows);
            break;
        case 1:
            set_tile<1, columns, add>(A + i, B, target + i, A_rows, B_rows);
            break;
        default:
            break;
    }
}

/// target = A B or target += A B, all stored by columns: A is A_rows x B_rows, B is B_rows x
/// B_columns. The target overlaps neither.
template <bool add>
void multiply_four(const FourDoubles* A, const FourDoubles* B, FourDoubles* target, int A_rows,
                   int B_rows, int B_columns) {
    int j = 0;
    for (; j + 4 <= B_columns; j += 4)
        set_tiles<4, add>(A, B + j * B_rows, target + j * A_rows, A_rows, B_rows);
    switch (B_columns - j) {
        case 3:
            set_tiles<3, add>(A, B + j * B_rows, target + j * A_rows, A_rows, B_rows);
            break;
        case 2:
            set_tiles<2, add>(A, B + j * B_rows, target + j * A_rows, A_rows, B_rows);
            break;
        case 1:
            set_tiles<1, add>(A, B + j * B_rows, target + j * A_rows, A_rows, B_rows);
            break;
        default:
            break;
    }
}

}  // namespace miebrdf::math

#endif
