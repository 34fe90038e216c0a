// Compiled once per instruction set by Highway and chosen at run time.
//
// The product works on panels of B, a few vectors wide and `panel_rows` high. Where B
// is transposed, or the panel is its ragged edge, it is copied to be contiguous and
// padded with zeros; else it is read where it lies. Against a panel go tiles of up to
// `tile_rows` rows of C, held in registers while k runs. A sum over more than
// `panel_rows` terms is put back into C and taken up again from there, which leaves
// the order of its additions as it was.
#include "libevo/control/matrix.h"

#include <algorithm>
#include <cstddef>

#include "libevo/sim/targets.h"
//
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libevo/control/matrix.cpp"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

#ifndef EVO_CONTROL_MATRIX_OPERAND
#define EVO_CONTROL_MATRIX_OPERAND
namespace evo {

// Entry (i, j) of an operand is data[i * row + j * column].
struct Operand {
  const float* data;
  std::ptrdiff_t row;
  std::ptrdiff_t column;
};

struct Shape {
  std::ptrdiff_t m;
  std::ptrdiff_t n;
  std::ptrdiff_t k;
};

}  // namespace evo
#endif

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;

// Sums x 2 vectors, 2 of B, 1 of A: 15 of 16 registers, or 19 of 32 for the 8
// environments of a batch at once.
constexpr std::ptrdiff_t tile_rows = HWY_TARGET <= HWY_AVX3 ? 8 : 6;
constexpr std::ptrdiff_t panel_rows = 256;  // x 2 vectors: at most 32 KiB
constexpr std::ptrdiff_t max_lanes = 16;

// Rows of B, `row` apart, a panel's width each.
struct Panel {
  const float* data;
  std::ptrdiff_t row;
};

// tile += A rows [Rows x k] times panel [k x Vectors * lanes]; the tile's rows
// are `stride` apart.
template <int Rows, int Vectors>
HWY_INLINE void multiply_tile(const Operand& a, const Panel& panel, std::ptrdiff_t k, float* tile,
                              std::ptrdiff_t stride) {
  const D d;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  V sum[Rows][Vectors];
  for (int r = 0; r < Rows; ++r)
    for (int v = 0; v < Vectors; ++v) sum[r][v] = hn::LoadU(d, tile + r * stride + v * lanes);
  for (std::ptrdiff_t i = 0; i < k; ++i) {
    V b[Vectors];
    for (int v = 0; v < Vectors; ++v) b[v] = hn::LoadU(d, panel.data + i * panel.row + v * lanes);
    for (int r = 0; r < Rows; ++r) {
      const V value = hn::Set(d, a.data[r * a.row + i * a.column]);
      for (int v = 0; v < Vectors; ++v) sum[r][v] = hn::Add(sum[r][v], hn::Mul(value, b[v]));
    }
  }
  for (int r = 0; r < Rows; ++r)
    for (int v = 0; v < Vectors; ++v) hn::StoreU(sum[r][v], d, tile + r * stride + v * lanes);
}

// As multiply_tile with `rows` rows, 1 to Rows.
template <int Vectors, int Rows = tile_rows>
void multiply_rows(std::ptrdiff_t rows, const Operand& a, const Panel& panel, std::ptrdiff_t k,
                   float* tile, std::ptrdiff_t stride) {
  if constexpr (Rows > 1) {
    if (rows < Rows) return multiply_rows<Vectors, Rows - 1>(rows, a, panel, k, tile, stride);
  }
  multiply_tile<Rows, Vectors>(a, panel, k, tile, stride);
}

