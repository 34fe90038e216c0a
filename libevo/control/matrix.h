// Dense products in single precision whose bits are the same on every
// processor: vectorised over the columns of the result, each entry summed over
// k in ascending order, multiplication and addition rounded separately. Eigen
// stores the matrices but does not multiply them, because its summation order
// follows the width of the vectors.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace evo {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::VectorXf;
// A matrix or a block of one, which is not copied.
using MatrixView = Eigen::Ref<const Matrix, 0, Eigen::OuterStride<>>;
using MatrixBlock = Eigen::Ref<Matrix, 0, Eigen::OuterStride<>>;

// Eigen's own comparison takes equal sizes for granted. This one, which defaulted comparisons of
// the structures below find, does not.
template <typename Scalar, int rows, int cols, int options>
bool operator==(const Eigen::Matrix<Scalar, rows, cols, options>& a,
                const Eigen::Matrix<Scalar, rows, cols, options>& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a.cwiseEqual(b).all();
}

// C += A B          A [m x k], B [k x n], C [m x n]
void add_product(const MatrixView& a, const MatrixView& b, MatrixBlock c);
// C += A B'         A [m x k], B [n x k], C [m x n]
void add_product_transposed_right(const MatrixView& a, const MatrixView& b, MatrixBlock c);
// C += A' B         A [k x m], B [k x n], C [m x n]
void add_product_transposed_left(const MatrixView& a, const MatrixView& b, MatrixBlock c);

// A matrix of mostly zeros: of row i the entries [first[i], first[i + 1]), columns ascending.
struct SparseMatrix {
  struct Entry {
    Eigen::Index column;
    float value;
  };
  std::vector<Entry> entries;
  std::vector<std::size_t> first = {0};
  Eigen::Index columns = 0;
  Eigen::Index rows() const { return std::ssize(first) - 1; }
  void add_row(const Eigen::Ref<const Eigen::RowVectorXf>& row);
};
// The bits of the dense products, where C had no -0.
void add_product(const SparseMatrix& a, const Matrix& b, Matrix& c);
void add_product_transposed_left(const SparseMatrix& a, const Matrix& b, Matrix& c);

// x := tanh(x), every entry; within 4e-7 of the true value, never above 1 in
// magnitude. NaN stays NaN.
void tanh_in_place(Matrix& x);
}  // namespace evo
