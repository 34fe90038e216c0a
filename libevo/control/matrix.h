// Dense products in single precision whose bits are the same on every
// processor: vectorised over the columns of the result, each entry summed over
// k in ascending order, multiplication and addition rounded separately. Eigen
// stores the matrices but does not multiply them, because its summation order
// follows the width of the vectors.
#pragma once

#include <Eigen/Dense>

namespace evo {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::VectorXf;

// C += A B          A [m x k], B [k x n], C [m x n]
void add_product(const Matrix& a, const Matrix& b, Matrix& c);
// C += A B'         A [m x k], B [n x k], C [m x n]
void add_product_transposed_right(const Matrix& a, const Matrix& b, Matrix& c);
// C += A' B         A [k x m], B [k x n], C [m x n]
void add_product_transposed_left(const Matrix& a, const Matrix& b, Matrix& c);

// x := tanh(x), every entry; within 4e-7 of the true value, never above 1 in
// magnitude. NaN stays NaN.
void tanh_in_place(Matrix& x);

}  // namespace evo
