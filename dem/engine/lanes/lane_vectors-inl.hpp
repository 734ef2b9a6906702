// Between lanes (dem/engine/lanes/lanes.hpp) and vectors of any width: rows of spheres, fixed point.
// Compiled once for each kind of vector instructions: Highway's guard instead of #pragma once.
#if defined(GRAINLAW_LANE_VECTORS) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINLAW_LANE_VECTORS
#undef GRAINLAW_LANE_VECTORS
#else
#define GRAINLAW_LANE_VECTORS
#endif

#include <hwy/highway.h>

#include "dem/engine/lanes/fused_multiply_add-inl.hpp"
#include "dem/engine/lanes/lanes.hpp"

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

/// The rows that groups near g are about to read: groups go through the cell in the order of rows and read up to `frontier` groups ahead.
/// Beyond the last layer is the first.
template <class Real>
HWY_INLINE const SphereRow<Real>* frontier_rows(const Lanes<Real>& lanes, std::size_t g) {
  const std::size_t ahead = g + lanes.frontier, groups = lanes.group.size();
  return lanes.row.data() + (ahead < groups ? ahead : ahead - groups) * kLanes;
}

/// Asks for them; otherwise the first reader of each row would wait for memory.
template <class Real>
HWY_INLINE void fetch_frontier(const Lanes<Real>& lanes, std::size_t g) {
  const char* rows = reinterpret_cast<const char*>(frontier_rows(lanes, g));
  for (std::size_t byte = 0; byte < kLanes * sizeof(SphereRow<Real>); byte += 64) __builtin_prefetch(rows + byte, 0, 2);
}

/// Lines of memory that are asked for one by one: all at once they would keep the core's own loads waiting.
template <bool to_write, int locality>
class Fetch {
 public:
  Fetch() = default;
  template <class T>
  Fetch(const T* first, std::size_t count) : at_(reinterpret_cast<const char*>(first)), end_(reinterpret_cast<const char*>(first + count)) {}
  HWY_INLINE void one() {
    if (at_ >= end_) return;
    __builtin_prefetch(at_, to_write, locality);
    at_ += 64;
  }
  HWY_INLINE void rest() {
    while (at_ < end_) one();
  }

 private:
  const char *at_ = nullptr, *end_ = nullptr;
};

/// What a pass is about to need of groups near g: rows, as fetch_frontier(), and in large scenes spheres and near tiers, too.
template <bool large, class Real>
class FetchAhead {
 public:
  HWY_INLINE FetchAhead(const Lanes<Real>& lanes, std::size_t g) {
    if constexpr (large) {
      constexpr std::size_t ahead = 4;
      rows_ = {frontier_rows(lanes, g), kLanes};
      if (g + ahead >= lanes.group.size()) return;
      spheres_ = {&lanes.group[g + ahead], 1};
      tiers_ = {lanes.near_tier.data() + lanes.near_first[g + ahead], lanes.near_count[g + ahead]};
    } else {
      fetch_frontier(lanes, g);
    }
  }
  HWY_INLINE void some() {
    if constexpr (large) {
      rows_.one();
      spheres_.one();
      tiers_.one();
    }
  }
  HWY_INLINE void rest() {
    if constexpr (large) {
      rows_.rest();
      spheres_.rest();
      tiers_.rest();
    }
  }

 private:
  Fetch<false, 2> rows_;
  Fetch<true, 3> spheres_;
  Fetch<false, 3> tiers_;
};