// 4 x 4 numbers: to[i * to_row + j] = from[j * from_row + i]
HWY_INLINE void transpose_block(const float* from, std::ptrdiff_t from_row, float* to,
                                std::ptrdiff_t to_row) {
#if HWY_TARGET == HWY_SCALAR
  for (std::ptrdiff_t i = 0; i < 4; ++i)
    for (std::ptrdiff_t j = 0; j < 4; ++j) to[i * to_row + j] = from[j * from_row + i];
#else
  const hn::Full128<float> d;
  const auto row0 = hn::LoadU(d, from);
  const auto row1 = hn::LoadU(d, from + from_row);
  const auto row2 = hn::LoadU(d, from + 2 * from_row);
  const auto row3 = hn::LoadU(d, from + 3 * from_row);
  const auto lower02 = hn::InterleaveLower(d, row0, row2);
  const auto lower13 = hn::InterleaveLower(d, row1, row3);
  const auto upper02 = hn::InterleaveUpper(d, row0, row2);
  const auto upper13 = hn::InterleaveUpper(d, row1, row3);
  hn::StoreU(hn::InterleaveLower(d, lower02, lower13), d, to);
  hn::StoreU(hn::InterleaveUpper(d, lower02, lower13), d, to + to_row);
  hn::StoreU(hn::InterleaveLower(d, upper02, upper13), d, to + 2 * to_row);
  hn::StoreU(hn::InterleaveUpper(d, upper02, upper13), d, to + 3 * to_row);
#endif
}

// Rows [0, k) and columns [0, columns) of B, padded to `width` columns.
void pack(const Operand& b, std::ptrdiff_t k, std::ptrdiff_t columns, std::ptrdiff_t width,
          float* panel) {
  constexpr std::ptrdiff_t block = 4;
  std::ptrdiff_t whole_columns = 0;  // copied in blocks, in whole_rows
  std::ptrdiff_t whole_rows = 0;
  if (b.row == 1) {
    whole_columns = columns / block * block;
    whole_rows = k / block * block;
    for (std::ptrdiff_t j = 0; j < whole_columns; j += block)
      for (std::ptrdiff_t i = 0; i < whole_rows; i += block)
        transpose_block(b.data + i + j * b.column, b.column, panel + i * width + j, width);
  }
  if (b.column == 1) {
    for (std::ptrdiff_t i = 0; i < k; ++i) {
      float* row = panel + i * width;
      std::copy_n(b.data + i * b.row, columns, row);
      std::fill(row + columns, row + width, 0.0F);
    }
    return;
  }
  for (std::ptrdiff_t i = 0; i < k; ++i) {
    float* row = panel + i * width;
    for (std::ptrdiff_t j = i < whole_rows ? whole_columns : 0; j < columns; ++j)
      row[j] = b.data[i * b.row + j * b.column];
    for (std::ptrdiff_t j = columns; j < width; ++j) row[j] = 0.0F;
  }
}

// `columns` columns of C, at most a panel's width, over at most panel_rows of k.
template <int Vectors>
void multiply_panel(const Shape& shape, std::ptrdiff_t columns, const Operand& a, const Operand& b,
                    float* c, std::ptrdiff_t c_row) {
  const D d;
  const auto width = Vectors * static_cast<std::ptrdiff_t>(hn::Lanes(d));
  HWY_ALIGN float packed[panel_rows * Vectors * max_lanes];
  Panel panel{b.data, b.row};
  if (b.column != 1 || columns != width) {
    pack(b, shape.k, columns, width, packed);
    panel = {packed, width};
  }
  for (std::ptrdiff_t i = 0; i < shape.m; i += tile_rows) {
    const std::ptrdiff_t rows = std::min(tile_rows, shape.m - i);
    const Operand a_rows{a.data + i * a.row, a.row, a.column};
    float* c_rows = c + i * c_row;
    if (columns == width) {
      multiply_rows<Vectors>(rows, a_rows, panel, shape.k, c_rows, c_row);
    } else {
      HWY_ALIGN float tile[tile_rows * Vectors * max_lanes];
      for (std::ptrdiff_t r = 0; r < rows; ++r) {
        for (std::ptrdiff_t j = 0; j < width; ++j)
          tile[r * width + j] = j < columns ? c_rows[r * c_row + j] : 0.0F;
      }
      multiply_rows<Vectors>(rows, a_rows, panel, shape.k, tile, width);
      for (std::ptrdiff_t r = 0; r < rows; ++r)
        for (std::ptrdiff_t j = 0; j < columns; ++j) c_rows[r * c_row + j] = tile[r * width + j];
    }
  }
}

