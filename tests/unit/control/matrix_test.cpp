#include "libevo/control/matrix.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "libevo/base/random.h"
#include "tests/unit/sim/fixtures.h"

using evo::Matrix;

namespace {

Matrix random_matrix(Eigen::Index rows, Eigen::Index cols, evo::Stream& stream) {
  Matrix m(rows, cols);
  for (Eigen::Index i = 0; i < m.size(); ++i) m.data()[i] = static_cast<float>(stream.gaussian());
  return m;
}

// The definition: k ascending, product and sum rounded to single precision.
Matrix by_definition(const Matrix& a, const Matrix& b, Matrix c) {
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index j = 0; j < b.cols(); ++j)
      for (Eigen::Index k = 0; k < a.cols(); ++k) {
        const float product = a(i, k) * b(k, j);
        c(i, j) += product;
      }
  return c;
}

}  // namespace

TEST_CASE("products have the bits of their definition on every instruction set") {
  evo::Stream stream(1, "matrix");
  const auto [m, n, k] = GENERATE(table<int, int, int>({{1, 1, 1},
                                                        {4, 64, 61},
                                                        {128, 64, 64},
                                                        {7, 33, 600},
                                                        {13, 10, 5},
                                                        {128, 1, 64},
                                                        {8, 23, 70},
                                                        {14, 64, 66},
                                                        {2, 17, 257}}));
  const Matrix a = random_matrix(m, k, stream);
  const Matrix b = random_matrix(k, n, stream);
  const Matrix c = random_matrix(m, n, stream);
  const Matrix expected = by_definition(a, b, c);
  evo::for_each_isa([&] {
    Matrix plain = c;
    evo::add_product(a, b, plain);
    CHECK(plain == expected);
    Matrix right = c;
    evo::add_product_transposed_right(a, b.transpose(), right);
    CHECK(right == expected);
    Matrix left = c;
    evo::add_product_transposed_left(a.transpose(), b, left);
    CHECK(left == expected);
  });
}

TEST_CASE("products of blocks and of sparse matrices have the bits of the whole and the dense") {
  evo::Stream stream(2, "blocks");
  const auto [m, n, k] = GENERATE(table<int, int, int>({{1, 1, 1}, {13, 10, 5}, {30, 64, 55}}));
  const Matrix wide_a = random_matrix(m + 3, k + 2, stream);
  const Matrix wide_b = random_matrix(k, n + 5, stream);
  Matrix sparse_a = random_matrix(m, k, stream);
  for (Eigen::Index i = 0; i < sparse_a.size(); ++i)
    if (i % 3 != 0) sparse_a.data()[i] = 0.0F;
  const Matrix b = random_matrix(k, n, stream);
  const Matrix other = random_matrix(m, n, stream);
  evo::SparseMatrix sparse;
  for (Eigen::Index r = 0; r < m; ++r) sparse.add_row(sparse_a.row(r));
  REQUIRE(sparse.rows() == m);
  evo::for_each_isa([&] {
    Matrix whole = Matrix::Zero(m, n);
    evo::add_product(Matrix(wide_a.block(2, 1, m, k)), Matrix(wide_b.rightCols(n)), whole);
    Matrix framed = Matrix::Zero(m + 1, n + 4);
    evo::add_product(wide_a.block(2, 1, m, k), wide_b.rightCols(n), framed.block(1, 3, m, n));
    CHECK(Matrix(framed.block(1, 3, m, n)) == whole);
    CHECK(framed.row(0).isZero(0.0F));
    CHECK(framed.leftCols(3).isZero(0.0F));

    Matrix dense = Matrix::Zero(m, n);
    evo::add_product(sparse_a, b, dense);
    Matrix product = Matrix::Zero(m, n);
    evo::add_product(sparse, b, product);
    CHECK(product == dense);
    Matrix dense_left = Matrix::Zero(k, n);
    evo::add_product_transposed_left(sparse_a, other, dense_left);
    Matrix left = Matrix::Zero(k, n);
    evo::add_product_transposed_left(sparse, other, left);
    CHECK(left == dense_left);
  });
}

TEST_CASE("tanh is close, odd, bounded, and the same on every instruction set") {
  Matrix x(1, 200003);
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x(0, i) = 12.0F * (static_cast<float>(i) / 100001.0F - 1.0F);
  Matrix reference = x;
  evo::tanh_in_place(reference);
  double worst = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    worst = std::max(worst, std::abs(static_cast<double>(reference(0, i)) -
                                     std::tanh(static_cast<double>(x(0, i)))));
    REQUIRE(std::abs(reference(0, i)) <= 1.0F);
  }
  CHECK(worst < 4e-7);
  evo::for_each_isa([&] {
    Matrix y = x;
    evo::tanh_in_place(y);
    CHECK(y == reference);
    Matrix negative = -x;
    evo::tanh_in_place(negative);
    CHECK(negative == -reference);
  });
}

TEST_CASE("tanh lets what is not a number through") {
  Matrix x = Matrix::Zero(1, 19);
  x(0, 3) = std::numeric_limits<float>::quiet_NaN();
  x(0, 4) = std::numeric_limits<float>::infinity();
  x(0, 18) = std::numeric_limits<float>::quiet_NaN();
  evo::for_each_isa([&] {
    Matrix y = x;
    evo::tanh_in_place(y);
    CHECK(std::isnan(y(0, 3)));
    CHECK(y(0, 4) == 1.0F);
    CHECK(std::isnan(y(0, 18)));
    CHECK(y(0, 17) == 0.0F);
  });
}
