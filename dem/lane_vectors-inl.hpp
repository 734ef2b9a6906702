// Between lanes (dem/lanes.hpp) and vectors of any width: rows of spheres, fixed point.
// Compiled once for each kind of vector instructions: Highway's guard instead of #pragma once.
#if defined(GRAINLAW_LANE_VECTORS) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINLAW_LANE_VECTORS
#undef GRAINLAW_LANE_VECTORS
#else
#define GRAINLAW_LANE_VECTORS
#endif

#include <hwy/highway.h>

#include "dem/fused_multiply_add-inl.hpp"
#include "dem/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainlaw::dem {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

template <class Real>
using Tag = hn::CappedTag<Real, kLanes>;

// --- Rows and vectors --------------------------------------------------------------------------------------------
// A row is cut into pieces of 16 bytes. A vector of pieces of the rows k, k + m, k + 2m ... (m numbers to a piece)
// becomes, transposed with its m - 1 siblings, m vectors of one field each, lanes in the order of rows.

/// Asks for the rows that groups near g are about to read. Groups go through the cell in the order of rows and read up to
/// a layer ahead; otherwise the first reader of each row would wait for memory.
template <class Real>
HWY_INLINE void fetch_frontier(const Lanes<Real>& lanes, std::size_t g) {
  if (g + lanes.frontier >= lanes.group.size()) return;
  const char* rows = reinterpret_cast<const char*>(lanes.row.data() + (g + lanes.frontier) * kLanes);
  for (std::size_t byte = 0; byte < kLanes * sizeof(SphereRow<Real>); byte += 64) __builtin_prefetch(rows + byte, 0, 2);
}

/// Asks for the lines of `count` values from `first` on.
template <bool to_write, class T>
HWY_INLINE void fetch(const T* first, std::size_t count) {
  for (std::size_t byte = 0; byte < count * sizeof(T); byte += 64) __builtin_prefetch(reinterpret_cast<const char*>(first) + byte, to_write, 3);
}

/// Asks, in large scenes, for what a pass is about to need of groups near g: their spheres, near rungs, and the rows it will write.
template <class Real>
HWY_INLINE void fetch_groups(const Lanes<Real>& lanes, std::size_t g) {
  constexpr std::size_t ahead = 4;
  if (!lanes.beyond_caches || g + ahead >= lanes.group.size()) return;
  fetch<true>(&lanes.group[g + ahead], 1);
  fetch<false>(lanes.near_rung.data() + lanes.near_first[g + ahead], lanes.near_count[g + ahead]);
  fetch<true>(lanes.next_row.data() + (g + ahead) * kLanes, kLanes);
}

/// Asks for the first near rungs of the block of groups from `begin` on: they do not follow on those of the block before.
template <class Real>
HWY_INLINE void fetch_rungs_from(const Lanes<Real>& lanes, std::size_t begin) {
  if (begin >= lanes.group.size()) return;
  const Rung* rung = lanes.near_rung.data() + lanes.near_first[begin];
  for (std::size_t k = 0; k < kLanes; ++k) __builtin_prefetch(rung + k, 0, 2);
}

template <class D>
struct Quartet {
  hn::Vec<D> a, b, c, d;
};

#if HWY_TARGET == HWY_SCALAR  // vectors of one lane know no transposition
template <class D, class Real>
HWY_INLINE Quartet<D> gather_rows(D d, const Real* rows, const std::uint32_t* row, std::size_t from) {
  const Real* p = reinterpret_cast<const Real*>(reinterpret_cast<const char*>(rows) + row[0]) + from;
  return {hn::Load(d, p), hn::Load(d, p + 1), hn::Load(d, p + 2), hn::Load(d, p + 3)};
}

template <class D, class Real>
HWY_INLINE void store_rows(D d, const Quartet<D>& q, Real* rows, std::size_t from) {
  hn::Store(q.a, d, rows + from);
  hn::Store(q.b, d, rows + from + 1);
  hn::Store(q.c, d, rows + from + 2);
  hn::Store(q.d, d, rows + from + 3);
}
#else
template <class D, class Real>
HWY_INLINE hn::Vec<D> gather_pieces(D d, const Real* rows, const std::uint32_t* row, std::size_t piece) {
  constexpr std::size_t m = 16 / sizeof(Real);
  if constexpr (hn::MaxLanes(D()) == m) {
    return hn::Load(d, reinterpret_cast<const Real*>(reinterpret_cast<const char*>(rows) + row[0]) + piece * m);
  } else {
    const hn::Half<D> half;
    const auto lower = gather_pieces(half, rows, row, piece);
    const auto upper = gather_pieces(half, rows, row + hn::MaxLanes(half), piece);
    return hn::Combine(d, upper, lower);
  }
}

template <class D, class Real>
HWY_INLINE void store_pieces(D d, hn::Vec<D> v, Real* row) {
  constexpr std::size_t m = 16 / sizeof(Real);
  if constexpr (hn::MaxLanes(D()) == m) {
    hn::Store(v, d, row);
  } else {
    const hn::Half<D> half;
    store_pieces(half, hn::LowerHalf(half, v), row);
    store_pieces(half, hn::UpperHalf(half, v), row + hn::MaxLanes(half) * 8);
  }
}