/// Asks for the first near tiers of the block of groups from `begin` on: they do not follow on those of the block before.
template <class Real>
HWY_INLINE void fetch_tiers_from(const Lanes<Real>& lanes, std::size_t begin) {
  if (begin >= lanes.group.size()) return;
  const Tier* tier = lanes.near_tier.data() + lanes.near_first[begin];
  for (std::size_t k = 0; k < kLanes; ++k) __builtin_prefetch(tier + k, 0, 2);
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
HWY_INLINE void load_rows(D d, const Real* rows, Quartet<D>& first, Quartet<D>& second) {
  const std::uint32_t row = 0;
  first = gather_rows(d, rows, &row, 0);
  second = gather_rows(d, rows, &row, 4);
}

template <bool past_caches, class D, class Real>
HWY_INLINE void store_rows(D d, const Quartet<D>& first, const Quartet<D>& second, Real* rows) {
  hn::Store(first.a, d, rows);
  hn::Store(first.b, d, rows + 1);
  hn::Store(first.c, d, rows + 2);
  hn::Store(first.d, d, rows + 3);
  hn::Store(second.a, d, rows + 4);
  hn::Store(second.b, d, rows + 5);
  hn::Store(second.c, d, rows + 6);
  hn::Store(second.d, d, rows + 7);
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

/// Four vectors of pieces, each of every fourth row, as four fields of all rows; and the other way, since it is its own inverse.
template <class D>
HWY_INLINE Quartet<D> transposed(D d, const Quartet<D>& q) {
  const hn::Repartition<double, D> pairs;
  const auto ab01 = hn::BitCast(pairs, hn::InterleaveLower(d, q.a, q.b)), cd01 = hn::BitCast(pairs, hn::InterleaveUpper(d, q.a, q.b)),
             ab23 = hn::BitCast(pairs, hn::InterleaveLower(d, q.c, q.d)), cd23 = hn::BitCast(pairs, hn::InterleaveUpper(d, q.c, q.d));
  return {hn::BitCast(d, hn::InterleaveLower(pairs, ab01, ab23)), hn::BitCast(d, hn::InterleaveUpper(pairs, ab01, ab23)),
          hn::BitCast(d, hn::InterleaveLower(pairs, cd01, cd23)), hn::BitCast(d, hn::InterleaveUpper(pairs, cd01, cd23))};
}

/// Four fields of the rows, from the half of them that begins at number `from` (0 or 4).
template <class D>
HWY_INLINE Quartet<D> gather_rows(D d, const float* rows, const std::uint32_t* row, std::size_t from) {
  return transposed(d, {gather_pieces(d, rows, row, from / 4), gather_pieces(d, rows, row + 1, from / 4),
                        gather_pieces(d, rows, row + 2, from / 4), gather_pieces(d, rows, row + 3, from / 4)});
}

template <class D>
HWY_INLINE Quartet<D> gather_rows(D d, const double* rows, const std::uint32_t* row, std::size_t from) {
  const auto p0 = gather_pieces(d, rows, row, from / 2), p1 = gather_pieces(d, rows, row + 1, from / 2);
  const auto q0 = gather_pieces(d, rows, row, from / 2 + 1), q1 = gather_pieces(d, rows, row + 1, from / 2 + 1);
  return {hn::InterleaveLower(d, p0, p1), hn::InterleaveUpper(d, p0, p1), hn::InterleaveLower(d, q0, q1),
          hn::InterleaveUpper(d, q0, q1)};
}

// Consecutive rows, as many as a vector has lanes, are eight vectors of memory. Their pieces, eight of them to m rows, are the
// blocks of eight other vectors: block b of vector k is piece 8b + k.

/// [a0 a1 a2 a3] .. [d0 d1 d2 d3] as [a0 b0 c0 d0] .. [a3 b3 c3 d3]; its own inverse.
template <class D>
HWY_INLINE Quartet<D> blocks_transposed(D d, const Quartet<D>& q) {
  const auto ac01 = hn::ConcatLowerLower(d, q.c, q.a), ac23 = hn::ConcatUpperUpper(d, q.c, q.a),
             bd01 = hn::ConcatLowerLower(d, q.d, q.b), bd23 = hn::ConcatUpperUpper(d, q.d, q.b);
  return {hn::OddEvenBlocks(hn::SwapAdjacentBlocks(bd01), ac01), hn::OddEvenBlocks(bd01, hn::SwapAdjacentBlocks(ac01)),
          hn::OddEvenBlocks(hn::SwapAdjacentBlocks(bd23), ac23), hn::OddEvenBlocks(bd23, hn::SwapAdjacentBlocks(ac23))};
}

/// Four of the eight vectors of blocks, from the one that begins at `from`.
template <class D, class Real>
HWY_INLINE Quartet<D> load_blocks(D d, const Real* from) {
  constexpr std::size_t m = 16 / sizeof(Real), blocks = hn::MaxLanes(D()) / m;
  if constexpr (blocks == 1) {
    return {hn::Load(d, from), hn::Load(d, from + m), hn::Load(d, from + 2 * m), hn::Load(d, from + 3 * m)};
  } else if constexpr (blocks == 2) {
    const auto ab0 = hn::Load(d, from), cd0 = hn::Load(d, from + 2 * m), ab1 = hn::Load(d, from + 8 * m), cd1 = hn::Load(d, from + 10 * m);
    return {hn::ConcatLowerLower(d, ab1, ab0), hn::ConcatUpperUpper(d, ab1, ab0), hn::ConcatLowerLower(d, cd1, cd0),
            hn::ConcatUpperUpper(d, cd1, cd0)};
  } else {
    return blocks_transposed(d, {hn::Load(d, from), hn::Load(d, from + 8 * m), hn::Load(d, from + 16 * m), hn::Load(d, from + 24 * m)});
  }
}

/// The other way; past the caches: to memory at once, whose lines need not be read for that.
template <bool past_caches, class D, class Real>
HWY_INLINE void store_blocks(D d, const Quartet<D>& q, Real* to) {
  constexpr std::size_t m = 16 / sizeof(Real), blocks = hn::MaxLanes(D()) / m;
  const auto store = [&](hn::Vec<D> v, Real* there) {
    if constexpr (past_caches) {
      hn::Stream(v, d, there);
    } else {
      hn::Store(v, d, there);
    }
  };
  if constexpr (blocks == 1) {
    store(q.a, to);
    store(q.b, to + m);
    store(q.c, to + 2 * m);
    store(q.d, to + 3 * m);
  } else if constexpr (blocks == 2) {
    store(hn::ConcatLowerLower(d, q.b, q.a), to);
    store(hn::ConcatLowerLower(d, q.d, q.c), to + 2 * m);
    store(hn::ConcatUpperUpper(d, q.b, q.a), to + 8 * m);
    store(hn::ConcatUpperUpper(d, q.d, q.c), to + 10 * m);
  } else {
    const Quartet<D> line = blocks_transposed(d, q);
    store(line.a, to);
    store(line.b, to + 8 * m);
    store(line.c, to + 16 * m);
    store(line.d, to + 24 * m);
  }
}

/// The fields of consecutive rows: the first four and the last four of each.
template <class D>
HWY_INLINE void load_rows(D d, const float* rows, Quartet<D>& first, Quartet<D>& second) {
  const Quartet<D> p = load_blocks(d, rows), q = load_blocks(d, rows + 16);
  first = transposed(d, {p.a, p.c, q.a, q.c});
  second = transposed(d, {p.b, p.d, q.b, q.d});
}

template <class D>
HWY_INLINE void load_rows(D d, const double* rows, Quartet<D>& first, Quartet<D>& second) {
  const Quartet<D> p = load_blocks(d, rows), q = load_blocks(d, rows + 8);
  first = {hn::InterleaveLower(d, p.a, q.a), hn::InterleaveUpper(d, p.a, q.a), hn::InterleaveLower(d, p.b, q.b),
           hn::InterleaveUpper(d, p.b, q.b)};
  second = {hn::InterleaveLower(d, p.c, q.c), hn::InterleaveUpper(d, p.c, q.c), hn::InterleaveLower(d, p.d, q.d),
            hn::InterleaveUpper(d, p.d, q.d)};
}

/// The other way.
template <bool past_caches, class D>
HWY_INLINE void store_rows(D d, const Quartet<D>& first, const Quartet<D>& second, float* rows) {
  const Quartet<D> p = transposed(d, first), q = transposed(d, second);
  store_blocks<past_caches>(d, Quartet<D>{p.a, q.a, p.b, q.b}, rows);
  store_blocks<past_caches>(d, Quartet<D>{p.c, q.c, p.d, q.d}, rows + 16);
}

template <bool past_caches, class D>
HWY_INLINE void store_rows(D d, const Quartet<D>& first, const Quartet<D>& second, double* rows) {
  store_blocks<past_caches>(d, Quartet<D>{hn::InterleaveLower(d, first.a, first.b), hn::InterleaveLower(d, first.c, first.d),
                                          hn::InterleaveLower(d, second.a, second.b), hn::InterleaveLower(d, second.c, second.d)}, rows);
  store_blocks<past_caches>(d, Quartet<D>{hn::InterleaveUpper(d, first.a, first.b), hn::InterleaveUpper(d, first.c, first.d),
                                          hn::InterleaveUpper(d, second.a, second.b), hn::InterleaveUpper(d, second.c, second.d)}, rows + 8);
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