void AddProduct(const Shape& shape, const Operand& a, const Operand& b, float* c,
                std::ptrdiff_t c_row) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(D()));
  for (std::ptrdiff_t k = 0; k < shape.k; k += panel_rows) {
    const Shape part{shape.m, shape.n, std::min(panel_rows, shape.k - k)};
    const Operand a_part{a.data + k * a.column, a.row, a.column};
    std::ptrdiff_t j = 0;
    while (j < shape.n) {
      const std::ptrdiff_t columns = std::min(2 * lanes, shape.n - j);
      const Operand b_part{b.data + k * b.row + j * b.column, b.row, b.column};
      if (columns > lanes) {
        multiply_panel<2>(part, columns, a_part, b_part, c + j, c_row);
      } else {
        multiply_panel<1>(part, columns, a_part, b_part, c + j, c_row);
      }
      j += columns;
    }
  }
}

// tanh(x) = x P(x^2) / Q(x^2), fitted to the least relative error (2.1e-8) on
// [-9, 9]; beyond, tanh is 1 to single precision.
HWY_INLINE V tanh_lanes(V x) {
  const D d;
  const V bound = hn::Set(d, 9.0F);
  const V one = hn::Set(d, 1.0F);
  // Selections instead of Min and Max, whose treatment of NaN varies.
  V t = hn::IfThenElse(hn::Gt(x, bound), bound, x);
  t = hn::IfThenElse(hn::Lt(t, hn::Neg(bound)), hn::Neg(bound), t);
  const V z = hn::Mul(t, t);
  V p = hn::Set(d, 1.3354648e-8F);
  p = hn::Add(hn::Mul(p, z), hn::Set(d, 2.0609072e-5F));
  p = hn::Add(hn::Mul(p, z), hn::Set(d, 3.4955875e-3F));
  p = hn::Add(hn::Mul(p, z), hn::Set(d, 1.3381025e-1F));
  p = hn::Add(hn::Mul(p, z), one);
  V q = hn::Set(d, 7.7765526e-7F);
  q = hn::Add(hn::Mul(q, z), hn::Set(d, 3.2856336e-4F));
  q = hn::Add(hn::Mul(q, z), hn::Set(d, 2.5876980e-2F));
  q = hn::Add(hn::Mul(q, z), hn::Set(d, 4.6714342e-1F));
  q = hn::Add(hn::Mul(q, z), one);
  V y = hn::Div(hn::Mul(t, p), q);
  y = hn::IfThenElse(hn::Gt(y, one), one, y);
  return hn::IfThenElse(hn::Lt(y, hn::Neg(one)), hn::Neg(one), y);
}

void Tanh(float* x, std::ptrdiff_t n) {
  const D d;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  std::ptrdiff_t i = 0;
  for (; i + lanes <= n; i += lanes) hn::StoreU(tanh_lanes(hn::LoadU(d, x + i)), d, x + i);
  if (i == n) return;
  HWY_ALIGN float rest[max_lanes] = {};
  std::copy(x + i, x + n, rest);
  hn::Store(tanh_lanes(hn::Load(d, rest)), d, rest);
  std::copy_n(rest, n - i, x + i);
}

// `Vectors` vectors of row i of C: += its entries of A times rows of B, or `transposed`: of rows of
// C += its entries of A times row i of B. b and c point at the first column.
template <int Vectors>
HWY_INLINE void add_sparse_row(const SparseMatrix& a, std::ptrdiff_t i, bool transposed,
                               const float* b, std::ptrdiff_t n, float* c) {
  const D d;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const auto begin = a.entries.data() + a.first[static_cast<std::size_t>(i)];
  const auto end = a.entries.data() + a.first[static_cast<std::size_t>(i) + 1];
  V row[Vectors];
  float* const fixed_row = transposed ? nullptr : c + i * n;
  for (int v = 0; v < Vectors; ++v)
    row[v] = hn::LoadU(d, (transposed ? b + i * n : fixed_row) + v * lanes);
  if (transposed) {
    for (auto entry = begin; entry != end; ++entry) {
      float* const to = c + entry->column * n;
      const V value = hn::Set(d, entry->value);
      for (int v = 0; v < Vectors; ++v)
        hn::StoreU(hn::Add(hn::LoadU(d, to + v * lanes), hn::Mul(value, row[v])), d,
                   to + v * lanes);
    }
    return;
  }
  for (auto entry = begin; entry != end; ++entry) {
    const float* const from = b + entry->column * n;
    const V value = hn::Set(d, entry->value);
    for (int v = 0; v < Vectors; ++v)
      row[v] = hn::Add(row[v], hn::Mul(value, hn::LoadU(d, from + v * lanes)));
  }
  for (int v = 0; v < Vectors; ++v) hn::StoreU(row[v], d, fixed_row + v * lanes);
}