/// Four fields of the rows, from the half of them that begins at number `from` (0 or 4).
template <class D>
HWY_INLINE Quartet<D> gather_rows(D d, const float* rows, const std::uint32_t* row, std::size_t from) {
  const hn::Repartition<double, D> pairs;
  const auto p0 = gather_pieces(d, rows, row, from / 4), p1 = gather_pieces(d, rows, row + 1, from / 4),
             p2 = gather_pieces(d, rows, row + 2, from / 4), p3 = gather_pieces(d, rows, row + 3, from / 4);
  const auto ab01 = hn::BitCast(pairs, hn::InterleaveLower(d, p0, p1)), cd01 = hn::BitCast(pairs, hn::InterleaveUpper(d, p0, p1)),
             ab23 = hn::BitCast(pairs, hn::InterleaveLower(d, p2, p3)), cd23 = hn::BitCast(pairs, hn::InterleaveUpper(d, p2, p3));
  return {hn::BitCast(d, hn::InterleaveLower(pairs, ab01, ab23)), hn::BitCast(d, hn::InterleaveUpper(pairs, ab01, ab23)),
          hn::BitCast(d, hn::InterleaveLower(pairs, cd01, cd23)), hn::BitCast(d, hn::InterleaveUpper(pairs, cd01, cd23))};
}

template <class D>
HWY_INLINE Quartet<D> gather_rows(D d, const double* rows, const std::uint32_t* row, std::size_t from) {
  const auto p0 = gather_pieces(d, rows, row, from / 2), p1 = gather_pieces(d, rows, row + 1, from / 2);
  const auto q0 = gather_pieces(d, rows, row, from / 2 + 1), q1 = gather_pieces(d, rows, row + 1, from / 2 + 1);
  return {hn::InterleaveLower(d, p0, p1), hn::InterleaveUpper(d, p0, p1), hn::InterleaveLower(d, q0, q1),
          hn::InterleaveUpper(d, q0, q1)};
}

/// The other way: four fields into consecutive rows.
template <class D>
HWY_INLINE void store_rows(D d, const Quartet<D>& q, float* rows, std::size_t from) {
  const hn::Repartition<double, D> pairs;
  const auto ab01 = hn::BitCast(pairs, hn::InterleaveLower(d, q.a, q.b)), ab23 = hn::BitCast(pairs, hn::InterleaveUpper(d, q.a, q.b)),
             cd01 = hn::BitCast(pairs, hn::InterleaveLower(d, q.c, q.d)), cd23 = hn::BitCast(pairs, hn::InterleaveUpper(d, q.c, q.d));
  store_pieces(d, hn::BitCast(d, hn::InterleaveLower(pairs, ab01, cd01)), rows + from);
  store_pieces(d, hn::BitCast(d, hn::InterleaveUpper(pairs, ab01, cd01)), rows + from + 8);
  store_pieces(d, hn::BitCast(d, hn::InterleaveLower(pairs, ab23, cd23)), rows + from + 16);
  store_pieces(d, hn::BitCast(d, hn::InterleaveUpper(pairs, ab23, cd23)), rows + from + 24);
}

template <class D>
HWY_INLINE void store_rows(D d, const Quartet<D>& q, double* rows, std::size_t from) {
  store_pieces(d, hn::InterleaveLower(d, q.a, q.b), rows + from);
  store_pieces(d, hn::InterleaveUpper(d, q.a, q.b), rows + from + 8);
  store_pieces(d, hn::InterleaveLower(d, q.c, q.d), rows + from + 2);
  store_pieces(d, hn::InterleaveUpper(d, q.c, q.d), rows + from + 10);
}
#endif

// --- Fixed point -------------------------------------------------------------------------------------------------

/// `steps`, of magnitude below 2^29 or 2^49, rounded to the next quantum of the fixed point.
template <class D>
HWY_INLINE auto to_fixed(D d, hn::Vec<D> steps) {
  if constexpr (sizeof(hn::TFromD<D>) == 4) {
    return hn::NearestInt(steps);
  } else {
    const hn::RebindToSigned<D> di;
    const auto magic = hn::Set(d, 0x1.8p52);  // the sum's last bit is worth 1
    return hn::ShiftLeft<12>(hn::Sub(hn::BitCast(di, hn::Add(steps, magic)), hn::BitCast(di, magic)));
  }
}

/// Cell edge over 2^32 or 2^64 as a sum of two Reals, so that it is not rounded for all pairs alike.
template <class D, bool portable>
struct Edge {
  hn::Vec<D> head, tail;
  Edge(D d, double edge) {
    using Real = hn::TFromD<D>;
    const double scale = edge / kStepsPerEdge<Real>;
    const auto rounded = static_cast<Real>(scale);
    head = hn::Set(d, rounded);
    tail = hn::Set(d, static_cast<Real>(scale - static_cast<double>(rounded)));
  }
  template <class VI>
  HWY_INLINE hn::Vec<D> operator()(D d, VI difference) const {
    const auto c = hn::ConvertTo(d, difference);
    if constexpr (sizeof(hn::TFromD<D>) == 4) {
      return MultiplyAdd<portable>()(c, head, hn::Mul(c, tail));
    } else {
      return hn::Mul(c, head);
    }
  }
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace grainlaw::dem
HWY_AFTER_NAMESPACE();

#endif