void AddSparseProduct(const SparseMatrix& a, bool transposed, const float* b, std::ptrdiff_t n,
                      float* c) {
  constexpr int block = 4;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(D()));
  for (std::ptrdiff_t i = 0; i < a.rows(); ++i) {
    std::ptrdiff_t j = 0;
    for (; j + block * lanes <= n; j += block * lanes)
      add_sparse_row<block>(a, i, transposed, b + j, n, c + j);
    for (; j + lanes <= n; j += lanes) add_sparse_row<1>(a, i, transposed, b + j, n, c + j);
    for (; j < n; ++j)
      for (std::size_t e = a.first[static_cast<std::size_t>(i)];
           e < a.first[static_cast<std::size_t>(i) + 1]; ++e) {
        const auto [column, value] = a.entries[e];
        if (transposed)
          c[column * n + j] += value * b[i * n + j];
        else
          c[i * n + j] += value * b[column * n + j];
      }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace evo {
namespace {

HWY_EXPORT(AddProduct);
HWY_EXPORT(Tanh);
HWY_EXPORT(AddSparseProduct);

Operand plain(const MatrixView& x) { return {x.data(), x.outerStride(), 1}; }
Operand transposed(const MatrixView& x) { return {x.data(), 1, x.outerStride()}; }

}  // namespace

void add_product(const MatrixView& a, const MatrixView& b, MatrixBlock c) {
  eigen_assert(a.cols() == b.rows() && c.rows() == a.rows() && c.cols() == b.cols());
  HWY_DYNAMIC_DISPATCH(AddProduct)
  ({a.rows(), b.cols(), a.cols()}, plain(a), plain(b), c.data(), c.outerStride());
}

void add_product_transposed_right(const MatrixView& a, const MatrixView& b, MatrixBlock c) {
  eigen_assert(a.cols() == b.cols() && c.rows() == a.rows() && c.cols() == b.rows());
  HWY_DYNAMIC_DISPATCH(AddProduct)
  ({a.rows(), b.rows(), a.cols()}, plain(a), transposed(b), c.data(), c.outerStride());
}

void add_product_transposed_left(const MatrixView& a, const MatrixView& b, MatrixBlock c) {
  eigen_assert(a.rows() == b.rows() && c.rows() == a.cols() && c.cols() == b.cols());
  HWY_DYNAMIC_DISPATCH(AddProduct)
  ({a.cols(), b.cols(), a.rows()}, transposed(a), plain(b), c.data(), c.outerStride());
}

void SparseMatrix::add_row(const Eigen::Ref<const Eigen::RowVectorXf>& row) {
  columns = row.size();
  for (Eigen::Index j = 0; j < columns; ++j)
    if (row[j] != 0.0F) entries.push_back({j, row[j]});
  first.push_back(entries.size());
}

void add_product(const SparseMatrix& a, const Matrix& b, Matrix& c) {
  eigen_assert(a.columns == b.rows() && c.rows() == a.rows() && c.cols() == b.cols());
  HWY_DYNAMIC_DISPATCH(AddSparseProduct)(a, false, b.data(), b.cols(), c.data());
}

void add_product_transposed_left(const SparseMatrix& a, const Matrix& b, Matrix& c) {
  eigen_assert(a.rows() == b.rows() && c.rows() == a.columns && c.cols() == b.cols());
  HWY_DYNAMIC_DISPATCH(AddSparseProduct)(a, true, b.data(), b.cols(), c.data());
}

void tanh_in_place(Matrix& x) { HWY_DYNAMIC_DISPATCH(Tanh)(x.data(), x.size()); }

}  // namespace evo
#endif
